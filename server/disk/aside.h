/* aside.h - a snapshot that is received from a leader, in a directory inside the data directory, and how it replaces the
 * files of the data directory.
 *
 *     incoming/    a snapshot that is being received, with the empty segment after it; removed at the next start
 *     arrived/     the same, complete and good: it replaces everything in the data directory
 *
 * `incoming` becomes `arrived` by a rename. Then the files of the data directory are removed, those that have arrived get second
 * names in it, and `arrived` becomes `incoming` again, which is removed. After a crash the next start does that again from the
 * beginning: so the directory has the old state or the new one, whenever that happens. */
#pragma once

#include "proto/buf.h"
#include "server/disk/datadir.h"

struct aside {
    const struct datadir *dir; /* borrows; NULL: nothing is being received */
    int folder, fd;
    struct buf out;
};

/* Begins to receive the snapshot with that header. False with errno. */
bool aside_begin(struct aside *a, const struct datadir *dir, const struct segment *header);

/* Appends records. False with errno. */
bool aside_write(struct aside *a, const char *bytes, size_t n);

/* All records have come: makes everything durable. *arrived: a directory to read; ends with aside_close. False with
 * errno; then nothing is left. */
bool aside_complete(struct aside *a, const struct segment *header, struct datadir *arrived);
void aside_close(struct datadir *arrived);

/* Removes the received files. */
void aside_abandon(struct aside *a);

/* Replaces the files of the directory by the files of `incoming`, which are complete. False with errno; then the next start
 * has the old files, or the new ones. */
bool aside_put_in_place(const struct datadir *dir);

/* Opens `arrived`, which a start would put in place: a directory to read; ends with aside_close. False: there is none. */
bool aside_open(const struct datadir *dir, struct datadir *arrived);

/* At a start: finishes a replacement that a crash has interrupted. False with errno. */
bool aside_finish(const struct datadir *dir);
