/* triangulate.c - the triangulation of a whole set, by either engine. */
#include "core/delaunay.h"

#include <stdlib.h>

#include "core/control/stop.h"
#include "core/divide/divide.h"
#include "core/edit/constrain.h"
#include "core/memory/memory.h"
#include "core/set/set.h"
#include "core/shelling/shelling.h"

/* The result of a build, made before the build may touch the set. */
struct draft {
    struct dt_point *xy; /* the vertices in their new order */
    uint32_t *id;        /* of each, its representative's id */
    uint32_t n;
    struct dt_mesh mesh;
};

/* False: out of memory; it must be cleared in this case, too. */
static bool draft_begin(struct draft *b, uint32_t n, struct dt_pages *pages)
{
    *b = (struct draft){.n = n, .mesh = {.pages = pages}};
    b->xy = dt_array_new_in(pages, n, sizeof *b->xy);
    b->id = dt_array_new_in(pages, n, sizeof *b->id);
    return b->xy != NULL && b->id != NULL;
}

static void draft_clear(struct draft *b)
{
    dt_array_free(b->xy);
    dt_array_free(b->id);
    dt_mesh_clear(&b->mesh);
}

/* The vertices in use, in their present order, become the draft's. */
static void copy_vertices(struct draft *b, const struct dt_points *p, struct dt_stop *stop)
{
    uint32_t n = 0;
    for (struct dt_piece at = dt_pieces(0, p->end); dt_next_piece(stop, &at);)
        for (uint32_t v = at.a; v < at.b; v++) {
            if (p->id[v] == DT_NONE)
                continue;
            b->xy[n] = p->xy[v];
            b->id[n++] = p->id[v];
        }
}

/* The paper's engine, on points with these ids. */
static enum dt_status run_shelling(struct draft *b, const struct dt_point *xy, const uint32_t *id,
                                   const struct dt_options *opt)
{
    struct dt_stop stop = dt_stop_of(opt);
    enum dt_status status = dt_shelling(xy, b->n, b->xy, b->id, &b->mesh, opt);
    if (status != DT_OK)
        return status;
    for (struct dt_piece at = dt_pieces(0, b->n); dt_next_piece(&stop, &at);)
        for (uint32_t v = at.a; v < at.b; v++)
            b->id[v] = id[b->id[v]];
    return dt_stop_status(&stop);
}

/* Divide is faster on every set; the paper's engine runs on request, and divide replaces it where it gives up. */
static enum dt_status run_engine(struct draft *b, const struct dt_point *xy, const uint32_t *id,
                                 const struct dt_options *opt)
{
    if (opt != NULL && opt->method == DT_SHELLING) {
        enum dt_status status = run_shelling(b, xy, id, opt);
        if (status != DT_TOOBIG)
            return status;
    }
    return dt_divide(xy, id, b->n, b->xy, b->id, &b->mesh, opt);
}

/* The engine takes the points as they are, or without the gaps that edits have left. */
static enum dt_status triangulate(struct draft *b, const struct dt_points *p,
                                  const struct dt_options *opt)
{
    if (p->free_count == 0)
        return run_engine(b, p->xy, p->id, opt);

    struct draft dense;
    struct dt_stop stop = dt_stop_of(opt);
    enum dt_status status = DT_NOMEM;
    if (draft_begin(&dense, b->n, p->pages)) {
        copy_vertices(&dense, p, &stop);
        status = dt_stop_status(&stop);
    }
    if (status == DT_OK)
        status = run_engine(b, dense.xy, dense.id, opt);
    draft_clear(&dense);
    return status;
}

static enum dt_status build_sorting(struct dt *t, struct dt_mesh *mesh,
                                    const struct dt_options *opt)
{
    struct draft b;
    enum dt_status status = DT_NOMEM;
    if (draft_begin(&b, dt_points_vertices(&t->points), t->points.pages))
        status = triangulate(&b, &t->points, opt);
    if (status == DT_OK)
        status = dt_points_renumber(&t->points, &b.xy, &b.id, b.n, opt);
    if (status == DT_OK) {
        *mesh = b.mesh;
        b.mesh = (struct dt_mesh){0};
    }
    draft_clear(&b);
    return status;
}

/* The mesh of the present points replaces the old one; there is no grid for searches. */
static void install(struct dt *t, const struct dt_mesh *mesh)
{
    dt_points_unplan(&t->points);
    dt_mesh_clear(&t->mesh);
    dt_hints_clear(&t->hints);
    t->mesh = *mesh;
    t->mesh.recycled = false;
    t->hinted = 0;
    t->steps = 0;
    t->touched.rows.all = t->touched.rows.all || !t->current || !t->triangulated;
    if (!t->current)
        dt_views_lose_rings(&t->views);
    t->triangulated = t->current = true;
}

/* ---- points in the order of a plan, whose vertices keep their numbers ---- */

struct dt_build {
    struct dt_mesh mesh;
};

bool dt_build_suits(const struct dt *t, const struct dt_options *opt)
{
    return t->points.plan != NULL && (opt == NULL || opt->method != DT_SHELLING) &&
           !dt_is_constrained(t);
}

enum dt_status dt_build(const struct dt *t, const struct dt_options *opt, struct dt_build **out)
{
    struct dt_build *b = calloc(1, sizeof *b);
    enum dt_status status = DT_NOMEM;
    if (b != NULL) {
        b->mesh.pages = t->points.pages;
        status = dt_divide_sorted(t->points.xy, t->points.end, t->points.plan, &b->mesh, opt);
    }
    if (status != DT_OK) {
        free(b);
        b = NULL;
    }
    *out = b;
    return status;
}

void dt_build_free(struct dt_build *b)
{
    if (b != NULL)
        dt_mesh_clear(&b->mesh);
    free(b);
}

void dt_built(struct dt *t, struct dt_build *b)
{
    install(t, &b->mesh);
    free(b);
}

/* ---- any points ---- */

/* Enforces the constraints in the mesh that was just installed. completes: the flag is not polled any more. */
static enum dt_status constrain(struct dt *t, bool completes, const struct dt_options *opt)
{
    struct dt_stop stop = dt_stop_of(opt);
    stop.left = UINT64_MAX;
    stop.cancel = completes ? NULL : stop.cancel;
    return dt_constrain_all(t, &stop);
}

/* Builds the mesh of t for its present points; without a plan, vertices are renumbered into grid order. On success t is
 * current. Else (DT_NOMEM, DT_CANCELLED) t is as before, or to be freed (opt->disposable). */
static enum dt_status build(struct dt *t, const struct dt_options *opt)
{
    dt_places_clear(&t->points.places); /* renumbering would do so; the build can use the room */
    struct dt_mesh mesh = {.pages = t->points.pages};
    const struct dt_points *p = &t->points;
    enum dt_status status = p->plan != NULL && (opt == NULL || opt->method != DT_SHELLING)
                                ? dt_divide_sorted(p->xy, p->end, p->plan, &mesh, opt)
                                : build_sorting(t, &mesh, opt);
    if (status != DT_OK)
        return status;
    bool was_triangulated = t->triangulated, was_current = t->current;
    install(t, &mesh);
    if (dt_is_constrained(t))
        status = constrain(t, was_triangulated && was_current, opt);
    if (status != DT_OK) {
        t->triangulated = was_triangulated;
        t->current = false;
    }
    return status;
}

enum dt_status dt_triangulate(struct dt *t, const struct dt_options *opt)
{
    bool rebuild = opt != NULL && (opt->rebuild || opt->method != DT_AUTO);
    if (t->triangulated && t->current && !rebuild)
        return DT_OK;
    return build(t, opt);
}

enum dt_status dt_refresh(struct dt *t, const struct dt_options *opt)
{
    if (!t->triangulated || t->current)
        return DT_OK;
    struct dt_options automatic = opt == NULL ? (struct dt_options){0} : *opt;
    automatic.method = DT_AUTO;
    return build(t, &automatic);
}

enum dt_status dt_clone(const struct dt *t, struct dt **copy)
{
    struct dt *c;
    enum dt_status status = dt_clone_points(t, NULL, &c);
    if (status != DT_OK)
        return status;
    status = t->current ? dt_refresh(c, NULL) : DT_OK;
    if (status == DT_OK)
        *copy = c;
    else
        dt_free(c);
    return status;
}
