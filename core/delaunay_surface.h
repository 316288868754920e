/* delaunay_surface.h - the second part of the core's public header: what is computed from a triangulation when
 * its points carry values or cells. */
#pragma once

#include "core/delaunay_fields.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- weights: with which weights the values at points count at a place between them ---- */

enum dt_interpolation {
    DT_LINEAR,  /* in the triangle around the place; canonical, like the triangulation */
    DT_NATURAL, /* Sibson's, of natural neighbours: smooth except at the points */
    DT_LAPLACE, /* of natural neighbours, by the edges of Voronoi cells: continuous */
    DT_CLOSEST, /* the value of the nearest point, of the smallest id if several tie; for values only */
    DT_SMOOTH /* cubic in each third of a triangle, with continuous slopes; for values only */
};

/* The errors of the weights at a place add up to less than this. So the weighted mean of the points is the
 * place, within this times the distance of the farthest of them. */
#define DT_WEIGHTS_ERROR 0x1p-40

struct dt_weight {
    uint32_t id;
    double weight; /* at least 0 */
};

/* Reads the data of the weights at q into *out, which the caller frees. opt may be NULL: its flag and
 * its steps. Cost: as dt_locate, and the number of natural neighbours. */
struct dt_weigher;
enum dt_status dt_weights_begin(const struct dt *t, struct dt_point q, enum dt_interpolation how,
                                const struct dt_options *opt, struct dt_weigher **out);

/* The bytes that it holds, and those that dt_weights_end takes at most: limited as below, or `exact`, not so. */
size_t dt_weights_memory(const struct dt_weigher *w, bool exact);

/* The *n weights, by ascending ids, in *out, which the caller frees; none outside the hull; at a point 1; on an
 * edge of the hull linear along the edge. Does not read the set. opt may be NULL: its flag is polled. Cost: the
 * number of natural neighbours; some thousand times more if double words are not exact enough. If opt limits the steps, it
 * then returns DT_TOOLONG, and may be called again. */
enum dt_status dt_weights_end(struct dt_weigher *w, const struct dt_options *opt,
                              struct dt_weight **out, size_t *n);

void dt_weights_free(struct dt_weigher *w); /* NULL: nothing */

/* The numbers of a surface at a place. All but the height describe the linear surface in one triangle: the first one at the place, in
 * the order of DT_TRIANGLES, that has a surface. They are nan where there is none, and where a value at a corner of the
 * triangle is missing. The direction of a level triangle is nan, too. */
enum dt_quantity {
    DT_HEIGHT,   /* its value */
    DT_GRADIENT, /* two numbers: by how much the value grows for a unit of x, and of y; both the nearest double, ties to even */
    DT_SLOPE,    /* how steep it is, as dt_degrees_steep has it: 0 to 90 degrees */
    DT_ASPECT /* the direction in which it falls: degrees clockwise from the positive y axis, from 0 up to but not including 360 */
};

/* ---- values between points ----
 *
 * A surface is a triangulation with a value at each representative. Its value at a place depends on the points, their
 * ids and values alone, not on how the triangulation came about or what was asked before: equal sets give equal bytes.
 *
 *   at a point            its value, exactly
 *   on an edge            of the hull, and with DT_LINEAR of any triangle: linear between the two ends
 *   with DT_SMOOTH        the cubic of the triangle or edge (core/surface/smooth.c), linear beyond the range of doubles
 *   elsewhere inside      the mean of the values of the points around, by the weights above
 *   outside the hull      nan; or, if it goes on beyond the hull, the value at the nearest place of the hull, on an edge linear
 *                         between the two ends; with DT_CLOSEST the value of the nearest point
 *
 * It is nan where a value that counts is nan, and in triangles that have an edge longer than max_edge, but for
 * their corners and for edges that another triangle without such an edge shares; and where no triangle around the place is
 * inside borders, if the surface ends there. A mean, but not a cubic, is never outside the range
 * of the values that count; it errs by less than DT_WEIGHTS_ERROR times their range, 2^-51 times the largest
 * magnitude of them, and the least double, 2^-1074. */
struct dt_surface {
    const double **page; /* owns; values by id, DT_FIELD_PAGE in each */
    uint32_t pages;      /* page[pages] is one of missing values, for all ids beyond */
    enum dt_interpolation how;
    double max_edge; /* HUGE_VAL: any */
    bool inside;     /* the surface ends at the border of the number, or at all borders: DT_NONE */
    uint32_t number;
    bool beyond; /* it goes on beyond the hull */
    enum dt_quantity quantity;
    /* borrows; NULL: none; the surface of another field, found in the same search: the same but for its pages */
    const struct dt_surface *next;
};

/* The number of numbers of a place. */
static inline uint32_t dt_surface_numbers(const struct dt_surface *s)
{
    return s->quantity == DT_GRADIENT ? 2 : 1;
}

/* Sets the pages of *s: the values of a field at the moment of the view, now if v is NULL. Valid until the next edit of
 * the set; its view must stay open for as long. Cost: one step for DT_FIELD_PAGE ids. */
enum dt_status dt_surface_begin(struct dt_surface *s, const struct dt_field *f,
                                const struct dt_view *v);
void dt_surface_end(struct dt_surface *s);

/* Cells of a box, in rows from the north (hi.y) to the south, each from west to east. Centres are rounded, and 0 if
 * dt_coordinate_ok refuses so small a number. The centre of cell i of a row of n is at lo.x + (hi.x - lo.x) (2 i + 1) / (2 n).
 * The centre of row j of n is at hi.y - (hi.y - lo.y) (2 j + 1) / (2 n). */
struct dt_raster {
    struct dt_point lo, hi;
    uint32_t columns, rows; /* at least 1 */
};

struct dt_point dt_raster_centre(const struct dt_raster *r, uint64_t cell);

/* The values at n places, or at the centres of n cells from the cell `from` on. Of each place, the numbers of all surfaces follow
 * each other. Errors of dt_region_check. DT_TOOLONG, DT_CANCELLED: *done of them are written, and the call may be repeated for
 * the others; all n if DT_OK. opt may be NULL: its flag and its steps. Cost: for each place, as dt_locate; for cells, the number
 * of cells and of triangles along their rows. For both, the number of natural neighbours. Cells are shared among the threads of
 * opt->pool, unless steps are limited; then *done is n or 0. */
enum dt_status dt_values(const struct dt *t, const struct dt_surface *s, const struct dt_point *q,
                         size_t n, const struct dt_options *opt, double *out, size_t *done);
enum dt_status dt_raster_values(const struct dt *t, const struct dt_surface *s,
                                const struct dt_raster *r, uint64_t from, size_t n,
                                const struct dt_options *opt, double *out, size_t *done);

/* Finds the cells that have their centres inside the border of the number, or on its edge; inside any border if the number is DT_NONE. Bit
 * i % 8 of bits[i / 8] is 1. Errors of dt_region_check, and DT_OPEN if all borders are open; DT_NOMEM. opt may be NULL: its flag is polled.
 * Cost: 1 MB and a byte for each 8 cells. If borders have few edges for the cells, a search for each row that such an edge meets; otherwise
 * a dt_locate for each cell. */
enum dt_status dt_raster_inside(const struct dt *t, uint32_t number, const struct dt_raster *r,
                                const struct dt_options *opt, uint8_t *bits);

/* ---- profiles: the linear surface along a way of straight pieces ----
 *
 *     dt_profile_begin(t, &surface, place, n, &opt, &p);
 *     do
 *         dt_profile_read(p, row, 4096, &rows);  the set must not change until the last one
 *     while (rows > 0);
 *     dt_profile_free(p);
 *
 * Each of the n places has a row. Along each piece, in their order, every vertex strictly between its ends has one, and every edge
 * whose inside crosses the piece. A piece that runs along edges passes their ends. The choice of rows is exact. Outside the
 * hull only places have rows. Rows depend on the points, their values, the constraints and the places alone. */
struct dt_profile_row {
    double distance; /* of the way from the first place */
    double x, y;
    double value; /* nan where there is no surface */
};

/* A distance errs by less than 2^-52 of itself, and is never less than the distance in the row before. Each coordinate of a crossing
 * is rounded once to the nearest one that dt_coordinate_ok accepts, ties to even. The value at a place is the value of dt_values,
 * and at a vertex it is exact. At a crossing it errs by less than 2^-52 of itself, 2^-68 of the range of the edge's values,
 * and the least double.
 *
 * The surface is linear. Borrows it and the places, which dt_coordinate_ok accepts. opt may be NULL: its flag and its steps, of all
 * reads together. Errors of dt_region_check. */
struct dt_profile;
enum dt_status dt_profile_begin(const struct dt *t, const struct dt_surface *s,
                                const struct dt_point *place, size_t n,
                                const struct dt_options *opt, struct dt_profile **out);

/* The next rows, at most `room`; *n says how many, 0 at the end. DT_TOOLONG, DT_CANCELLED: the rows cannot be completed. Cost: a
 * dt_locate for each place, the edges and vertices on the way, and their degrees. A place outside costs at most the
 * edges of the hull that it sees. */
enum dt_status dt_profile_read(struct dt_profile *p, struct dt_profile_row *row, size_t room,
                               size_t *n);

void dt_profile_free(struct dt_profile *p); /* NULL: nothing */

/* ---- Voronoi cells: the places that are nearer to one point than to all others, clipped to a box ----
 *
 * Every corner of a cell is an exact place: a circumcentre, a point at which a bisector meets a side of the box, or a corner
 * of the box. Each of its coordinates is rounded once to the nearest double. So cells that share an edge have the same bytes
 * along it, and the cells tile the box: with their signs, the areas of the polygons add up to it exactly. Both x and y
 * grow and fall once around a cell. Cells that are thinner than the distance of neighbouring doubles may
 * lose their area or overlap by that distance. Corners of several triangles on one circle are one corner.
 *
 * Cells are read as tables are (dt_table_begin), by the ids of the representatives. The same set gives the same bytes,
 * for any history and any triangulation of cocircular points. */

/* The search for the box around all points, a piece at a time. Start with {0}. */
struct dt_bounds {
    struct dt_point lo, hi; /* so far */
    bool any;
    /* private */
    bool rows;
    uint32_t ghost, from;
};

/* Takes about `steps` points into account, and sets *done when the box is complete, as of the view or, if it is NULL, now.
 * It is the box of the hull while the view's set has not been edited, and of all rows otherwise. The view must be one
 * that reads rings. Cost: O(steps). */
enum dt_status dt_bounds_read(const struct dt *t, const struct dt_view *v, struct dt_bounds *b,
                              size_t steps, bool *done);

/* The usual box for cells: the box grown by half of its longer side. Around a single place it grows by the largest of 1,
 * |x| and |y|. {0, 0} to {1, 1} if there is no point. */
void dt_bounds_grow(const struct dt_bounds *b, struct dt_point *lo, struct dt_point *hi);

struct dt_cells {
    struct dt_point lo, hi;           /* of the box */
    uint32_t rows;                    /* cells of the whole set */
    const struct dt_cells_made *made; /* borrows: to be read; NULL: made as they are read */
    const struct dt_options *opt;     /* borrows: of dt_cells_read, whose flag is polled; or NULL */
    /* private from here on */
    const struct dt_view *view;
    uint32_t id, end;
};

struct dt_cell {
    uint32_t id, corners;
};

/* lo.x < hi.x and lo.y < hi.y, or DT_RANGE; up to 2^203. v may be NULL. */
enum dt_status dt_cells_begin(const struct dt *t, const struct dt_view *v, struct dt_point lo,
                              struct dt_point hi, struct dt_cells *c);

/* Makes a cursor of now one of a view that was begun since, while the set has not been edited. */
void dt_cells_as_of(struct dt_cells *c, const struct dt_view *v);

/* As dt_table_cut. */
bool dt_cells_cut(const struct dt *t, struct dt_cells *c, uint32_t ids, struct dt_cells *part);

/* A cursor of the cell of one representative, in *one. */
void dt_cells_only(const struct dt_cells *c, uint32_t id, struct dt_cells *one);

/* The next cells, at most `room`, into cell[], and their corners into corner[cap], counterclockwise from the least by x,
 * then y. A cell has at least three corners, or none if it is not in the box or touches it only. Then *n is the number of
 * cells, 0 at the end, and *corners the number of their corners; corner[] is undefined behind these. DT_TOOSMALL: the
 * next cell alone has at most *corners. DT_TOOLONG: the steps of opt end after *n cells; 0: the next one alone takes more.
 * DT_CANCELLED. Cost: linear in the corners (times in tests/bench); single corners that double words do
 * not decide cost hundreds of times more. */
enum dt_status dt_cells_read(const struct dt *t, struct dt_cells *c, struct dt_cell *cell,
                             size_t room, struct dt_point *corner, size_t cap, size_t *n,
                             size_t *corners);

/* ---- all cells at once: in a third of the time, in about 105 bytes for each ----
 *
 *     dt_cells_make_begin(t, &cells, &m);
 *     do
 *         dt_cells_make(t, m, 4096, &done);   under the caller's lock; the set must not be edited until then
 *     while (!done);
 *     cells.made = m;                         dt_cells_read does not read the set any more
 *     ...
 *     dt_cells_made_free(m);
 */
struct dt_cells_made;

/* For the cells of a cursor of now, *out; NULL: not for this set, since its points are on a line, or since there are more
 * than twice as many ids as points. */
enum dt_status dt_cells_make_begin(const struct dt *t, const struct dt_cells *c,
                                   struct dt_cells_made **out);

/* The same for the areas of the cells alone, in 8 bytes for each id; dt_cells_make makes them, too, and dt_areas_read reads
 * them. */
enum dt_status dt_areas_make_begin(const struct dt *t, const struct dt_cells *c,
                                   struct dt_cells_made **out);

/* Makes about `points` more cells. *done: all are made. DT_NOMEM, DT_CANCELLED by the flag of opt, which may be NULL. Cost:
 * linear. */
enum dt_status dt_cells_make(const struct dt *t, struct dt_cells_made *m,
                             const struct dt_options *opt, uint32_t points, bool *done);

/* Bytes that it has after the first dt_cells_make; many cells that the box cuts can add to that. */
size_t dt_cells_made_memory(const struct dt_cells_made *m);

/* The number of corners that all cells have together; not of areas. */
uint64_t dt_cells_made_corners(const struct dt_cells_made *m);

void dt_cells_made_free(struct dt_cells_made *m); /* NULL: nothing */

/* ---- alpha shapes: the union of the triangles whose circumradius is at most r ----
 *
 *     dt_alpha_begin(t, view, r, &a);
 *     do
 *         dt_alpha_read(t, a, 4096, &done);   under the caller's lock
 *     while (!done);
 *     dt_alpha_end(a, NULL, &rows, &loops);   which does not need the set
 *     dt_alpha_free(a);
 *
 * The view must be one that reads rings, or is NULL: now, and the set must not change between. Exact: a circle of
 * radius r itself counts. */
struct dt_alpha;
enum dt_status dt_alpha_begin(const struct dt *t, const struct dt_view *v, double radius,
                              struct dt_alpha **out);

/* Reads the stars of about `points` more points. *done: all have been read. Cost: their degrees. */
enum dt_status dt_alpha_read(const struct dt *t, struct dt_alpha *a, uint32_t points, bool *done);

/* Bytes that it has at most after `points` more points have been read, and dt_alpha_end with its result; points with more
 * than six neighbours can add to that. */
size_t dt_alpha_memory(const struct dt_alpha *a, uint32_t points);

/* Appends the boundary as loops, each as 0 for an outer one, counterclockwise, or 1 for a hole, clockwise; the number of
 * its points; and their ids from the least one on. No loop passes a point twice; loops may touch in points. They are
 * sorted by their ids. Once only. opt may be NULL: its flag is polled. Cost: O(k log k) for k points of the boundary. */
enum dt_status dt_alpha_end(struct dt_alpha *a, const struct dt_options *opt, struct dt_ids *out,
                            size_t *loops);

void dt_alpha_free(struct dt_alpha *a); /* NULL: nothing */

/* The least radius, of all doubles, whose alpha shape is one piece, connected through edges, and has every representative in it or
 * on it. Larger radii may not give that, because a triangle that comes later need not be beside those that are there. As above:
 *
 *     dt_alpha_auto_begin(t, view, &a);
 *     do
 *         dt_alpha_auto_read(t, a, &done);    under the caller's lock
 *     while (!done);
 *     dt_alpha_auto_end(a, NULL, &radius);    which does not need the set
 *     dt_alpha_auto_free(a);
 *
 * 0 if there are no triangles. Exact. Cost: O(n log n); radii whose order rounding leaves open are compared exactly, about ten
 * times as slowly. */
struct dt_alpha_auto;
enum dt_status dt_alpha_auto_begin(const struct dt *t, const struct dt_view *v,
                                   struct dt_alpha_auto **out);

/* Reads the next triangles, about a thousand. *done: there are no more. */
enum dt_status dt_alpha_auto_read(const struct dt *t, struct dt_alpha_auto *a, bool *done);

/* Bytes that it has at most, dt_alpha_auto_end included. */
size_t dt_alpha_auto_memory(const struct dt_alpha_auto *a);

/* opt may be NULL: its flag is polled. */
enum dt_status dt_alpha_auto_end(struct dt_alpha_auto *a, const struct dt_options *opt,
                                 double *radius);
void dt_alpha_auto_free(struct dt_alpha_auto *a); /* NULL: nothing */

/* The signed area of a polygon, positive if it is counterclockwise: within 2^-52 of its value, and 2^-98 n of the area
 * of its bounding box. */
double dt_polygon_area(const struct dt_point *corner, size_t n);

/* The next areas of a cursor whose areas have been made, as dt_polygon_area gives them: ids and areas of at most `room`
 * cells. Returns how many; 0 at the end. */
size_t dt_areas_read(struct dt_cells *c, uint32_t *id, double *area, size_t room);

/* The areas of n cells, with the same bytes, into area[n]; corner[]: their corners, cell after cell, as
 * dt_cells_read writes them. Faster than one by one. */
void dt_cell_areas(const struct dt_cell *cell, size_t n, const struct dt_point *corner,
                   double *area);

/* Whether the triangulation is still that of the view: so a caller who reads in pieces, under a lock that edits may take
 * in between, learns whether the pieces belong together. Constant. */
bool dt_view_is_current(const struct dt *t, const struct dt_view *v);

/* ---- contours: where the linear surface has a value ----
 *
 * A point whose value is the level, or more, is above it. In every triangle that has corners above and below, the
 * line goes straight from edge to edge, with the higher ground on its left. Its place on an edge depends on the ends of the
 * edge, their values and the level alone. So lines never branch and never cross; they may touch at a point
 * whose value is the level. A line is closed, or it begins and ends where there is no surface. There is none outside the
 * hull, and none in a triangle that has an edge longer than max_edge or a corner without a value, or is not inside
 * (dt_contour_inside).
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

/* The levels at equal steps between two finite values, both included: base + k step for integers k, step > 0. Each level is
 * computed exactly and rounded once to the nearest double, ties to even, before it is compared with the values. Levels are
 * ascending, each once. Returns how many there are; cap + 1 if they, or the levels before rounding, are more than cap. */
size_t dt_levels_every(double least, double most, double step, double base, double *level,
                       size_t cap);

/* The same, from the greatest level that is not above `least` to the least one that is above `most`: so bands between them
 * cover the values. The last may be infinite. */
size_t dt_levels_around(double least, double most, double step, double base, double *level,
                        size_t cap);

struct dt_contour_line {
    double level;
    bool closed;        /* its last place is joined to its first one */
    struct dt_point *p; /* borrowed from the contour */
    size_t n;
};

/* `level`: ascending, copied. The view must be one that reads rings, open until the last dt_contour_read. NULL: now,
 * and the set must not change until the last dt_contour_read. Cost: 4 bytes for each id. */
enum dt_status dt_contour_begin(const struct dt *t, const struct dt_view *v,
                                const struct dt_field *f, const double *level, uint32_t levels,
                                double max_edge, struct dt_contour **out);

/* Before the first dt_contour_read: lines end at the border of the number, or at all borders if that is DT_NONE. Then the set must
 * not be edited until all are read: DT_UNSURVEYED. Errors of dt_region_check. */
enum dt_status dt_contour_inside(struct dt_contour *c, const struct dt *t, uint32_t number);

/* Reads the next piece: values, triangles or crossings, some thousands of them. If the set of the view is edited before all
 * are read, the triangles are read again, as they were. */
enum dt_status dt_contour_read(const struct dt *t, struct dt_contour *c, bool *done);

/* Bytes that it will have at most after the next dt_contour_read or dt_contour_end. */
size_t dt_contour_memory(const struct dt_contour *c);

/* Joins what has been read to lines. opt may be NULL: its flag is polled. Cost: linear in the places of the lines,
 * and the sorting of the lines. */
enum dt_status dt_contour_end(struct dt_contour *c, const struct dt_options *opt,
                              const struct dt_contour_line **line, size_t *lines);

void dt_contour_free(struct dt_contour *c); /* NULL: nothing */

/* ---- bands: polygons between neighbouring levels ----
 *
 * The band of two neighbouring levels is the part of the linear surface between them. As for contours, a point whose value is a
 * level is above it: so a plateau at a level belongs to the band above. A triangle has no band if a corner has no value, if an
 * edge is longer than max_edge, or if it is not inside (dt_bands_inside). The bands tile the rest between the lowest level and
 * the highest. The first level may be -HUGE_VAL, and the last one HUGE_VAL; then the bands tile all of the rest.
 *
 * Each connected part of a band is a polygon: an outer ring, counterclockwise, and its holes, clockwise. Two parts that
 * touch in points only are two polygons. Rings are simple; they may touch in points of the set. They are made of the
 * places of contours, so neighbouring bands have the same bytes there, and of edges of the surface's border.
 *
 * The rings are exact and canonical; only places on edges are rounded, as those of contours. So a ring may touch or cross
 * itself or another ring by the distance of neighbouring doubles. Places that are equal to the one before are
 * left out, and then rings of fewer than three, with the holes of such an outer ring.
 *
 * A ring begins with its least place by x, then y. Polygons are sorted by their levels, then by the places of their outer rings;
 * holes follow their outer ring, sorted by their places.
 *
 *     dt_bands_begin(t, view, field, level, levels, max_edge, &b);
 *     do
 *         dt_bands_read(t, b, &done);         under the caller's lock
 *     while (!done);
 *     dt_bands_end(b, &opt, &ring, &rings);   which needs the set no more
 *     dt_bands_free(b);
 *
 * All functions as those of contours. Cost: 8 bytes for each id; linear in the triangles and in the places of the rings, and
 * the sorting of the rings. */
struct dt_bands;

struct dt_band_ring {
    double low, high;   /* the levels */
    uint32_t number;    /* of the polygon, from 0 on: those with the same number belong together */
    bool hole;          /* not the outer ring, which comes first */
    struct dt_point *p; /* borrowed from the bands; the last place is joined to the first one */
    size_t n;           /* at least 3 */
};

enum dt_status dt_bands_begin(const struct dt *t, const struct dt_view *v, const struct dt_field *f,
                              const double *level, uint32_t levels, double max_edge,
                              struct dt_bands **out);
enum dt_status dt_bands_inside(struct dt_bands *b, const struct dt *t, uint32_t number);
enum dt_status dt_bands_read(const struct dt *t, struct dt_bands *b, bool *done);
size_t dt_bands_memory(const struct dt_bands *b);
enum dt_status dt_bands_end(struct dt_bands *b, const struct dt_options *opt,
                            const struct dt_band_ring **ring, size_t *rings);
void dt_bands_free(struct dt_bands *b); /* NULL: nothing */

/* ---- volumes between the linear surface and a level, or another surface ----
 *
 *     dt_volume_begin(t, view, field, NULL, level, &v);
 *     do
 *         dt_volume_read(t, v, &done);          under the caller's lock
 *     while (!done);
 *     dt_volume_end(v, &sums);                  which needs the set no more
 *     dt_volume_free(v);
 *
 * There is a surface in the triangles whose corners all have values, of both fields. Equal sets have equal bytes: the
 * numbers of all triangles are summed up exactly. */
struct dt_volume;

struct dt_volumes {
    double above; /* between the surface and what is below it */
    double below; /* between the surface and what is above it; at least 0, as `above` */
    double area;  /* of the triangles that have a surface */
};

/* Volumes over `minus`, or over the level if it is NULL. The view must be one that reads rings, begun since the last edit, and open
 * until the last dt_volume_read. Without a view (NULL) the set must not change until the last one. Cost: 8 bytes for each id. */
enum dt_status dt_volume_begin(const struct dt *t, const struct dt_view *view,
                               const struct dt_field *field, const struct dt_field *minus,
                               double level, struct dt_volume **out);

/* Before the first dt_volume_read: only what is in the closed box counts. */
void dt_volume_clip(struct dt_volume *v, struct dt_point lo, struct dt_point hi);

/* Before the first dt_volume_read: only triangles inside the border of the number count, or inside any if that is DT_NONE. Then the
 * set must not be edited until all are read: DT_UNSURVEYED. Errors of dt_region_check. */
enum dt_status dt_volume_inside(struct dt_volume *v, const struct dt *t, uint32_t number);

/* Reads some thousands of values or triangles more; again from the first triangle on if the set of the view was edited. */
enum dt_status dt_volume_read(const struct dt *t, struct dt_volume *v, bool *done);

/* Bytes that it has. */
size_t dt_volume_memory(const struct dt_volume *v);

/* Both volumes err by less than 2^-45 of their sum; the area errs by less than 2^-45 of itself. A number beyond the largest double
 * is infinite. */
void dt_volume_end(const struct dt_volume *v, struct dt_volumes *out);

void dt_volume_free(struct dt_volume *v); /* NULL: nothing */

#ifdef __cplusplus
}
#endif
