/* merge.h - joins the triangulations of two neighbouring sets of points into one: the conquest in
 * divide and conquer. */
#ifndef DT_MERGE_H
#define DT_MERGE_H

#include "core/divide/part.h"

struct knitting; /* knit.h */

/* Joins a and b, the parts of [lo, mid) and [mid, hi). Every point of a precedes every point of b,
 * by (x, y) if axis is 0, by (y, -x) if it is 1. A merge that is stopped returns no points, and leaves
 * what is no triangulation. */
struct dt_part dt_merge_parts(const struct dt_merging *w, const struct dt_part *a,
                              const struct dt_part *b, unsigned axis, uint32_t mid);

/* Joins the nl vertices before mid, of which l is the last one along the cut, with the nr vertices
 * from mid on, of which r is the first one. some_l and some_r are ghosts of theirs; one vertex
 * alone has none. The ghosts of the two new hull edges are the records 2 mid - 2 and 2 mid - 1.
 * `close`: use the close filter. Returns whether the next merge of these should use it. A merge of
 * many points polls, and ends early if it is stopped. */
bool dt_knit(const struct knitting *w, bool close, uint32_t l, uint32_t r, uint32_t nl, uint32_t nr,
             uint32_t some_l, uint32_t some_r, uint32_t mid);

#endif
