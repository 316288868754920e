/* dataset.h - named sets, their versions, and the queues of requests that wait for them. The reactor that uses a set is alone
 * in the world (loop.h), or is inside the gate of the set's current version, or has closed that gate and edits the set.
 *
 * A version is a set's points and triangulation, with a reference count: the set refers to its current
 * version, jobs and replies to the version that they read. Edits change it in place. Two kinds of edits create a new
 * version, which becomes current when it is complete. One is a build of points that no load has sorted. The other is a large
 * edit of a set that is queried or whose triangles are being sent.
 *
 * A long reader, such as a reply that is being sent or a snapshot, reads the version as it was at one
 * moment (dt_view_begin), piece by piece; edits go on in between. Who edits a version in place has closed its gate (gate.h).
 * Reactors that share the world are inside the gate while they read; a reactor that is alone reads without it while no job
 * edits in place. Workers and the snapshot's thread are visitors while they read a piece, for about a millisecond; reactors
 * do not wait for them.
 *
 * A set has one writer at a time: while a job edits it, `writer` is set, and requests that must wait are
 * in a queue (queue.h). If a worker edits in place, `exclusive` is set too, and readers also wait in the queue. A reactor
 * must not wait at the gate for as long as such an edit takes, and the edit counts only when a reactor has ended the job. */
#pragma once

#include "core/delaunay.h"
#include "proto/request.h"
#include "server/sets/budget.h"
#include "server/sets/queue.h"
#include "server/sets/single_flight.h"
#include "server/system/gate.h"

struct version {
    struct list_link untidy; /* first: in registry.untidy */
    struct dt *dt;           /* owns; not to be read while a job edits it in place */
    unsigned refs;
    struct gate gate;          /* of dt, see above */
    struct dt_summary sum;     /* of dt after the last completed edit */
    struct reservation memory; /* sum.memory */
    /* of its last change in the log; 0: none, or without --data. A worker that edits in place sets it */
    _Atomic uint64_t lsn;
    /* a request has read its triangulation; reactors that share the world set it */
    atomic_bool asked;
};

struct dataset {
    struct list_link expiring; /* first: in registry.expiring_sets, if expires_ms is not 0 */
    struct dataset *next;      /* in its bucket */
    struct version *current;
    struct job *writer; /* the job that edits it; NULL: none */
    bool exclusive;     /* the writer edits in place */
    uint64_t version;   /* after its last change, as clients see it (registry_version) */
    struct single_flight triangulation, proof; /* the last TRIANGULATE and CHECK */
    bool born; /* false until the request that creates it has succeeded: its name is taken, but
                  other requests do not see it */
    bool triangulated;             /* the log has a TRIANGULATE of it (with --data) */
    bool loading;                  /* it was read from disk and is not triangulated yet */
    bool temporary;                /* dropped when its connection ends, and never on disk */
    int64_t expires_ms;            /* when it is dropped, in milliseconds since 1970; 0: never */
    struct list_link fellow;       /* of a temporary set: in the list of its connection's */
    struct request_queue queue;    /* of requests that wait for it */
    struct watched *watched;       /* borrows; who watches it (server/watch); NULL: nobody */
    struct skip_copy *skip_copies; /* owns a list (skip_copy.h) */
    size_t name_len;
    char name[SET_NAME_LIMIT + 1];
};

struct registry {
    struct dataset **bucket; /* owns */
    size_t buckets, sets;
    size_t expiring;           /* sets that are dropped at some time, */
    struct list expiring_sets; /* in the order of registry_next_expiring */
    /* borrows; closed while sets come and go, which is checked; NULL: none */
    const struct gate *world;
    struct budget *budget; /* borrows; of all versions; NULL: none */
    /* owns; of reactors that are inside the gate of a version; empty: there is one reactor */
    struct lanes lanes;
    struct dt_pages *pages;    /* borrows; for the large arrays of sets; NULL: none */
    uint32_t life;             /* the number of this life of the daemon (record.h) */
    _Atomic uint64_t unlogged; /* changes that are in no log */
    struct list untidy;        /* those with data that was saved for readers that have finished */
    struct list skip_copies;   /* copies of all sets (skip_copy.h) */
    /* Frees the copies of a set whose contents are about to go; NULL: there are none. */
    void (*forget)(struct registry *r, struct dataset *set);
    /* Frees a set that nothing refers to any more; freeing a large one is a job. */
    void (*discard)(void *ctx, struct dt *dt);
    void *discard_ctx;
    /* Called when a set that is watched has another version, and before it is dropped; NULL: no session watches. */
    void (*changed)(struct dataset *set);
    void (*dropped)(struct dataset *set);
};

void registry_init(struct registry *r);
/* Frees all sets; no request may wait for one and no version may be pinned. */
void registry_clear(struct registry *r);

/* The set of that name, born or not; NULL: there is none. */
struct dataset *registry_find(const struct registry *r, const struct word *name);
/* A new unborn set; NULL when out of memory. */
struct dataset *registry_create(struct registry *r, const struct word *name, double tolerance);
/* Removes the set and frees it; all requests that wait for it are woken. It must have no writer. */
void registry_drop(struct registry *r, struct dataset *set);
/* The version of a set after a change that has this lsn; 0: it is in no log. Below 2^53, never the same twice, and
 * with a data directory larger than those of earlier lives. */
uint64_t registry_version(struct registry *r, uint64_t lsn);
/* The set has another version. */
void registry_set_version(struct registry *r, struct dataset *set, uint64_t version);
/* A life begins after the life `last` (0: there was none): chooses its number, which grows with the time, and gives
 * versions to the sets that have none. */
void registry_begin_life(struct registry *r, uint32_t last);
/* The same without a data directory, which would have the number of the last life: chooses a random number, because the clock may
 * stand still or be set back. */
void registry_begin_life_in_memory(struct registry *r);
/* Sets when the set is dropped, in milliseconds since 1970 (expire.h); 0: never. */
void registry_expire(struct registry *r, struct dataset *set, int64_t at_ms);
/* The next one of the sets that are dropped at some time, round and round; NULL: there are none. Cost: constant. */
struct dataset *registry_next_expiring(struct registry *r);
/* Frees more of the data that was saved for readers that have finished, in about a millisecond at most. To
 * be called once a second. */
void registry_tidy(struct registry *r);
/* The sets of `from`, which becomes empty, replace the sets of r. The temporary ones stay unless `from` has a set of
 * their name. A set of a name that both have gets the contents and the version of the other one, and clients continue to
 * watch it. If `same`, sets of equal versions are equal, so they stay. Otherwise such sets are dropped. No set that is
 * replaced or dropped may have a writer. False: out of memory; nothing has changed. */
bool registry_replace(struct registry *r, struct registry *from, bool same);
/* Calls visit for every born set, in no particular order. */
void registry_each(const struct registry *r, void (*visit)(struct dataset *set, void *ctx),
                   void *ctx);

/* Visits the born sets of the next bucket and returns the cursor of the bucket after it; 0: that was the
 * last. The first cursor is 0. A set that exists from the first call to the last is visited exactly once,
 * even if others are created and dropped in between. */
size_t registry_scan(const struct registry *r, size_t cursor,
                     void (*visit)(struct dataset *set, void *ctx), void *ctx);

/* A version with one reference; it does not own dt yet: free() is its end unless it becomes part of a set. NULL: out of memory. */
struct version *version_new(struct registry *r, struct dt *dt);
struct version *version_pin(struct version *v);
void version_unpin(struct registry *r, struct version *v);
/* Updates the summary and the budget after an edit. Returns whether it takes another amount of memory now. */
bool version_update(struct registry *r, struct version *v);

/* Ends a view: some of what was saved for it is freed at once, the rest by edits and by registry_tidy. NULL
 * is allowed. */
void version_end_view(struct registry *r, struct version *v, struct dt_view *view);

/* Whether the triangulation is older than the points, so that queries must wait for dt_refresh. */
bool version_is_stale(const struct version *v);

/* Whether a request may use the set now; turn: the queue that has called the request, NULL: none. */
bool dataset_admits(const struct dataset *set, bool writes, const struct request_queue *turn);

/* Makes v the current version; the caller's reference moves to the set. */
void dataset_publish(struct registry *r, struct dataset *set, struct version *v);
