/* delaunay_thinning.h - the core's public header for surfaces of few points; see delaunay.h.
 *
 * Points with values are thinned out greedily [Garland & Heckbert, "Fast polygonal approximation of terrains and height
 * fields", 1995, algorithm III]. The surface begins with the points that must stay. Then it gets the point with the largest
 * error until every point is within a bound of the surface. The surface is linear in each triangle of the constrained Delaunay
 * triangulation of the points that are kept. */
#pragma once

#include "core/delaunay_constraints.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The points to thin out, with their values and constraints. All arrays are borrowed. */
struct dt_thinning {
    const struct dt_point *point; /* n different places that dt_coordinate_ok accepts */
    const double *value;          /* n finite numbers; nan: it has none */
    uint32_t n;
    const struct dt_constraint *constraint; /* their ends are indices of points */
    size_t constraints;
    double error;  /* >= 0 */
    uint32_t most; /* points to keep */
    /* Called before memory is allocated: reserves `bytes` in all, or refuses with DT_NOMEM. NULL: there is no limit. */
    enum dt_status (*reserve)(void *ctx, size_t bytes);
    void *ctx;
    struct dt_pages *pages; /* borrows: where large arrays come from; may be NULL */
};

struct dt_thinned {
    uint32_t *kept; /* owns n (dt_pages_release): indices of points, ascending; NULL unless DT_OK */
    uint32_t n;
    uint32_t least; /* how many points must stay */
    /* the largest of any point, rounded: in thin triangles within 2^-15 of the largest value */
    double error;
};

/* Chooses the points that are kept. These points must stay: the corners of the hull of the points with a value and of the ends of
 * constraints; these ends; and points at which constraints cross. Then, as long as a point with a value is off by more than the
 * error, the point with the largest distance follows; of equal distances the lexicographically least place comes first. The
 * distance is infinite where the surface has no value, because a corner of the triangle has none. The comparison with the
 * error is exact. So the result depends on the places, values and constraints, not on their order.
 *
 * If out->least > most: DT_TOOBIG, and nothing is kept. Other failures: DT_NOMEM, DT_CANCELLED, and those of dt_constrain.
 * opt may be NULL: its flag is polled, its progress is that of the points that are within the error. Cost: O(n log k)
 * expected for k points that are kept. */
enum dt_status dt_thin(const struct dt_thinning *in, const struct dt_options *opt,
                       struct dt_thinned *out);

#ifdef __cplusplus
}
#endif
