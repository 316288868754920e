/* renew.h - the grid of hints is made when it is first needed, and rebuilt when it has degraded.
 *
 * A triangulation is complete without it, and many sets are never searched. So a build
 * leaves none, and the first search (dt_prepare) or edit makes it.
 *
 * Edits degrade it: there are more vertices than it was made for, or its half edges have moved, and walks from
 * them grow longer. Then it is rebuilt.
 *
 * That takes linear time, all at once. A small set does it in the edit that finds the grid too old.
 * A large one leaves it to the caller (dt_renew_due, dt_renew); if the caller does not, an edit does it, but
 * later. */
#ifndef DT_RENEW_H
#define DT_RENEW_H

#include "core/set/set.h"

/* Call it after each edit of a mesh, and before one that profits from a grid. A grid
 * that takes more steps than are left is not made now. */
void dt_tend(struct dt *t, const struct dt_work *work);

#endif
