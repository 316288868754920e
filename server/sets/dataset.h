/* dataset.h - named sets, their versions, and who waits for them. The I/O thread alone touches what
 * is here.
 *
 * A version is a set's points and triangulation, counted by reference: the set refers to its
 * current version, jobs and replies to the one that they read. Edits change it in place. A build,
 * and an edit so large that it ends in a rebuild while a long reply is being sent, make a new
 * version beside it, which becomes the current one when it is complete.
 *
 * Whoever reads for long, a reply that is still being sent or a snapshot, reads one moment of the
 * version (dt_view_begin), piece by piece; edits go on in between. The lock keeps edits out while a
 * worker or the snapshot's thread reads a piece, and pieces while an edit is at work: for about a
 * millisecond either way. The I/O thread reads without it as long as no job edits in place, and
 * never waits for it.
 *
 * One writer at a time: while a job edits the set, writer is set, and requests that must wait for
 * it stand in a queue (wait.h). If it edits in place, exclusive is set too, and readers wait as
 * well. */
#ifndef SERVER_DATASET_H
#define SERVER_DATASET_H

#include "core/delaunay.h"
#include "proto/request.h"
#include "server/sets/budget.h"
#include "server/sets/wait.h"

#include <pthread.h>

struct version {
    struct dt *dt; /* owns; not to be looked at while a job edits it in place */
    unsigned refs;
    pthread_rwlock_t lock; /* of dt, see above */
    /* What dt holds, as of the last completed edit; sum.memory is accounted for. */
    struct dt_summary sum;
    uint64_t lsn; /* of the last change that the log has of it; 0: none, or without --data */
    bool edited;  /* a job edits it in place, or has done so, and the log does not have that yet */
    bool untidy;  /* in the registry's list of versions to be tidied */
    struct version *next; /* there */
};

struct dataset {
    struct dataset *next; /* in its bucket */
    struct version *current;
    struct job *writer; /* the job that edits it; NULL: none */
    bool exclusive;     /* the writer edits in place */
    bool born; /* false while the request that creates it has not succeeded yet: it is not there for
                  others, but its name is taken */
    bool triangulated; /* TRIANGULATE has been asked for (with --data) */
    bool loading;      /* it was read from disk and its triangulation is not there yet */
    bool temporary;    /* dropped when its connection ends, and never on disk */
    struct dataset *temporary_next, **temporary_link; /* in the list of that connection's */
    struct wait_queue queue;                          /* of requests that wait until it is free */
    size_t name_len;
    char name[SET_NAME_LIMIT + 1];
};

/* The temporary sets of a connection. */
struct temporaries {
    struct dataset *first;
    struct temporaries *next; /* in the registry's list of orphans */
};

struct registry {
    struct dataset **bucket; /* owns */
    size_t buckets, sets;
    struct temporaries *orphans; /* owns; of connections that have ended */
    struct reservation memory;   /* of all versions */
    struct dt_pages *pages;      /* borrows; where sets have their large arrays; NULL: the system */
    struct version *untidy;      /* that keep what was saved for readers who have finished */
    /* Takes a set that nothing refers to any more; freeing a large one is a job. */
    void (*discard)(void *ctx, struct dt *dt);
    void *discard_ctx;
};

void registry_init(struct registry *r);
/* Frees all sets; nobody may wait or pin any more. */
void registry_clear(struct registry *r);

/* The set of that name, born or not; NULL. */
struct dataset *registry_find(const struct registry *r, const struct word *name);
/* A new unborn set; NULL when out of memory. */
struct dataset *registry_create(struct registry *r, const struct word *name, double tolerance);
/* Removes the set and frees it. Those who wait for it are all woken. Nobody may write it. */
void registry_drop(struct registry *r, struct dataset *set);
/* Adds a set to a connection's temporary ones, *of, which is made for the first of them (NULL). False when
 * out of memory. registry_drop takes it out. */
bool dataset_make_temporary(struct dataset *set, struct temporaries **of);
/* Their connection has ended: takes them over, to be dropped by registry_drop_orphans; NULL is fine. */
void registry_orphan(struct registry *r, struct temporaries *of);
/* Drops some of them; those that somebody writes come later. Cost: less than a millisecond. Whether there
 * are more that could be dropped now. */
bool registry_drop_orphans(struct registry *r);
/* Goes on freeing what was saved for readers who have finished. Cost: about a millisecond at most.
 * To be called once a second. */
void registry_tidy(struct registry *r);
/* Calls visit for every born set, in no particular order. */
void registry_each(const struct registry *r, void (*visit)(struct dataset *set, void *ctx),
                   void *ctx);

/* Visits the born sets of the next bucket, and returns the cursor for the one after it; 0: that was
 * the last. It begins with 0. A set that is there from the first call to the last is visited once,
 * even if others come and go in between. */
size_t registry_scan(const struct registry *r, size_t cursor,
                     void (*visit)(struct dataset *set, void *ctx), void *ctx);

struct version *version_new(struct dt *dt);
/* Frees a version that was never part of a set; NULL is fine, and its set is not freed. */
void version_free(struct version *v);
struct version *version_pin(struct version *v);
void version_unpin(struct registry *r, struct version *v);
/* Brings the summary and the accounting up to date after an edit. */
void version_update(struct registry *r, struct version *v);

/* The lock: shared for a piece that is read, exclusive for an edit. The try forms return false
 * instead of waiting. Each ends with version_unlock on the thread that has locked. */
void version_lock_read(struct version *v);
bool version_try_read(struct version *v);
void version_lock_edit(struct version *v);
bool version_try_edit(struct version *v);
void version_unlock(struct version *v);

/* A reader of a moment has finished: some of what was saved for it is freed at once, the rest by
 * edits and by registry_tidy. NULL is fine. */
void version_end_view(struct registry *r, struct version *v, struct dt_view *view);

/* Whether the triangulation lags behind the points, so that queries must wait for dt_refresh. */
bool version_is_stale(const struct version *v);

/* Whether a request may use the set now; turn: the queue that has called it, NULL: none has. */
bool dataset_admits(const struct dataset *set, bool writes, const struct wait_queue *turn);

/* Makes v the current version; takes over the caller's reference. */
void dataset_publish(struct registry *r, struct dataset *set, struct version *v);

#endif
