/* datadir.h - the directory of --data: its lock, its files, their names.
 *
 *     log.<lsn>         a segment of the log, whose first record has that lsn
 *     snapshot.<lsn>    all sets, with every change up to that lsn
 *     *.tmp             an incomplete snapshot; removed at the next start
 *     reserve           reserved space, so that DEL and DROP still work on a full disk
 *     damaged.*         put aside by --repair, or at a start because the end of the log was damaged
 *
 * An lsn is written as 16 hexadecimal digits, so that names sort. */
#pragma once

#include "proto/records/record.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct datadir {
    int fd;
    const char *path;         /* borrows */
    bool placed;              /* `path` leads to it: it was opened by datadir_open */
    struct lineage lineage;   /* for new files; a reactor's once the log has begun */
    atomic_uint pins;         /* while there are any, datadir_forget removes nothing */
    _Atomic uint64_t covered; /* its last argument; 0: none */
    atomic_size_t keep_log;   /* bytes of segments that stay although a snapshot covers them */
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
    bool used; /* there are files that a daemon makes once it has a log: reserve, role, damaged.* */
};

/* Opens the directory and locks it for this process; with `create` it is created if it is missing, and
 * its name is durable on return. False: the reason is on standard error, also if there is a name of ours that
 * is no file of this user (own_file.h). */
bool datadir_open(struct datadir *d, const char *path, bool create);
void datadir_close(struct datadir *d);

/* Whether its path still leads to the directory. False with errno: ENOENT: it is gone; ESTALE: another directory is in its
 * place. */
bool datadir_in_place(const struct datadir *d);

/* The same, but if the directory has been deleted and there is an empty one at its path, locks and uses the empty one. */
bool datadir_regain(const struct datadir *d);

/* A sentence for operators about an error of the disk. */
const char *datadir_error(int error);

/* Lists the snapshots, segments and temporary files of the directory. False with errno. */
bool datadir_list(const struct datadir *d, struct datafiles *files);
void datafiles_free(struct datafiles *files);

/* The last file of the kind whose lsn is at most `most`. False: there is none, or the directory cannot be read. */
bool datadir_find(const struct datadir *d, enum datafile_kind kind, uint64_t most,
                  struct datafile *out);

/* Removes all snapshots and segments, complete or not. False with errno if one could not be removed. */
bool datadir_empty(const struct datadir *d);

void datafile_name(char name[DATAFILE_NAME], enum datafile_kind kind, uint64_t lsn);

/* Makes created, renamed and removed names durable. False with errno. */
bool datadir_sync(const struct datadir *d);

/* Copies the file from byte `at` on into a new file with a free name that begins with `damaged.`, durable
 * on return. False with errno; then there is no new file. */
bool datadir_copy_aside(const struct datadir *d, const struct datafile *f, uint64_t at,
                        char name[DATADIR_ASIDE]);

/* Gives the whole file a second name of that kind, durable after datadir_sync. False with errno. */
bool datadir_link_aside(const struct datadir *d, const struct datafile *f);

/* The same, and removes the first name when the second one is durable. False with errno. */
bool datadir_put_aside(const struct datadir *d, const struct datafile *f);

/* Copies the first f->bytes bytes of the file into a new file of the same name in the directory `to`; all but the
 * name is durable on return. False with errno, ESTALE: the file is shorter, ECANCELED: *cancel has been set. Then
 * there may be an incomplete file. */
bool datadir_copy_to(const struct datadir *d, const struct datafile *f, int to,
                     const atomic_bool *cancel);

/* To be called before a file is changed in place other than at its end: if it has another name, as in a backup, it is
 * replaced by a copy first. False with errno. */
bool datadir_unshare(const struct datadir *d, const struct datafile *f);

/* Truncates the file to `at` bytes, durable on return. False with errno. */
bool datadir_cut(const struct datadir *d, const struct datafile *f, uint64_t at);

/* Makes the file durable from byte `at` on, even if an earlier sync has failed. False with errno. */
bool datadir_save_again(const struct datadir *d, const struct datafile *f, uint64_t at);

/* Replaces the file by a copy of itself, durable with its name, unless *cancel is set meanwhile. False with
 * errno: the file is unchanged, or the sync of the name has failed. */
bool datadir_copy_again(const struct datadir *d, const struct datafile *f,
                        const atomic_bool *cancel);

/* Removes the snapshots older than `lsn` and the segments that it covers: segments followed by a segment that
 * begins at lsn + 1 or before. The last d->keep_log bytes of these segments stay. A file that cannot be removed is left
 * for the next time. */
void datadir_forget(struct datadir *d, uint64_t lsn);

/* Whether there are segments that the newest snapshot covers. */
bool datadir_keeps(const struct datadir *d);

/* From now on datadir_forget removes nothing, apart from a file that it is about to remove. datadir_unpin
 * removes what it would have removed. */
void datadir_pin(struct datadir *d);
void datadir_unpin(struct datadir *d);
