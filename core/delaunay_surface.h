/* delaunay_surface.h - the second part of the core's public header: what is computed from a triangulation when
 * its points carry values or cells. */
#ifndef DT_DELAUNAY_SURFACE_H
#define DT_DELAUNAY_SURFACE_H

#include "core/delaunay_fields.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- weights: with which weights the values at points count at a place between them ---- */

enum dt_interpolation {
    DT_LINEAR,  /* in the triangle around the place; canonical, like the triangulation */
    DT_NATURAL, /* Sibson's, of natural neighbours: smooth except at the points */
    DT_LAPLACE, /* of natural neighbours, by the edges of Voronoi cells: continuous */
    DT_CLOSEST /* the value of the nearest point, of the smallest id if several tie; for values only */
};

/* The errors of the weights at a place add up to less than this. So the weighted mean of the points is the
 * place, within this times the distance of the farthest of them. */
#define DT_WEIGHTS_ERROR 0x1p-40

struct dt_weight {
    uint32_t id;
    double weight; /* at least 0 */
};

/* Reads what the weights at q are computed from into *out, which the caller frees. opt may be NULL: its flag and
 * its steps. Cost: that of dt_locate and the number of natural neighbours. */
struct dt_weigher;
enum dt_status dt_weights_begin(const struct dt *t, struct dt_point q, enum dt_interpolation how,
                                const struct dt_options *opt, struct dt_weigher **out);

/* The bytes that it holds, and those that dt_weights_end takes at most: limited as below, or `exact`, not so. */
size_t dt_weights_memory(const struct dt_weigher *w, bool exact);

/* The *n weights, by ascending ids, in *out, which the caller frees; none outside the hull; at a point 1; on an
 * edge of the hull linear along the edge. Does not read the set. opt may be NULL: its flag is polled. Cost: the
 * number of natural neighbours; some thousand times as much where double words are not exact enough: DT_TOOLONG
 * then if opt limits the steps, and it may be called again. */
enum dt_status dt_weights_end(struct dt_weigher *w, const struct dt_options *opt,
                              struct dt_weight **out, size_t *n);

void dt_weights_free(struct dt_weigher *w); /* NULL: nothing */

/* ---- values between points ----
 *
 * A surface is a triangulation with a value at each representative. Its value at a place depends on the points, their
 * ids and values alone, not on how the triangulation came about or what was asked before: equal sets give equal bytes.
 *
 *   at a point            its value, exactly
 *   on an edge            of the hull, and with DT_LINEAR of any triangle: linear between the two ends
 *   elsewhere inside      the mean of the values of the points around, by the weights above
 *   outside the hull      nan
 *
 * It is nan where a value that counts is nan, and in triangles that have an edge longer than max_edge, but for
 * their corners and for edges that another triangle without such an edge shares. A mean is never outside the range
 * of the values that count; it errs by less than DT_WEIGHTS_ERROR times their range, and 2^-51 times the largest
 * magnitude of them. */
struct dt_surface {
    const double *
        *page;      /* owns; values by id, DT_FIELD_PAGE in each; NULL: all of these are missing */
    uint32_t pages; /* beyond them all are missing, too */
    enum dt_interpolation how;
    double max_edge; /* HUGE_VAL: any */
};

/* Sets the pages of *s: the values of a field at the moment of the view, now if v is NULL. Valid until the next edit of
 * the set; its view must be open until then. Cost: linear, some 20 ns for DT_FIELD_PAGE ids. */
enum dt_status dt_surface_begin(struct dt_surface *s, const struct dt_field *f,
                                const struct dt_view *v);
void dt_surface_end(struct dt_surface *s);

/* Cells of a box, in rows from the north (hi.y) to the south, each from west to east. Cell i of a row of n has its
 * centre at lo.x + (hi.x - lo.x) (2 i + 1) / (2 n), row j of n at hi.y - (hi.y - lo.y) (2 j + 1) / (2 n), as these
 * round, and 0 where dt_coordinate_ok refuses so small a number. */
struct dt_raster {
    struct dt_point lo, hi;
    uint32_t columns, rows; /* at least 1 */
};

struct dt_point dt_raster_centre(const struct dt_raster *r, uint64_t cell);

/* The values at n places, or at the centres of n cells from the cell `from` on. DT_TOOLONG, DT_CANCELLED: *done of
 * them are written, and the call may be repeated for the others; all n if DT_OK. opt may be NULL: its flag and its
 * steps. Cost: that of dt_locate for each place; for cells, the number of cells and of triangles along their rows; and
 * the number of natural neighbours. */
enum dt_status dt_values(const struct dt *t, const struct dt_surface *s, const struct dt_point *q,
                         size_t n, const struct dt_options *opt, double *out, size_t *done);
enum dt_status dt_raster_values(const struct dt *t, const struct dt_surface *s,
                                const struct dt_raster *r, uint64_t from, size_t n,
                                const struct dt_options *opt, double *out, size_t *done);

/* ---- contours: where the linear surface has a value ----
 *
 * A point whose value is the level, or more, is above it. In every triangle that has corners above and below, the
 * line goes straight from edge to edge, with the higher ground on its left; on an edge it is at a place that depends
 * on its ends, their values and the level alone. So lines never branch and never cross; they may touch at a point
 * whose value is the level. A line is closed, or it begins and ends where there is no surface: at the hull, or at
 * a triangle that has an edge longer than max_edge or a corner without a value.
 *
 * The order is canonical. A closed line begins on the edge whose ids come first, the smaller one compared first; lines
 * are sorted by their levels, and then by the edges on which they begin. Places that are equal to the one before are
 * left out, and then open lines of one place and closed ones of fewer than three.
 *
 *     dt_contour_begin(t, view, field, level, levels, max_edge, &c);
 *     do
 *         dt_contour_read(t, c, &done);         under the caller's lock
 *     while (!done);
 *     dt_contour_end(c, &opt, &line, &lines);   which needs the set no more
 *     dt_contour_free(c);
 */
struct dt_contour;

struct dt_contour_line {
    double level;
    bool closed;        /* its last place is joined to its first one */
    struct dt_point *p; /* borrowed from the contour */
    size_t n;
};

/* `level`: ascending, copied. The view must be one that reads rings, open until the last dt_contour_read; NULL: now,
 * and the set must not change until then. Cost: 4 bytes for each id. */
enum dt_status dt_contour_begin(const struct dt *t, const struct dt_view *v,
                                const struct dt_field *f, const double *level, uint32_t levels,
                                double max_edge, struct dt_contour **out);

/* Reads the next piece: rows, triangles or crossings, some thousands of them. */
enum dt_status dt_contour_read(const struct dt *t, struct dt_contour *c, bool *done);

/* Bytes that it will have at most after the next dt_contour_read or dt_contour_end. */
size_t dt_contour_memory(const struct dt_contour *c);

/* Joins what has been read to lines. opt may be NULL: its flag is polled. Cost: linear in the places of the lines,
 * and the sorting of the lines. */
enum dt_status dt_contour_end(struct dt_contour *c, const struct dt_options *opt,
                              const struct dt_contour_line **line, size_t *lines);

void dt_contour_free(struct dt_contour *c); /* NULL: nothing */

#ifdef __cplusplus
}
#endif

#endif
