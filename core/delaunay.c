/* delaunay.c - the public face of a set: its life, its points, and when its triangulation is made.
 * Tables and queries have files of their own (table.c, pointlist.c, query.c, check.c). */
#include "core/delaunay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/bounds.h"
#include "core/bulk.h"
#include "core/memory.h"
#include "core/renew.h"
#include "core/sort.h"
#include "core/update.h"
#include "core/work.h"

#ifdef __FAST_MATH__
#error "the predicates need IEEE arithmetic: compile without -ffast-math"
#endif

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
    dt_points_init_in(&t->points, tol, pages);
    t->mesh.pages = pages;
    t->mesh.free_list = DT_NONE;
    return t;
}

void dt_free(struct dt *t)
{
    if (t == NULL)
        return;
    dt_points_clear(&t->points);
    dt_mesh_clear(&t->mesh);
    dt_hints_clear(&t->hints);
    dt_cavity_clear(&t->scratch);
    dt_views_clear(t);
    free(t);
}

enum dt_status dt_clone(const struct dt *t, struct dt **copy)
{
    struct dt *c = dt_new_in(t->points.tol, t->points.pages);
    if (c == NULL)
        return DT_NOMEM;
    enum dt_status status = dt_points_copy(&t->points, &c->points, NULL);
    if (status == DT_OK)
        status = dt_mesh_copy(&t->mesh, &c->mesh);
    if (status == DT_OK)
        status = dt_hints_copy(&t->hints, &c->hints);
    if (status != DT_OK) {
        dt_free(c);
        return status;
    }
    c->triangulated = t->triangulated;
    c->current = t->current;
    c->hinted = t->hinted;
    c->steps = t->steps;
    *copy = c;
    return DT_OK;
}

enum dt_status dt_clone_points(const struct dt *t, const struct dt_options *opt, struct dt **copy)
{
    struct dt_stop stop = dt_stop_of(opt);
    struct dt *c = dt_new_in(t->points.tol, t->points.pages);
    if (c == NULL)
        return DT_NOMEM;
    enum dt_status status = dt_points_copy(&t->points, &c->points, &stop);
    if (status == DT_OK)
        status = dt_stop_status(&stop);
    if (status != DT_OK) {
        dt_free(c);
        return status;
    }
    c->triangulated = t->triangulated;
    *copy = c;
    return DT_OK;
}

double dt_tolerance(const struct dt *t)
{
    return t->points.tol;
}

bool dt_coordinate_ok(double v)
{
    double size = fabs(v);
    return size == 0 || (size >= DT_COORDINATE_LEAST && size <= DT_COORDINATE_MOST);
}

static bool point_ok(struct dt_point p)
{
    return dt_coordinate_ok(p.x) && dt_coordinate_ok(p.y);
}

/* ---- points ---- */

enum dt_status dt_add(struct dt *t, const struct dt_point *p, size_t n, struct dt_added *out)
{
    return dt_add_many(t, p, n, NULL, out);
}

enum dt_status dt_add_many(struct dt *t, const struct dt_point *p, size_t n,
                           const struct dt_options *opt, struct dt_added *out)
{
    struct dt_work work = dt_work_of(opt);
    struct dt_stop stop = dt_stop_of(opt);
    for (size_t i = 0; i < n; i++) {
        if (!point_ok(p[i]))
            return DT_RANGE;
        if (i % DT_POLL == DT_POLL - 1 && dt_stopped(&stop))
            return dt_stop_status(&stop);
    }
    dt_views_edit_begin(t);
    if (dt_is_live(t) && !dt_update_is_bulk(t, n))
        return dt_update_add(t, p, n, &work, out);
    const struct dt_pool *pool = opt == NULL ? NULL : opt->pool;
    enum dt_status status = dt_points_add(&t->points, p, n, pool, &work, out);
    if (status == DT_OK && out->coincident < out->added)
        t->current = false;
    return status;
}

/* Deletes ascending distinct live ids. */
static enum dt_status delete_sorted(struct dt *t, uint32_t *ids, size_t n,
                                    const struct dt_options *opt)
{
    struct dt_work work = dt_work_of(opt);
    struct dt_stop stop = dt_stop_of(opt);
    dt_views_edit_begin(t);
    if (dt_is_live(t) && !dt_update_is_bulk(t, n))
        return dt_update_delete(t, ids, n, &work);
    struct dt_points *p = &t->points;
    bool only_aliases = true;
    enum dt_status status = dt_work(&work, 2 * n);
    if (status == DT_OK)
        status = dt_points_delete_ready(p, ids, n, &work);
    if (status != DT_OK)
        return status;
    for (size_t i = 0; only_aliases && i < n; i++)
        only_aliases = dt_points_is_alias(p, ids[i]);
    if (!only_aliases)
        t->current = false;
    dt_points_delete_all(p, ids, n, opt != NULL && opt->disposable ? &stop : NULL);
    return dt_stop_status(&stop);
}

enum dt_status dt_delete(struct dt *t, const uint32_t *ids, size_t n, uint32_t *deleted,
                         uint32_t *missing)
{
    return dt_delete_many(t, ids, n, NULL, deleted, missing);
}

enum dt_status dt_delete_many(struct dt *t, const uint32_t *ids, size_t n,
                              const struct dt_options *opt, uint32_t *deleted, uint32_t *missing)
{
    struct dt_stop stop = dt_stop_of(opt);
    for (size_t i = 0; i < n; i++) {
        if (dt_points_vertex(&t->points, ids[i]) == DT_NONE) {
            *missing = ids[i];
            return DT_NOPOINT;
        }
        if (i % DT_POLL == DT_POLL - 1 && dt_stopped(&stop))
            return dt_stop_status(&stop);
    }
    uint32_t *sorted = dt_array_new_in(t->points.pages, n, sizeof *sorted);
    if (sorted == NULL)
        return DT_NOMEM;
    if (n > 0)
        memcpy(sorted, ids, n * sizeof *sorted);
    size_t distinct = dt_sort_unique(sorted, n, t->points.pages, &stop);
    enum dt_status status = dt_stop_status(&stop);
    if (status == DT_OK)
        status = delete_sorted(t, sorted, distinct, opt);
    dt_array_free(sorted);
    if (status == DT_OK)
        *deleted = (uint32_t)distinct;
    return status;
}

enum dt_status dt_move(struct dt *t, uint32_t id, struct dt_point to)
{
    return dt_move_to(t, id, to, NULL);
}

enum dt_status dt_move_to(struct dt *t, uint32_t id, struct dt_point to,
                          const struct dt_options *opt)
{
    struct dt_work work = dt_work_of(opt);
    if (dt_points_vertex(&t->points, id) == DT_NONE)
        return DT_NOPOINT;
    if (!point_ok(to))
        return DT_RANGE;
    enum dt_status status = dt_work(&work, 1);
    if (status != DT_OK)
        return status;
    dt_views_edit_begin(t);
    if (dt_is_live(t))
        return dt_update_move(t, id, to, &work);
    status = dt_points_move(&t->points, id, to, &work);
    if (status == DT_OK)
        t->current = false;
    return status;
}

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

/* ---- the triangulation ---- */

enum dt_status dt_triangulate(struct dt *t, const struct dt_options *opt)
{
    bool rebuild = opt != NULL && (opt->rebuild || opt->method != DT_AUTO);
    if (t->triangulated && t->current && !rebuild)
        return DT_OK;
    enum dt_status status = dt_bulk_build(t, opt);
    if (status == DT_OK)
        t->triangulated = true;
    return status;
}

enum dt_status dt_refresh(struct dt *t, const struct dt_options *opt)
{
    if (!t->triangulated || t->current)
        return DT_OK;
    struct dt_options automatic = opt == NULL ? (struct dt_options){0} : *opt;
    automatic.method = DT_AUTO;
    return dt_bulk_build(t, &automatic);
}

void dt_summary(const struct dt *t, struct dt_summary *out)
{
    *out = (struct dt_summary){
        .points = dt_points_live(&t->points),
        .coincident = t->points.aliases.count,
        .triangulated = t->triangulated,
        .current = dt_is_live(t),
        .searchable = dt_is_searchable(t),
        .memory = sizeof *t + dt_points_memory(&t->points) + dt_mesh_memory(&t->mesh) +
                  dt_hints_memory(&t->hints) + dt_cavity_memory(&t->scratch) +
                  dt_views_memory(&t->views),
    };
    if (out->current) {
        out->triangles = dt_mesh_triangles(&t->mesh);
        out->edges = dt_mesh_edges(&t->mesh);
        out->hull = dt_mesh_hull(&t->mesh);
    }
}
