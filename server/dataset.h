/* dataset.h - named sets, their versions, and who waits for them. The I/O thread alone touches what
 * is here.
 *
 * A version is one state of a set, counted by reference. The set refers to its current version; a
 * reply that is still being written and a job that reads pin the version they began with. Nobody
 * but the set referring to the current version, it may be edited in place; pinned, the writer edits
 * a copy, which then becomes the current one. So a reader never sees a half-edited set and never
 * delays a writer.
 *
 * A snapshot pins versions, too, but reads a view (dt_view_begin) and so needs no copy: it and
 * an edit in place take turns, by the version's semaphore. Who edits holds it until the summary has
 * been brought up to date; the snapshot's thread, for some thousand rows at a time.
 *
 * One writer at a time: while a job edits the set, writer is set, and requests that must wait for
 * it stand in a queue (wait.h). If it edits in place, exclusive is set too, and readers wait as
 * well. */
#ifndef SERVER_DATASET_H
#define SERVER_DATASET_H

#include "core/delaunay.h"
#include "proto/request.h"
#include "server/budget.h"
#include "server/wait.h"

#include <semaphore.h>

struct version {
    struct dt *dt; /* owns; not to be looked at while a job edits it in place */
    unsigned refs;
    bool saved; /* one of refs is a snapshot's */
    sem_t turn; /* 1: it is nobody's turn */
    struct dt_summary
        sum; /* what dt holds, as of the last completed edit; sum.memory is accounted for */
};

struct dataset {
    struct dataset *next; /* in its bucket */
    struct version *current;
    struct job *writer; /* the job that edits it; NULL: none */
    bool exclusive;     /* the writer edits in place */
    bool born; /* false while the request that creates it has not succeeded yet: it is not there for
                  others, but its name is taken */
    bool triangulated;       /* TRIANGULATE has been asked for (with --data) */
    bool loading;            /* it was read from disk and its triangulation is not there yet */
    uint64_t lsn;            /* of its last change in the log */
    struct wait_queue queue; /* of requests that wait until it is free */
    size_t name_len;
    char name[SET_NAME_LIMIT + 1];
};

struct registry {
    struct dataset **bucket; /* owns */
    size_t buckets, sets;
    struct reservation memory; /* of all versions */
    struct dt_pages *pages;    /* borrows; where sets have their large arrays; NULL: the system */
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
/* Calls visit for every born set, in no particular order. */
void registry_each(const struct registry *r, void (*visit)(struct dataset *set, void *ctx),
                   void *ctx);

struct version *version_new(struct dt *dt);
/* Frees a version that was never part of a set; NULL is fine, and its set is not freed. */
void version_free(struct version *v);
struct version *version_pin(struct version *v);
void version_unpin(struct registry *r, struct version *v);
/* Brings the summary and the accounting up to date after an edit. */
void version_update(struct registry *r, struct version *v);

/* Whether somebody reads it who must not see it change. */
bool version_is_read(const struct version *v);

/* The turn at the version's set: false if it is another's; waits for it; gives it back, which any
 * thread may do. */
bool version_try(struct version *v);
void version_wait(struct version *v);
void version_leave(struct version *v);

/* Whether the triangulation lags behind the points, so that queries must wait for dt_refresh. */
bool version_is_stale(const struct version *v);

/* Whether a request may use the set now; turn: the queue that has called it, NULL: none has. */
bool dataset_admits(const struct dataset *set, bool writes, const struct wait_queue *turn);

/* Makes v the current version; takes over the caller's reference. */
void dataset_publish(struct registry *r, struct dataset *set, struct version *v);

#endif
