/* reading.h - what contours and bands have in common: a linear surface that is read in pieces, as of the moment of a
 * view.
 *
 * First the class of every point is computed, the number of levels that are not above its value. Then most
 * triangles, whose corners have the same class, cost three look-ups. */
#pragma once

#include "core/delaunay_surface.h"
#include "core/triangle/pass.h"

#include <math.h>

enum { DT_READ_PIECE = 16384 }; /* values, or triangles of which few are read */

/* In the class of a point: the value is a level, or the surface is not a disc around the point (bands.c marks those).
 * A point without a value has the class DT_CLASS. */
#define DT_CLASS_MARK 0x80000000u
#define DT_CLASS 0x7fffffffu

struct dt_reading {
    struct dt_pass pass;          /* its callers check it */
    const struct dt_field *field; /* borrows */
    double *level;                /* owns */
    uint32_t levels;
    double max_edge;
    uint32_t *class; /* owns ids */
    uint32_t ids, from;
    bool gaps; /* some id has no value, so the surface may lack triangles */
};

/* Copies the levels, which are ascending. DT_NOMEM and errors of dt_view_readable leave it to be cleared. *r is zeroed. */
enum dt_status dt_reading_begin(struct dt_reading *r, const struct dt *t, const struct dt_view *v,
                                const struct dt_field *f, const double *level, uint32_t levels,
                                double max_edge);
void dt_reading_clear(struct dt_reading *r);

/* Reads the classes of the next points; true: of all. */
bool dt_reading_classes(struct dt_reading *r);

static inline uint32_t dt_class(const struct dt_reading *r, uint32_t id)
{
    return r->class[id] & DT_CLASS;
}

/* The least and the greatest class of the corners: the levels *first .. *end - 1 are between them, unless *end is DT_CLASS. */
static inline void dt_classes_between(const struct dt_reading *r, const uint32_t id[3],
                                      uint32_t *first, uint32_t *end)
{
    *first = *end = dt_class(r, id[0]);
    for (int k = 1; k < 3; k++) {
        uint32_t class = dt_class(r, id[k]);
        *first = class < *first ? class : *first;
        *end = class > *end ? class : *end;
    }
}

/* Takes a triangle of ids, not a ghost; *whole is true, and becomes false to be called again with the same one. */
typedef enum dt_status dt_take_triangle(void *ctx, const struct dt *t, const uint32_t id[3],
                                        bool *whole);

/* Visits the next triangles, those inside if the surface ends at borders. It ends early after one that was not
 * whole. *done: all have been visited. */
enum dt_status dt_reading_visit(const struct dt *t, struct dt_reading *r, dt_take_triangle *take,
                                void *ctx, bool *done);

/* Whether the surface has all triangles. */
static inline bool dt_reading_is_whole(const struct dt_reading *r)
{
    return !r->gaps && !r->pass.inside && r->max_edge == HUGE_VAL;
}

/* Whether the surface has the triangle in this record of the mesh. */
bool dt_reading_has(const struct dt *t, const struct dt_reading *r, uint32_t record);

struct dt_corner {
    uint32_t id, class;
    bool marked; /* DT_CLASS_MARK */
    struct dt_point p;
    double z;
};

/* The corners of a triangle, in its order. */
enum dt_status dt_reading_corners(const struct dt *t, const struct dt_reading *r,
                                  const uint32_t *id, struct dt_corner *corner, int n);

/* Whether no edge of the triangle is longer than max_edge. */
bool dt_reading_is_short(const struct dt_reading *r, const struct dt_corner corner[3]);

/* Whether the three corners have values, and no edge is too long. */
bool dt_reading_has_ids(const struct dt *t, const struct dt_reading *r, const uint32_t id[3]);

/* The place of the level on an edge, from its higher end. In each step rounding is monotone, so higher levels are not nearer
 * to the lower end. At the level of the higher end, it is that end. */
struct dt_point dt_level_place(const struct dt_corner *higher, const struct dt_corner *lower,
                               double level);

/* An edge by its ids, lo < hi. */
struct dt_edge {
    uint32_t lo, hi;
};

static inline struct dt_edge dt_edge_of(uint32_t a, uint32_t b)
{
    return a < b ? (struct dt_edge){a, b} : (struct dt_edge){b, a};
}

static inline size_t dt_edge_hash(uint32_t level, struct dt_edge e)
{
    uint64_t h = (uint64_t)e.lo * 0x9e3779b97f4a7c15u ^ e.hi;
    h = (h ^ h >> 29) * 0xbf58476d1ce4e5b9u ^ level;
    h *= 0x94d049bb133111ebu;
    return (size_t)(h >> 32 ^ h);
}

/* The number of slots of a hash table with linear probing, a power of two. */
size_t dt_edge_slots(size_t n);
