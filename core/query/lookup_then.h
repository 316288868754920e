/* lookup_then.h - where a place was, and which points were nearest to it, at the moment of a view
 * since which the set has changed.
 *
 * The mesh knows the present only. What a view keeps are rows and rings, by id; so both searches go
 * from ring to ring. They are slower than those of the present, by the reading of a ring for each step,
 * and are for the places round which something has changed. */
#ifndef DT_LOOKUP_THEN_H
#define DT_LOOKUP_THEN_H

#include "core/control/stop.h"
#include "core/query/query.h"
#include "core/set/set.h"
#include "core/set/view_rows.h"
#include "core/set/view_stars.h"

#include <string.h>

/* Makes best[3] the triangle a b c (counterclockwise), from its smallest id, if that comes before best in
 * DT_TRIANGLES. DT_NONE three times comes behind all. */
static inline void dt_first_triangle(uint32_t best[3], uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t row[3] = {a, b, c};
    dt_triangle_turn(row);
    if (dt_triangle_compare(row, best) < 0)
        memcpy(best, row, sizeof row);
}

/* The rings and places of that moment. */
struct dt_then {
    const struct dt *t;
    const struct dt_view *v;
    struct dt_stop *work;        /* borrows */
    uint32_t id;                 /* whose star was read last; DT_NONE: none was read */
    struct dt_neighbours around; /* owns: that star */
};

struct dt_then dt_then_of(const struct dt *t, const struct dt_view *v, struct dt_stop *work);
void dt_then_clear(struct dt_then *r);

/* Reads the star of what was a representative into r->around. */
enum dt_status dt_then_read(struct dt_then *r, uint32_t id);

static inline struct dt_point dt_then_place(const struct dt_then *r, uint32_t id)
{
    return dt_view_place(r->t, r->v, id);
}

/* A row of dt_locate_many at the moment of v, which is readable. `from` was a vertex, best one near q; DT_NONE: there
 * was none. All of out is DT_NONE on entry. */
enum dt_status dt_locate_then(const struct dt *t, const struct dt_view *v, struct dt_point q,
                              uint32_t from, struct dt_stop *work, uint32_t out[3]);

/* The same for dt_nearest_many: appends up to k ids. */
enum dt_status dt_nearest_then(const struct dt *t, const struct dt_view *v, struct dt_point q,
                               uint32_t from, uint32_t k, struct dt_stop *work, struct dt_ids *out);

#endif
