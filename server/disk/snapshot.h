/* snapshot.h - a file with all sets, written by a thread of its own from pinned versions.
 *
 * Edits go on meanwhile: the thread reads one moment of each version, in turns with the edits
 * (dataset.h). So a snapshot takes little memory, whatever happens.
 *
 * The sets are not all pinned at one moment: one that is just being edited in place is pinned when
 * it is free. So the file says for each set up to which change it contains it, and the log goes on
 * from there, set by set. What the file's own lsn promises is that every change up to it is
 * contained.
 *
 * The steps: write to a temporary file, sync it, rename it, sync the directory; only then remove
 * what it replaces. A crash at any point leaves the old state or the new one. */
#ifndef SERVER_SNAPSHOT_H
#define SERVER_SNAPSHOT_H

#include "server/disk/datadir.h"
#include "server/sets/dataset.h"

#include <pthread.h>
#include <stdatomic.h>

struct snapshot;

struct snapshot_source {
    struct waiter waiter; /* while the set is not free */
    struct snapshot *snapshot;
    struct dataset *set;     /* borrows while it waits */
    struct version *version; /* pinned; NULL while it waits */
    struct dt_view *view;    /* owns: the moment that is written; NULL: out of memory */
    uint64_t lsn;            /* of the set's last change in it */
    bool triangulated;
    size_t name_len;
    char name[SET_NAME_LIMIT + 1];
};

struct snapshot {
    const struct datadir *dir; /* borrows */
    uint64_t lsn;
    int event; /* an eventfd, written when done; the thread's own, which may outlive the struct */
    size_t n;
    size_t waiting; /* for so many sets, and for snapshot_go */
    int error;      /* errno; 0: it is in place */
    uint64_t bytes; /* of the file */
    bool started;
    atomic_size_t written; /* sets that are in the file */
    size_t released;       /* and are pinned no more */
    atomic_bool cancel, done;
    pthread_t thread;
    struct snapshot_source source[];
};

/* Pins all born sets, some of them later. To be called when lsn is the last change: a set that is
 * dropped after that must still be in the file, because the log from lsn on begins with its last
 * changes. When it is done, the eventfd is written. NULL: out of memory or descriptors. The caller ends
 * it with snapshot_end. */
struct snapshot *snapshot_begin(const struct datadir *dir, struct registry *sets, uint64_t lsn,
                                int event);

/* Starts the thread as soon as the last set is pinned. */
void snapshot_go(struct snapshot *snap);

/* Unpins the sets that have been written meanwhile, so that they can be edited in place again. */
void snapshot_release(struct snapshot *snap, struct registry *sets);

/* Waits for the thread, unpins, frees. Returns the errno of what failed, 0 if the snapshot is in
 * place. Before it is done: gives it up (ECANCELED). */
int snapshot_end(struct snapshot *snap, struct registry *sets);

#endif
