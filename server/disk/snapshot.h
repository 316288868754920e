/* snapshot.h - a file with all sets, written by a thread of its own from pinned versions.
 *
 * Edits continue meanwhile: the thread reads each version as it was at one moment, alternating with edits
 * (dataset.h). So a snapshot takes little memory.
 *
 * The sets are not all pinned at the same time: a set that is being edited in place is pinned when the edit
 * has ended. So the file records for each set up to which change it is contained, and the log continues
 * from there, set by set. The file's own lsn guarantees that every change up to it is contained.
 *
 * The steps: write a temporary file, sync it, rename it, sync the directory; only then remove the files
 * that it replaces. A crash at any point leaves the old state or the new one. */
#pragma once

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
    uint64_t number;         /* its version, as clients see it */
    bool triangulated, constrained;
    int64_t expires_ms;
    size_t name_len;
    char name[SET_NAME_LIMIT + 1];
};

struct snapshot {
    struct datadir *dir; /* borrows */
    uint64_t lsn;
    uint64_t digest;        /* of the log's changes up to lsn */
    struct lineage lineage; /* of the log */
    int event; /* an eventfd, written when done; the thread's, which may outlive the struct */
    size_t n;
    size_t waiting; /* sets that are not pinned yet, plus 1 until snapshot_go */
    int error;      /* errno; 0: none */
    uint64_t bytes; /* of the file */
    bool started;
    atomic_size_t written; /* sets that are in the file */
    size_t released;       /* sets that are unpinned again */
    atomic_bool cancel, done;
    pthread_t thread;
    struct snapshot_source source[];
};

/* Pins all born sets, some of them later. To be called when lsn is the last change: a set that is dropped later
 * must still be in the file, because the log after lsn begins with its last changes. The eventfd is written
 * when the snapshot is done. NULL: out of memory or descriptors. Ends with snapshot_end. */
struct snapshot *snapshot_begin(struct datadir *dir, struct registry *sets, uint64_t lsn,
                                int event);

/* Starts the thread as soon as the last set is pinned; digest: of the log's changes up to the snapshot's lsn. */
void snapshot_go(struct snapshot *snap, uint64_t digest);

/* Unpins the sets that have been written. */
void snapshot_release(struct snapshot *snap, struct registry *sets);

/* Ends the thread, unpins, frees. Returns an errno, 0 if the snapshot is in place; ECANCELED if it was not done
 * yet. */
int snapshot_end(struct snapshot *snap, struct registry *sets);
