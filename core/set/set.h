/* set.h - the definition of struct dt; for the files of core/ only. */
#ifndef DT_SET_H
#define DT_SET_H

#include "core/fields/fields.h"
#include "core/grid/hints.h"
#include "core/mesh/cavity.h"
#include "core/mesh/mesh.h"
#include "core/points/points.h"
#include "core/set/touched.h"
#include "core/set/view.h"

struct dt {
    struct dt_points points; /* who is where */
    struct dt_mesh mesh;     /* who is joined to whom; its vertex numbers are those of points */
    struct dt_hints
        hints; /* the uniform grid: a half edge near every place; empty until it is wanted */
    bool triangulated;         /* dt_triangulate has been called */
    bool current;              /* mesh and hints agree with points */
    struct dt_cavity scratch;  /* of edits */
    uint32_t hinted;           /* vertices that the mesh had when its hints were built */
    uint64_t steps;            /* that walks have taken since then beyond the usual ones */
    struct dt_fields fields;   /* values of the points */
    struct dt_touched touched; /* what edits have touched, if somebody follows the set */
    struct dt_views views;     /* readers of earlier moments, and what has been saved for them */
};

/* Whether it is triangulated, and no rebuild is pending: queries see the triangulation, and edits change it
 * (update.h). */
static inline bool dt_is_live(const struct dt *t)
{
    return t->triangulated && t->current;
}

/* Whether it has no grid for searches and no attempt was made to build one (renew.h). */
static inline bool dt_lacks_grid(const struct dt *t)
{
    return t->hints.grids == 0 && t->hinted == 0 && t->mesh.vertices >= 2;
}

#endif
