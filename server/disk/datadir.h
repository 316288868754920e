/* datadir.h - the directory of --data: its lock, its files, their names.
 *
 *     log.<lsn>         a segment of the log, whose first record has that lsn
 *     snapshot.<lsn>    all sets, with every change up to that lsn
 *     *.tmp             a snapshot that was not finished; removed at the next start
 *     reserve           space kept back, so that DEL and DROP still work on a full disk
 *     damaged.*         what --repair took away, or a start whose log was damaged at its end
 *
 * An lsn is written as 16 hexadecimal digits, so that names sort. */
#ifndef SERVER_DATADIR_H
#define SERVER_DATADIR_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct datadir {
    int fd;
    const char *path; /* borrows */
};

enum datafile_kind { DATAFILE_SNAPSHOT, DATAFILE_LOG, DATAFILE_TEMPORARY };

enum { DATAFILE_NAME = 40, DATADIR_ASIDE = DATAFILE_NAME + 32 };

struct datafile {
    enum datafile_kind kind;
    uint64_t lsn;
    uint64_t bytes;
    char name[DATAFILE_NAME];
};

struct datafiles {
    struct datafile *v; /* owns; snapshots by lsn, then logs by lsn, then the others */
    size_t n;
};

/* Opens and locks the directory; with `create` it is made if it is missing, and its name is on the
 * disk when that returns. One process at a time has it. False: the reason is on standard error. */
bool datadir_open(struct datadir *d, const char *path, bool create);
void datadir_close(struct datadir *d);

/* The files of the directory that are ours. False with errno. */
bool datadir_list(const struct datadir *d, struct datafiles *files);
void datafiles_free(struct datafiles *files);

void datafile_name(char name[DATAFILE_NAME], enum datafile_kind kind, uint64_t lsn);

/* Makes creations, renames and removals durable. False with errno. */
bool datadir_sync(const struct datadir *d);

/* Copies what follows byte `at` of the file into a new file, on the disk when that returns, under a
 * name that begins with `damaged.` and that no file has. False with errno, and there is no new
 * file. */
bool datadir_copy_aside(const struct datadir *d, const struct datafile *f, uint64_t at,
                        char name[DATADIR_ASIDE]);

/* Gives the whole file a second name of that kind, which is durable after datadir_sync. False with
 * errno. */
bool datadir_link_aside(const struct datadir *d, const struct datafile *f);

/* The same, and removes its first name when the second one is durable. False with errno. */
bool datadir_put_aside(const struct datadir *d, const struct datafile *f);

/* Cuts off what follows byte `at`; that is on the disk when it returns. False with errno. */
bool datadir_cut(const struct datadir *d, const struct datafile *f, uint64_t at);

/* Makes what the file holds durable from byte `at` on, whatever became of earlier syncs. False with
 * errno. */
bool datadir_save_again(const struct datadir *d, const struct datafile *f, uint64_t at);

/* Puts a copy of the file into its place, durable with its name, unless *cancel is set meanwhile. False
 * with errno: it is as it was, or the sync of the name has failed. */
bool datadir_copy_again(const struct datadir *d, const struct datafile *f,
                        const atomic_bool *cancel);

/* Removes the snapshots older than `lsn` and the log segments that it covers: those followed by a
 * segment that begins at lsn + 1 or before. A file that cannot be removed is left for the next
 * time. */
void datadir_forget(const struct datadir *d, uint64_t lsn);

#endif
