/* group.h - the rows of TRIANGLES or EDGES that begin with one id, sorted by their second word. */
#ifndef DT_GROUP_H
#define DT_GROUP_H

#include "core/set/set.h"

/* The rows are built where they will stay. If there are more than there is room for, those with the
 * smallest second words remain. */
struct dt_group {
    uint32_t id, from; /* the first word of all; only second words >= from are wanted */
    size_t width;      /* words of a row: 2 for edges, 3 for triangles */
    bool cw;
    uint32_t *rows;
    size_t n, room; /* rows; room > 0 */
    bool more;      /* there may be others that did not fit */
};

/* The rows of a vertex whose star (star.h) is given, of few neighbours; n > 0. */
void dt_group_of_ring(struct dt_group *g, const uint32_t *ring, uint32_t n, bool on_hull);

/* Those of the representative g->id, which has many neighbours, now or at the moment of a view. DT_NOMEM. Cost:
 * O(degree log room), or where that is less, as much as it takes to look for neighbours among all points. */
enum dt_status dt_group_of_many(struct dt_group *g, const struct dt *t, const struct dt_view *v);

#endif
