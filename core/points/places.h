/* places.h - finds the representative at, or within the tolerance of, a place: the paper's check
 * for coincident points.
 *
 * The plane is cut into cells twice as wide as the tolerance (with tolerance 0 every place is a
 * cell of its own) and the cells are hashed. The paper looks for coincident points only in the point's own
 * cell. Here the neighbouring cells within reach are searched as well, so two points on either side of a
 * border are found to coincide. */
#pragma once

#include "core/control/stop.h"

#include <string.h>

struct dt_places {
    struct dt_pages *pages; /* borrows; where its arrays come from; NULL: the system */
    uint32_t *bucket;       /* owns mask + 1 heads of chains of vertices; NULL: not built */
    uint32_t *next;         /* owns cap words, by vertex */
    uint32_t mask, cap;
    double tol;
    uint64_t seed; /* differs from process to process, so that no input can target one bucket */
};

/* The hash of a place. Coordinates have structure: most have many zeros at the end, and equal
 * differences. So every bit of a pair must reach every bit of the result. Thus x is mixed before y
 * joins it, and both by the finalizer of SplitMix64 [Steele, Lea & Flood 2014; its constants are
 * Stafford's Mix13]. Zeros have two signs and are one place. */
static inline uint64_t dt_place_hash(double column, double row, uint64_t seed)
{
    double c = column + 0.0, r = row + 0.0;
    uint64_t x, y;
    memcpy(&x, &c, sizeof x);
    memcpy(&y, &r, sizeof y);
    uint64_t h = (x ^ seed) * 0x9E3779B97F4A7C15u;
    h ^= h >> 32 ^ y;
    h = (h ^ h >> 30) * 0xBF58476D1CE4E5B9u;
    h = (h ^ h >> 27) * 0x94D049BB133111EBu;
    return h ^ h >> 31;
}

void dt_places_clear(struct dt_places *p);

/* Makes room for vertices below `verts`. If the table was not built yet or has to grow, those below
 * `end` with id != DT_NONE are entered, which is charged to the work; it may be NULL. A failure
 * changes nothing. */
enum dt_status dt_places_reserve(struct dt_places *p, double tol, const struct dt_point *xy,
                                 const uint32_t *id, uint32_t end, uint32_t verts,
                                 struct dt_stop *work);

/* The vertex nearest to q of those at most tol away, ties to the lowest id, `except` (a vertex or
 * DT_NONE) left out; DT_NONE if there is none. Cost: constant expected. */
uint32_t dt_places_find(const struct dt_places *p, const struct dt_point *xy, const uint32_t *id,
                        struct dt_point q, uint32_t except);

/* Fetches in advance for later dt_places_find of places behind q[0], which is the next of n that are looked up one after the
 * other. It fetches the bucket of a far place, and the vertex in the bucket of a nearer place. With tolerance 0 only. */
void dt_places_fetch(const struct dt_places *p, const struct dt_point *xy, const struct dt_point *q,
                     size_t n);

void dt_places_enter(struct dt_places *p, const struct dt_point *xy, uint32_t v);
void dt_places_leave(struct dt_places *p, const struct dt_point *xy, uint32_t v);
