/* nearest_heap.h - of the points that a search has seen, those nearest to a place: a heap with the nearest on top, ties by id.
 *
 * If k results are still wanted, only the nearest k points matter. Now and then the heap is cut down to these; from then
 * on points farther than the last of them are not wanted. So a heap has at most about twice as many points as are
 * wanted. */
#pragma once

#include "core/control/stop.h"
#include "core/exact/predicates.h"

struct dt_seen {
    double d; /* the rounded square of the distance */
    struct dt_point at;
    uint32_t key; /* a vertex, or an id */
};

struct dt_nearest_heap {
    struct dt_point q;
    const uint32_t *id;   /* borrows: ids by key; NULL: a key is an id */
    size_t wanted;        /* results still to come */
    double limit;         /* beyond this square of a distance, rounded, nothing is wanted */
    struct dt_seen *heap; /* owns */
    size_t n, cap;
};

struct dt_nearest_heap dt_nearest_heap_of(struct dt_point q, const uint32_t *id, size_t wanted);
void dt_nearest_heap_clear(struct dt_nearest_heap *h);

/* The bytes that it takes at most when `more` points have been pushed. */
size_t dt_nearest_heap_room(const struct dt_nearest_heap *h, size_t more);

static inline struct dt_seen dt_nearest_heap_see(const struct dt_nearest_heap *h,
                                                 struct dt_point at, uint32_t key)
{
    return (struct dt_seen){dt_square_distance(at, h->q), at, key};
}

/* < 0 if a is nearer than b, exactly. */
static inline int dt_nearest_heap_compare(const struct dt_nearest_heap *h, const struct dt_seen *a,
                                          const struct dt_seen *b)
{
    if (dt_squares_decide(a->d, b->d))
        return a->d < b->d ? -1 : 1;
    return dt_compare_distance(h->q, a->at, b->at);
}

/* Adds a point. work may be NULL. */
enum dt_status dt_nearest_heap_push(struct dt_nearest_heap *h, struct dt_seen c,
                                    struct dt_stop *work);

/* Takes out the nearest; n > 0. */
struct dt_seen dt_nearest_heap_pop(struct dt_nearest_heap *h);
