/* delaunay_arrays.h - the fourth part of the core's public header: whole arrays at once, for programs in any language that use
 * the core in process. Arguments are numbers and pointers to the caller's arrays.
 *
 * A struct dt_arrays is a triangulation of points with the ids 0, 1, 2, ..., ready for searches. Points are coincident if they are
 * equal. It never changes, so all functions but dt_arrays_free may run in several threads at once.
 *
 * Every function computes with the floating-point environment in which programs start, and restores the caller's, with its
 * rounding mode and flush to zero.
 *
 * `workers`: on how many threads it may run, at most 64, the caller's included; 0 counts as 1. Threads end with the call, so
 * none is left for a process that forks. Results do not depend on the number. */
#pragma once

#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "core/delaunay_thinning.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- of any set ----
 *
 * Writes all triangles at once: triangles[3n], as the table DT_TRIANGLES has them; and, unless it is NULL, halfedges[3n]. Half
 * edge 3i + k runs from triangles[3i + k] to the next corner of the triangle. The half edge halfedges[3i + k] runs back along
 * the same edge, DT_NONE on the hull. n: dt_summary.triangles. Cost: linear; 4 bytes for each id ever given, and 16 for
 * each triangle, meanwhile. */
enum dt_status dt_flat(const struct dt *t, bool cw, uint32_t *triangles, uint32_t *halfedges);

/* ---- surfaces of few points ----
 *
 * dt_thin of points that may coincide: the first one at each place counts. Ends of constraints and out->kept are positions in in->point[],
 * and in->reserve is not used. The caller releases out->kept by dt_pages_release. DT_RANGE: a coordinate that dt_coordinate_ok refuses,
 * an infinite value, or an error that is negative or not finite. DT_NOPOINT, DT_NOEDGE: an end is no point, or both ends are the same
 * position. DT_TOOBIG: there are too many points, and out->least is 0; or out->least > in->most. Other failures, and cost: as of
 * dt_thin. */
enum dt_status dt_arrays_thin(const struct dt_thinning *in, struct dt_thinned *out);

/* ---- of points that are triangulated together ---- */

struct dt_arrays;

/* Triangulates n points p[n] and writes the rows of DT_TRIANGLES into triangle[], which has room for 3 words for each of 2 n rows;
 * dt_arrays_counts says how many rows there are. triangle == NULL: no rows are made; dt_arrays_locate is then DT_UNTRIANGULATED, and
 * dt_arrays_twins, _inside and _faces must not be called. pages, a keeper, may be NULL. DT_RANGE, DT_TOOBIG, DT_NOMEM. The caller owns
 * *out. Cost: O(n log n). */
enum dt_status dt_arrays_new(const struct dt_point *p, size_t n, struct dt_pages *pages,
                             unsigned workers, uint32_t *triangle, struct dt_arrays **out);
void dt_arrays_free(struct dt_arrays *a); /* NULL: nothing */

/* The same with constraints: lines between the points end[2 i] and end[2 i + 1], or, if `border`, parts of the border of one region.
 * DT_CROSSES: wrong[0 .. 1] and wrong[2 .. 3] are the ends of two that cross; DT_NOPOINT, DT_NOEDGE: wrong[0] is no point, or both
 * ends of one. Natural neighbours are refused (DT_NOTDELAUNAY). Cost beyond dt_arrays_new: as of dt_constrain. */
enum dt_status dt_arrays_constrained(const struct dt_point *p, size_t n, const uint32_t *end,
                                     size_t constraints, bool border, struct dt_pages *pages,
                                     unsigned workers, uint32_t *triangle, struct dt_arrays **out,
                                     uint32_t wrong[4]);

/* The same with constraints of any kind and number. DT_RANGE also: a number is too large. */
enum dt_status dt_arrays_declared(const struct dt_point *p, size_t n, const struct dt_constraint *c,
                                  size_t constraints, struct dt_pages *pages, unsigned workers,
                                  uint32_t *triangle, struct dt_arrays **out, uint32_t wrong[4]);

/* Plans, as dt_plan_split, how constraints that would cross get points in common. z[n]: the heights of the points, nan where there is none;
 * NULL: there are none. The new points follow the others; *out has their heights as its values, if any, and no constraints to be released.
 * The caller clears it by dt_split_clear. DT_CROSSES, DT_NOPOINT, DT_NOEDGE put into wrong[] what dt_arrays_declared does. Cost: that of
 * dt_plan_split. */
enum dt_status dt_arrays_split(const struct dt_point *p, const double *z, size_t n,
                               const struct dt_constraint *c, size_t constraints,
                               struct dt_split *out, uint32_t wrong[4]);

/* The pairs a < b, ascending, of the edges that are parts of constraints. *out: as of dt_arrays_within. */
enum dt_status dt_arrays_constrained_edges(const struct dt_arrays *a, struct dt_ids *out);

/* inside[row]: whether that row of triangle[], which has what dt_arrays_constrained wrote, is inside a border that is closed. Cost:
 * linear. */
enum dt_status dt_arrays_inside(const struct dt_arrays *a, const uint32_t *triangle, bool *inside);

/* face[row]: the face of that row of DT_TRIANGLES. Triangles of one face are inside the same borders; face 0 is outside all.
 * *number: the numbers of the closed borders that contain a face, ascending, face by face. end->v[f]: where those of face f end.
 * Both: as of dt_arrays_within. Cost: linear in the triangles, O(log n) for each number. */
enum dt_status dt_arrays_faces(const struct dt_arrays *a, uint32_t *face, struct dt_ids *number,
                               struct dt_ids *end);

/* The regions as dt_regions has them; the caller releases *rows by dt_arrays_release. */
enum dt_status dt_arrays_regions(const struct dt_arrays *a, struct dt_region **rows, size_t *n,
                                 struct dt_region *inside);

/* The points and constraints of a mesh to order (dt_plan_refine): the points of *a, in their order, then the new ones; constraints are
 * sorted. The caller releases both arrays by dt_arrays_release. The other figures are those of struct dt_refined. */
struct dt_arrays_refined {
    struct dt_point *point;
    struct dt_constraint *constraint;
    size_t points, constraints;
    size_t added, split, unrefined, hull;
    double angle;
};

/* q->reserve is not used. Errors, and cost: as of dt_plan_refine. */
enum dt_status dt_arrays_refine(const struct dt_arrays *a, const struct dt_quality *q,
                                struct dt_arrays_refined *out);

/* The counts of dt_summary, in this order: points, coincident, triangles, edges, hull. Cost: constant. */
void dt_arrays_counts(const struct dt_arrays *a, uint32_t counts[5]);

/* All rows of DT_COINCIDENT, DT_EDGES, DT_HULL or DT_POINTS into out[], which has room for as many as dt_arrays_counts says. */
enum dt_status dt_arrays_table(const struct dt_arrays *a, enum dt_table table, uint32_t *out);

/* Sets out[3 r + k] to 3 s + j, or to DT_NONE on the hull. The side from corner k to the next corner of row r of DT_TRIANGLES is
 * the side that begins at corner j of row s. Cost: linear. */
void dt_arrays_twins(const struct dt_arrays *a, uint32_t *out);

/* ---- places: q[n], in any order ----
 *
 * A coordinate that is neither finite nor within 2^201 is outside of everything; one below 2^-142 counts as 0. Rounding may put
 * a place outside the hull that should be on it. It belongs to the triangle at that edge if its distance from the edge
 * is at most tol times the sum of width and height of the box of all points. A tol of 0 is exact. */

/* The row in DT_TRIANGLES of the first triangle that contains each place, DT_NONE: none does. Cost: as dt_locate_many. */
enum dt_status dt_arrays_locate(const struct dt_arrays *a, const struct dt_point *q, size_t n,
                                double tol, unsigned workers, uint32_t *row);

/* The values of the surface of value[], of one value for each id (delaunay_surface.h). Values are finite or nan, and read during
 * the call alone. `outside` is the value where there is no surface. Cost: as dt_values, and one step for DT_FIELD_PAGE ids. */
enum dt_status dt_arrays_values(const struct dt_arrays *a, const double *value,
                                enum dt_interpolation how, double max_edge,
                                const struct dt_point *q, size_t n, double tol, double outside,
                                unsigned workers, double *out);

/* The k nearest points, aliases included, and their distances: id[n k] and distance[n k], nearest first, ties by
 * representative, aliases after theirs by id; padded with DT_NONE and HUGE_VAL. DT_RANGE: a coordinate that dt_coordinate_ok
 * refuses. Cost: as dt_nearest_many. */
enum dt_status dt_arrays_nearest(const struct dt_arrays *a, const struct dt_point *q, size_t n,
                                 uint32_t k, unsigned workers, uint32_t *id, double *distance);

/* The points at most r[i] from place i, aliases included, ascending: end[n] words of out->v, the words of place i before end[i].
 * Exact. *out: start with {0}; the caller releases out->v by dt_arrays_release. Places are refused as above, and r that is
 * negative or refused by dt_coordinate_ok; infinite r is not. */
enum dt_status dt_arrays_within(const struct dt_arrays *a, const struct dt_point *q,
                                const double *r, size_t n, unsigned workers, struct dt_ids *out,
                                size_t *end);
void dt_arrays_release(void *v); /* free: that of the C library that the core uses */

#ifdef __cplusplus
}
#endif
