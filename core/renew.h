/* renew.h - the grid of hints ages while edits go on: there are more vertices than it was made for, or
 * its half edges have come to lie elsewhere, and walks from them grow longer. Then it is made anew.
 *
 * That takes 50 ns a vertex, all at once. A small set does it in the edit that finds the grid too
 * old. A large one waits for somebody who has the time (dt_is_aged, dt_renew); should nobody come, it
 * does it in an edit, too, but later. */
#ifndef DT_RENEW_H
#define DT_RENEW_H

#include "core/set.h"

/* To be called after each edit of a mesh. False: there was no grid, and no memory for one. */
bool dt_tend(struct dt *t);

#endif
