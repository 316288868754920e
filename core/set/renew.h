/* renew.h - the grid of hints is made when it is wanted, and rebuilt when it has aged.
 *
 * A triangulation is complete without it, and many sets are never searched. So a build
 * leaves none, and the first search (dt_prepare) or edit makes it.
 *
 * It ages while edits go on: there are more vertices than it was made for, or its half edges have come
 * to lie elsewhere, and walks from them grow longer. Then it is rebuilt.
 *
 * That takes 50 ns a vertex, all at once. A small set does it in the edit that finds the grid too old.
 * A large one leaves it to a caller that has the time (dt_is_aged, dt_renew); without one it does it in an
 * edit, too, but later. */
#ifndef DT_RENEW_H
#define DT_RENEW_H

#include "core/set/set.h"

/* To be called after each edit of a mesh, and before one that would do better with a grid. A grid
 * that takes more steps than are left is not made now. */
void dt_tend(struct dt *t, const struct dt_work *work);

#endif
