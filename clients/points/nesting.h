/* nesting.h - which rings are holes, and of which ring. */
#pragma once

#include "clients/points/paths.h"

enum nesting { NESTING_DONE, NESTING_NOMEM, NESTING_LONE /* a known hole is in no ring */ };

/* Orders the paths from `from` on, whose corners are places in xy, so that each ring is followed by its holes, and the rest is as before. A
 * closed path in an odd number of others is a hole, and gets path->hole; `known`: path->hole says already which are. A hole is in the
 * smallest ring around it. Rings touch at corners at most. On failure the paths are as before. Cost: about O(corners), and for each ring
 * O(sqrt(corners)). */
enum nesting paths_nest(struct paths *p, size_t from, bool known, const double *xy);
