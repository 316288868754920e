/* value.h - the value of a surface at a place that has been found in the mesh.
 *
 * The value is a function of the points and values alone: where it depends on an order of corners, that order
 * begins with the smallest id, and what is kept from place to place is what would be computed again. */
#ifndef DT_VALUE_H
#define DT_VALUE_H

#include "core/control/stop.h"
#include "core/delaunay_surface.h"
#include "core/surface/circles.h"
#include "core/surface/vicinity.h"
#include "core/surface/weights.h"

/* What one place after the other is computed in, while the set does not change. */
struct dt_valuer {
    const struct dt *t;         /* borrows */
    const struct dt_surface *s; /* borrows */
    struct dt_stop work;
    struct dt_vicinity vicinity;
    struct dt_circles circles;
    uint32_t judged; /* the triangle whose edges were compared with max_edge last; DT_NONE: none */
    bool is_short;   /* none of them is longer */
    struct dt_weigher weigher;
    struct dt_ids ids; /* owns */
};

/* `circles`: how many to keep, a power of two, or 0. DT_NOMEM, DT_UNTRIANGULATED; to be cleared in any case. */
enum dt_status dt_valuer_init(struct dt_valuer *v, const struct dt *t, const struct dt_surface *s,
                              const struct dt_options *opt, uint32_t circles);
void dt_valuer_clear(struct dt_valuer *v);

/* What the value at a place usually takes, in steps. */
static inline uint32_t dt_value_steps(const struct dt_valuer *v)
{
    return v->s->how == DT_LINEAR ? 1 : 8;
}

/* The value at q. *half: a half edge near it, or DT_NONE; becomes the one that dt_find finds (DT_NONE for a set of at most
 * one point). DT_NOMEM, DT_CANCELLED, DT_TOOLONG. */
enum dt_status dt_value_find(struct dt_valuer *v, struct dt_point q, uint32_t *half, double *out);

/* Fetches the values that those at n <= DT_AHEAD places will probably be computed from, given half edges near them. */
void dt_values_fetch(const struct dt_valuer *v, const struct dt_place *p, size_t n);

/* The values at 1 <= n <= DT_ROOM places with the same y, each inside of the triangle of half[i] or on an edge of it along
 * the x axis; as dt_value_find. */
enum { DT_ROOM = 64 };
enum dt_status dt_values_in_row(struct dt_valuer *v, const uint32_t *half, const double *x,
                                double y, uint32_t n, double *out);

/* The value of a surface at a point, and at a vertex. */
static inline double dt_value_of_id(const struct dt_surface *s, uint32_t id)
{
    return *dt_value_place(s, id);
}

static inline double dt_value_of(const struct dt_valuer *v, uint32_t vertex)
{
    return dt_value_of_id(v->s, v->t->points.id[vertex]);
}

/* ---- linear values in doubles (planes.c) ---- */

/* The value at q, inside of the triangle; false: doubles are not exact enough. */
bool dt_plane_value(const struct dt_valuer *v, struct dt_point q, uint32_t half, double *out);

/* Those of dt_values_in_row. Returns bit i where doubles are not exact enough, or place i may be on an edge. */
uint64_t dt_plane_values(const struct dt_valuer *v, const uint32_t *half, const double *x, double y,
                         uint32_t n, double *out);

/* ---- means in doubles (natural.c) ---- */

/* The mean of the natural neighbours of q, strictly inside the hull and in the triangle of `first`; false: doubles are
 * not exact enough, or there are too many of them. */
bool dt_natural_mean(struct dt_valuer *v, struct dt_point q, uint32_t first, double *out);

#endif
