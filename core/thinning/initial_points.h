/* initial_points.h - the points that must stay, from which the surface begins. */
#pragma once

#include "core/thinning/samples.h"

/* Makes *set, which the caller owns, a triangulated set of the points that must stay, with the constraints between them;
 * (*sample)[id], which it owns too (dt_array_free), is the number of the point among the samples. Points are the corners of
 * the hull of those with a value and of the ends of constraints; these ends; and places at which constraints cross. Both
 * are NULL unless DT_OK. Errors of dt_constrain. Cost: O(n), and the triangulation of the points that no octagon of
 * extreme points has inside. */
enum dt_status dt_initial_points(const struct dt_samples *s, const struct dt_thinning *in,
                                 const struct dt_options *opt, struct dt **set, uint32_t **sample);
