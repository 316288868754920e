/* value.h - the value of a surface at a place that has been found in the mesh.
 *
 * The value is a function of the points and values alone. If it depends on an order of corners, that order begins with
 * the smallest id. Data that is kept from place to place equals what would be computed again. */
#pragma once

#include "core/control/stop.h"
#include "core/delaunay_surface.h"
#include "core/exact/double2.h"
#include "core/surface/weights.h"
#include "core/triangle/gradient.h"

/* The edge of the hull that is the nearest to the last places outside. */
struct dt_foot_edge {
    uint32_t ghost;                  /* DT_NONE: none yet */
    struct dt_point a, to;           /* one end, and the other one relative to it */
    double out;                      /* 1, or -1: `to` is clockwise along the hull */
    double square;                   /* of its length */
    double first, rise, least, most; /* of the values */
    bool plain;                      /* they are there, and means of them need no scale */
};

/* The work space for one place after the other, while the set does not change. */
struct dt_valuer {
    const struct dt *t;            /* borrows */
    const struct dt_surface *s;    /* borrows */
    struct dt_enclosure enclosure; /* of s->inside */
    struct dt_stop work;
    uint32_t *fetched; /* owns 2 DT_BLOCKS: blocks that have been fetched lately; NULL: none are */
    struct dt_circle *circle; /* owns circle_mask + 1, one place for a triangle; NULL: none */
    uint32_t circle_mask;
    uint32_t judged;  /* the triangle whose edges were compared with max_edge last; DT_NONE: none */
    bool is_short;    /* none of them is longer */
    uint32_t numbers; /* of a place: those of all surfaces */
    uint32_t sloped;  /* the triangle whose slopes were computed last; DT_NONE: none */
    const struct dt_surface *sloped_of;
    double slope[2]; /* its numbers */
    struct dt_foot_edge edge;
    /* DT_SMOOTH: of the surface whose numbers are computed; owns those of all surfaces, in a ring */
    struct dt_smoother *smoother;
    struct dt_weigher weigher;
    struct dt_ids ids; /* owns */
};

/* DT_UNTRIANGULATED; to be cleared in any case. */
enum dt_status dt_valuer_init(struct dt_valuer *v, const struct dt *t, const struct dt_surface *s,
                              const struct dt_options *opt);
void dt_valuer_clear(struct dt_valuer *v);

/* From now on, for n places each near the one before, keeps circles and fetches by blocks. DT_NOMEM. */
enum dt_status dt_valuer_scan(struct dt_valuer *v, size_t n);

/* The usual cost of the value at a place, in steps. */
static inline uint32_t dt_value_steps(const struct dt_valuer *v)
{
    return v->numbers * (v->s->how == DT_LINEAR ? 1 : 8);
}

/* The numbers of all surfaces at q. *half: a half edge near it, or DT_NONE; becomes the one that dt_find finds. For a set of at most one
 * point it becomes DT_NONE, and outside of a surface that goes on beyond the hull, the ghost at the nearest place. DT_NOMEM, DT_CANCELLED,
 * DT_TOOLONG. */
enum dt_status dt_value_find(struct dt_valuer *v, struct dt_point q, uint32_t *half, double *out);

/* The value of the first surface at a place that dt_place_find has found. */
enum dt_status dt_value_there(struct dt_valuer *v, struct dt_point q, enum dt_where where,
                              uint32_t half, double *out);

/* The linear value on an edge at this share of it, 0 to 1 from the origin of the half edge. Errs by less than 2^-52 of itself,
 * 2^-68 of the range of both values, and the least double. */
double dt_value_along(struct dt_valuer *v, uint32_t half, struct dt_double2 share);

/* Fetches the values that those at n <= DT_AHEAD places will probably be computed from, given half edges near them. */
void dt_values_fetch(const struct dt_valuer *v, const struct dt_place *p, size_t n);

/* The numbers at 1 <= n <= DT_ROOM places with the same y, each inside of the triangle of half[i] or on an edge of it along
 * the x axis; as dt_value_find. */
enum { DT_ROOM = 64 };
enum dt_status dt_values_in_row(struct dt_valuer *v, const uint32_t *half, const double *x,
                                double y, uint32_t n, double *out);

/* ---- slopes (slope.c) ---- */

/* Whether the triangle of the half edge has a surface; a ghost has none. */
bool dt_has_surface(struct dt_valuer *v, uint32_t half);

/* The numbers of a surface whose quantity is not DT_HEIGHT, at a place that dt_place_find has found: of the first triangle there, in
 * the order of DT_TRIANGLES, that has a surface. */
enum dt_status dt_slope_at(struct dt_valuer *v, enum dt_where where, uint32_t half, double *out);

/* ---- values of points ---- */

/* Where the value of a surface at a point is; the value; and that at a vertex. */
static inline const double *dt_value_place(const struct dt_surface *s, uint32_t id)
{
    uint32_t page = id / DT_FIELD_PAGE;
    return &s->page[page < s->pages ? page : s->pages][id % DT_FIELD_PAGE];
}

static inline double dt_value_of_id(const struct dt_surface *s, uint32_t id)
{
    return *dt_value_place(s, id);
}

static inline double dt_value_of(const struct dt_valuer *v, uint32_t vertex)
{
    return dt_value_of_id(v->s, v->t->points.id[vertex]);
}

/* ---- prefetches by blocks of what a scan will read ----
 *
 * A build numbers vertices and triangles in Morton order, so a block of numbers lies together in the plane. If a row of a
 * raster needs one of the block, that row and the next ones need most of the others. Values are
 * found by id, which may be in any order. Without that, the scan would wait for each of them. */

enum {
    DT_BLOCKS = 4096,       /* that are remembered as fetched: of triangles, and of vertices */
    DT_BLOCK_VERTICES = 32, /* 8 cache lines of places, up to 32 of values */
    DT_BLOCK_TRIANGLES = 16 /* 8 cache lines */
};

void dt_fetch_triangles(struct dt_valuer *v, uint32_t block);
void dt_fetch_vertices(struct dt_valuer *v, uint32_t block);

/* Fetches what is near the triangle of the half edge, or the vertex, unless that has been done lately. Reads neither. Returns
 * whether it did. */
static inline bool dt_fetch_at_triangle(struct dt_valuer *v, uint32_t half)
{
    uint32_t block = half / (8 * DT_BLOCK_TRIANGLES);
    bool is_new = v->fetched != NULL && v->fetched[block % DT_BLOCKS] != block;
    if (is_new)
        dt_fetch_triangles(v, block);
    return is_new;
}

static inline void dt_fetch_at_vertex(struct dt_valuer *v, uint32_t vertex)
{
    uint32_t block = vertex / DT_BLOCK_VERTICES;
    if (v->fetched != NULL && v->fetched[DT_BLOCKS + block % DT_BLOCKS] != block)
        dt_fetch_vertices(v, block);
}

/* ---- the nearest place of the hull (outside.c) ---- */

/* Means are computed without a scale if the largest magnitude of the values is from the one to the other. */
#define DT_MEAN_LEAST 0x1p-800
#define DT_MEAN_MOST 0x1p1000

/* The value at the place of the hull that is nearest to q, if doubles show that it is inside of the ghost's edge and are exact
 * enough. The edge has a surface. */
bool dt_foot_value(struct dt_valuer *v, struct dt_point q, uint32_t ghost, double *out);

/* Whether q is on the outer side of the edge of the ghost. */
bool dt_foot_sees(const struct dt *t, uint32_t ghost, struct dt_point q);

/* Walks to the place of the hull that is nearest to q, outside. It begins at the edge of *ghost, which q sees; on a line q may
 * be beyond its end. If *corner, the place is the first point of *ghost's edge; otherwise it is inside of that edge.
 * DT_CANCELLED, DT_TOOLONG. Cost: the number of edges between. */
enum dt_status dt_foot_find(struct dt_valuer *v, struct dt_point q, uint32_t *ghost, bool *corner);

/* ---- linear values in doubles (linear.c) ---- */

/* The value at q, inside of the triangle; false: doubles are not exact enough. */
bool dt_plane_value(const struct dt_valuer *v, struct dt_point q, uint32_t half, double *out);

/* The values of dt_values_in_row. Returns bit i if doubles are not exact enough, or place i may be on an edge. */
uint64_t dt_plane_values(const struct dt_valuer *v, const uint32_t *half, const double *x, double y,
                         uint32_t n, double *out);

/* ---- smooth values (smooth.c) ---- */

/* The slopes at points that are kept, while the set does not change. */
struct dt_smoother;

/* Neighbours of a point are taken as on one line if the determinant of its equations is at most this share of the square of their
 * number. */
#define DT_SMOOTH_FLAT 0x1p-30

/* A ring of n smoothers, each of which keeps slopes at up to `points` points, a power of 2. NULL: out of memory. The caller frees
 * it. */
struct dt_smoother *dt_smoothers_new(uint32_t points, uint32_t n);
void dt_smoothers_free(struct dt_smoother *s); /* NULL: nothing */
struct dt_smoother *dt_smoother_next(const struct dt_smoother *s);

/* The value at q, inside the triangle of the half edge; and on an edge, by the linear weights of its ends, the smaller id first. nan
 * where a value is missing; HUGE_VAL where numbers are beyond the range of doubles. DT_NOMEM, DT_TOOLONG, DT_CANCELLED. Cost: the
 * degrees of the corners whose slopes are not kept. */
enum dt_status dt_smooth_value(struct dt_valuer *v, struct dt_point q, uint32_t half, double *out);
enum dt_status dt_smooth_on_edge(struct dt_valuer *v, uint32_t half, const double weight[2],
                                 double *out);

/* ---- means in doubles (natural.c) ---- */

/* The mean of the natural neighbours of q, strictly inside the hull and in the triangle of `first`; false: doubles are
 * not exact enough, or there are too many of them. */
bool dt_natural_mean(struct dt_valuer *v, struct dt_point q, uint32_t first, double *out);

/* From now on, keeps circles for a scan of n places. DT_NOMEM. */
enum dt_status dt_natural_keep(struct dt_valuer *v, size_t n);
