/* set.h - the definition of struct dt; for the files of core/ only. */
#pragma once

#include "core/constraints/constraints.h"
#include "core/fields/fields.h"
#include "core/hints/hints.h"
#include "core/memory/memory.h"
#include "core/mesh/cavity.h"
#include "core/mesh/mesh.h"
#include "core/points/points.h"
#include "core/set/view.h"

/* Keys of delaunay.h: the rows and rings that have changed, or the values. */
struct dt_touched_list {
    uint64_t *key; /* owns; not sorted, and a key may be repeated */
    size_t n, cap;
    bool all; /* too many to be noted, or a rebuild */
};

/* Whether all points are on one line, and whether that runs upwards from where it begins: the order of every ring depends on it.
 * On a line that is vertical, y decides. */
enum dt_touched_line { DT_NOT_ON_LINE, DT_LINE_UP, DT_LINE_DOWN };

struct dt_touched_constraints {
    struct dt_touched_constraint *row; /* owns */
    size_t n, cap;
    bool all; /* too many to be noted */
};

/* Start with {0}. */
struct dt_touched {
    struct dt_touched_list rows, values;
    struct dt_touched_constraints constraints;
    bool on, with_values;
    enum dt_touched_line line; /* when rows were taken last */
};

void dt_touched_clear(struct dt_touched *w);

static inline size_t dt_touched_memory(const struct dt_touched *w)
{
    return (w->rows.cap + w->values.cap) * sizeof *w->rows.key +
           w->constraints.cap * sizeof *w->constraints.row;
}

/* Notes a key; O(1) amortised. */
void dt_touched_note(struct dt_touched_list *w, uint64_t key);

/* Note a constraint whose ends have not moved, or all constraints of an end that is about to move. */
void dt_touched_note_constraint(struct dt *t, const struct dt_constraint *c, bool moved);
void dt_touched_note_end(struct dt *t, uint32_t id);

struct dt {
    struct dt_points points;  /* who is where */
    struct dt_mesh mesh;      /* who is joined to whom; its vertex numbers are those of points */
    struct dt_hints hints;    /* the grid: a half edge near every place; empty until it is wanted */
    bool triangulated;        /* dt_triangulate has been called */
    bool current;             /* it is triangulated, and mesh and hints agree with points */
    uint64_t edits;           /* dt_edits */
    struct dt_cavity scratch; /* of edits */
    uint32_t hinted;          /* vertices that the mesh had when its hints were built */
    uint64_t steps;           /* that walks have taken since then beyond the usual ones */
    struct dt_fields fields;  /* values of the points */
    struct dt_touched touched; /* what edits have touched, if somebody follows the set */
    struct dt_views views;     /* readers of earlier moments, and what has been saved for them */
    struct dt_constraints *constraints; /* owns; NULL: none have been declared */
};

/* Whether it is triangulated, and no rebuild is pending: queries see the triangulation, and edits change it
 * (update.h). */
static inline bool dt_is_live(const struct dt *t)
{
    return t->triangulated && t->current;
}

/* Whether it has constraints. */
static inline bool dt_is_constrained(const struct dt *t)
{
    return t->constraints != NULL && t->constraints->declared.rows > 0;
}

/* DT_OK if the triangulation can be read and is Delaunay, without constraints. */
static inline enum dt_status dt_readable_delaunay(const struct dt *t)
{
    if (!dt_is_live(t))
        return DT_UNTRIANGULATED;
    return dt_is_constrained(t) ? DT_NOTDELAUNAY : DT_OK;
}

/* Whether it has no grid for searches and no attempt was made to build one (hints_rebuild.c). */
static inline bool dt_lacks_grid(const struct dt *t)
{
    return t->hints.grids == 0 && t->hinted == 0 && t->mesh.vertices >= 2;
}

/* To be called at the beginning of every edit: from then on it saves for views what it is about to change
 * (view_save.c). The second is for edits that change only values. */
void dt_views_edit_begin(struct dt *t);
void dt_views_values_begin(struct dt *t);

/* To be called after each edit of a mesh, and before an edit that profits from a grid. Makes or rebuilds the grid if that
 * is due (hints_rebuild.c), unless it takes more steps than are left, or the mesh is not current. */
void dt_tend(struct dt *t, const struct dt_stop *work);

/* ---- what all readers share ---- */

/* DT_OK if the triangulation of the set can be read. */
static inline enum dt_status dt_readable(const struct dt *t)
{
    return dt_is_live(t) ? DT_OK : DT_UNTRIANGULATED;
}

/* DT_OK if in addition id names a point; *v becomes the vertex of its representative. */
static inline enum dt_status dt_read_vertex(const struct dt *t, uint32_t id, uint32_t *v)
{
    enum dt_status s = dt_readable(t);
    if (s != DT_OK)
        return s;
    *v = dt_points_vertex(&t->points, id);
    return *v == DT_NONE ? DT_NOPOINT : DT_OK;
}
