/* reading.h - what contours and bands have in common: a linear surface that is read in pieces, as of the moment of a
 * view.
 *
 * First the class of every point is computed, the number of levels that are not above its value. Then most
 * triangles, whose corners have the same class, cost three look-ups. The result must not depend on the order of the
 * triangles, so they are read as they lie in memory. If an edit changes the mesh, the reader begins again with the table
 * of the view. */
#ifndef DT_READING_H
#define DT_READING_H

#include "core/delaunay_surface.h"
#include "core/set/set.h"

#include <math.h>

enum {
    DT_READ_PIECE = 4096,   /* triangles of the table */
    DT_READ_RECORDS = 16384 /* values, or triangles as they lie in memory */
};

/* In the class of a point: the value is a level, or the surface is not a disc around the point (bands.c marks those).
 * A point without a value has the class DT_CLASS. */
#define DT_CLASS_MARK 0x80000000u
#define DT_CLASS 0x7fffffffu

struct dt_reading {
    const struct dt_view *view;   /* borrows */
    const struct dt_field *field; /* borrows */
    double *level;                /* owns */
    uint32_t levels;
    double max_edge;
    bool inside; /* the surface ends at borders */
    struct dt_enclosure enclosure;
    uint32_t *class; /* owns ids */
    uint32_t ids, from;
    bool gaps;       /* some id has no value, so the surface may lack triangles */
    bool tabled;     /* triangles are read from the table */
    uint32_t record; /* the next one of the mesh */
    struct dt_cursor cursor;
    uint32_t triangle[3 * DT_READ_PIECE]; /* of the table: up to `end`, and `at` is next */
    size_t at, end;
};

/* Copies the levels, which are ascending. DT_NOMEM and errors of dt_view_readable leave it to be cleared. *r is zeroed. */
enum dt_status dt_reading_begin(struct dt_reading *r, const struct dt *t, const struct dt_view *v,
                                const struct dt_field *f, const double *level, uint32_t levels,
                                double max_edge);
void dt_reading_clear(struct dt_reading *r);

/* The surface ends at the border of the number, as dt_contour_inside. */
enum dt_status dt_reading_inside(struct dt_reading *r, const struct dt *t, uint32_t number);

/* Whether the next piece can be read. DT_UNSURVEYED: the set was edited, and the surface ends at borders. */
enum dt_status dt_reading_check(const struct dt *t, const struct dt_reading *r);

/* Whether the mesh is not that of the view any more, for the first time: from now on the table is read. */
bool dt_reading_is_late(const struct dt *t, struct dt_reading *r);

/* Reads the classes of the next points; true: of all. */
bool dt_reading_classes(struct dt_reading *r);

static inline uint32_t dt_class(const struct dt_reading *r, uint32_t id)
{
    return r->class[id] & DT_CLASS;
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
    return !r->gaps && !r->inside && r->max_edge == HUGE_VAL;
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

#endif
