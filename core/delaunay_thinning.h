/* delaunay_thinning.h - the core's public header for surfaces of few points; see delaunay.h.
 *
 * Points with values are thinned out greedily [Garland & Heckbert, "Fast polygonal approximation of terrains and height
 * fields", 1995, algorithm III]: the surface begins with the points that must stay, and gets the point with the largest
 * error until every point is within a bound of it. The surface is linear in each triangle of the constrained Delaunay
 * triangulation of the points that are kept. */
#ifndef DT_DELAUNAY_THINNING_H
#define DT_DELAUNAY_THINNING_H

#include "core/delaunay_constraints.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is to be thinned out. All arrays are borrowed. */
struct dt_thinning {
    const struct dt_point *point; /* n different places that dt_coordinate_ok accepts */
    const double *value;          /* n finite numbers; nan: it has none */
    uint32_t n;
    const struct dt_constraint *constraint; /* their ends are indices of points */
    size_t constraints;
    double error;  /* >= 0 */
    uint32_t most; /* points to keep */
    /* Reserves so many bytes in all before they are allocated; may refuse, DT_NOMEM. NULL: there is no limit. */
    enum dt_status (*reserve)(void *ctx, size_t bytes);
    void *ctx;
};

struct dt_thinned {
    uint32_t *kept; /* owns n (dt_pages_release): indices of points, ascending; NULL unless DT_OK */
    uint32_t n;
    uint32_t least; /* how many points must stay */
    double error;   /* the largest of any point: within 2^-40 of the largest value */
};

/* Chooses the points that are kept: the corners of the hull of those with a value and of the ends of constraints; the ends,
 * and points at which constraints cross; and then, as long as some point with a value is more than the error off, the one
 * that is off the most, of equal ones the lexicographically least place. A point is off by infinity where the surface
 * has no value, because a corner of its triangle has none. Which points are off by more than the error is decided exactly.
 * So the result is a function of the places, values and constraints, whatever their order.
 *
 * If out->least > most: DT_TOOBIG, and nothing is kept. Other failures: DT_NOMEM, DT_CANCELLED, and those of dt_constrain.
 * opt may be NULL: its flag is polled, its progress is that of the points that are within the error. Cost: O(n log k)
 * expected for k points that are kept. */
enum dt_status dt_thin(const struct dt_thinning *in, const struct dt_options *opt,
                       struct dt_thinned *out);

#ifdef __cplusplus
}
#endif

#endif
