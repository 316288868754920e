/* set.c - creation, copies and the summary of a set. */
#include "core/set/set.h"

#include "core/delaunay_fields.h"

#include <stdlib.h>

/* ---- life ---- */

struct dt *dt_new(double tol)
{
    return dt_new_in(tol, NULL);
}

struct dt *dt_new_in(double tol, struct dt_pages *pages)
{
    struct dt *t = calloc(1, sizeof *t);
    if (t == NULL)
        return NULL;
    dt_points_init(&t->points, tol, pages);
    t->mesh.pages = pages;
    t->mesh.free_list = DT_NONE;
    return t;
}

void dt_free(struct dt *t)
{
    if (t == NULL)
        return;
    dt_points_clear(&t->points);
    dt_fields_clear(&t->fields);
    dt_mesh_clear(&t->mesh);
    dt_hints_clear(&t->hints);
    dt_cavity_clear(&t->scratch);
    dt_views_clear(&t->views);
    dt_touched_clear(&t->touched);
    dt_constraints_free(t->constraints);
    free(t);
}

enum dt_status dt_clone_points(const struct dt *t, const struct dt_options *opt, struct dt **copy)
{
    struct dt_stop stop = dt_stop_of(opt);
    struct dt *c = dt_new_in(t->points.tol, t->points.pages);
    if (c == NULL)
        return DT_NOMEM;
    enum dt_status status = dt_points_copy(&t->points, &c->points, &stop);
    if (status == DT_OK)
        status = dt_fields_copy(&t->fields, &c->fields, &stop);
    if (status == DT_OK && t->constraints != NULL)
        status = dt_constraints_copy(t->constraints, &c->constraints);
    if (status == DT_OK)
        status = dt_stop_status(&stop);
    if (status != DT_OK) {
        dt_free(c);
        return status;
    }
    c->triangulated = t->triangulated;
    c->edits = t->edits;
    *copy = c;
    return DT_OK;
}

double dt_tolerance(const struct dt *t)
{
    return t->points.tol;
}

uint64_t dt_edits(const struct dt *t)
{
    return t->edits;
}

/* ---- what it says of itself ---- */

enum dt_status dt_get(const struct dt *t, uint32_t id, struct dt_point *p)
{
    if (dt_points_vertex(&t->points, id) == DT_NONE)
        return DT_NOPOINT;
    *p = dt_points_xy(&t->points, id);
    return DT_OK;
}

enum dt_status dt_representative(const struct dt *t, uint32_t id, uint32_t *rep)
{
    uint32_t v = dt_points_vertex(&t->points, id);
    if (v == DT_NONE)
        return DT_NOPOINT;
    *rep = t->points.id[v];
    return DT_OK;
}

void dt_summary(const struct dt *t, struct dt_summary *out)
{
    *out = (struct dt_summary){
        .points = dt_points_live(&t->points),
        .coincident = t->points.aliases.count,
        .fields = t->fields.n,
        .triangulated = t->triangulated,
        .current = dt_is_live(t),
        .searchable = dt_is_live(t) && !dt_lacks_grid(t),
        .memory = sizeof *t + dt_points_memory(&t->points) + dt_fields_memory(&t->fields) +
                  dt_mesh_memory(&t->mesh) + dt_hints_memory(&t->hints) +
                  dt_cavity_memory(&t->scratch) + dt_views_memory(&t->views) +
                  dt_touched_memory(&t->touched) + dt_constraints_memory(t->constraints),
    };
    if (out->current) {
        out->triangles = dt_mesh_triangles(&t->mesh);
        out->edges = dt_mesh_edges(&t->mesh);
        out->hull = dt_mesh_hull(&t->mesh);
    }
}
