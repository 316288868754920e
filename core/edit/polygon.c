/* polygon.c - the triangles of a polygon: its sides become edges of the mesh, without constraints that would have to be declared. */
#include <stdlib.h>

#include "core/constraints/enforce.h"
#include "core/constraints/flood.h"
#include "core/delaunay_constraints.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"
#include "core/query/query.h"

/* A side that is left out, as vertices. */
struct loose {
    uint32_t v, w;
};

struct polygon {
    struct dt *t;
    struct dt_enforcer enforcer;
    struct dt_stop work;
    struct loose *loose; /* owns `cap` */
    size_t n, cap;
};

static enum dt_status add_side(struct polygon *s, uint32_t a, uint32_t b)
{
    uint32_t v = dt_points_vertex(&s->t->points, a), w = dt_points_vertex(&s->t->points, b);
    enum dt_status status = dt_enforce_segment(&s->enforcer, v, w, &s->work);
    if (status != DT_CROSSES)
        return status;
    return dt_items_append(&s->loose, &s->n, &s->cap, &(struct loose){v, w}, sizeof *s->loose);
}

/* The sides of the corners from .. end - 1. If the last one repeats the first, the side between them has no length. */
static enum dt_status add_ring(struct polygon *s, uint32_t from, uint32_t end)
{
    enum dt_status status = DT_OK;
    for (uint32_t i = from; i < end && end - from > 2 && status == DT_OK; i++)
        status = add_side(s, i, i + 1 < end ? i + 1 : from);
    return status;
}

/* Flags the triangles that they meet in the mesh as it is now. */
static enum dt_status flood(struct polygon *s)
{
    const struct dt_point *xy = s->t->points.xy;
    struct dt_segment *segment = malloc((s->n + 1) * sizeof *segment);
    enum dt_status status = segment == NULL ? DT_NOMEM : DT_OK;
    dt_flood_begin(&s->t->mesh);
    for (size_t i = 0; i < s->n && status == DT_OK; i++) {
        segment[i] = (struct dt_segment){xy[s->loose[i].v], xy[s->loose[i].w], true};
        status = dt_enforce_look(&s->enforcer, s->loose[i].v, s->loose[i].w, &s->work);
        if (status == DT_OK)
            dt_enforce_flag(&s->enforcer, DT_FLOOD_NEAR);
    }
    if (status == DT_OK)
        status = dt_flood(&s->t->mesh, xy, segment, s->n, &s->work, NULL);
    free(segment);
    return status;
}

static bool is_inside(const struct dt_mesh *m, uint32_t h)
{
    return !dt_is_dead(m, h) && !dt_is_ghost(m, h) && (dt_face(m, h) & DT_FLOOD_INSIDE) != 0;
}

static enum dt_status write_triangles(const struct dt *t, struct dt_ids *out)
{
    const struct dt_mesh *m = &t->mesh;
    size_t n = 0;
    for (uint32_t h = 0; h < 8 * m->tri_end; h += 8)
        n += is_inside(m, h);
    enum dt_status status = dt_ids_reserve(out, 3 * n);
    for (uint32_t h = 0; status == DT_OK && h < 8 * m->tri_end; h += 8)
        if (is_inside(m, h)) {
            dt_triangle_ids(t, h, false, out->v + out->n);
            out->n += 3;
        }
    return status;
}

static enum dt_status triangulate(struct polygon *s, const uint32_t *end, size_t rings,
                                  struct dt_ids *out)
{
    struct dt_mesh *m = &s->t->mesh;
    enum dt_status status = dt_triangulate(s->t, NULL);
    if (status != DT_OK || m->vertices < 3)
        return status;
    status = dt_fixed_begin(m);
    s->enforcer = (struct dt_enforcer){.mesh = m, .xy = s->t->points.xy};
    for (size_t i = 0; i < rings && status == DT_OK; i++)
        status = add_ring(s, i == 0 ? 0 : end[i - 1], end[i]);
    if (status == DT_OK)
        status = flood(s);
    return status == DT_OK ? write_triangles(s->t, out) : status;
}

enum dt_status dt_polygon(const struct dt_point *p, size_t n, const uint32_t *end, size_t rings,
                          struct dt_pages *pages, struct dt_ids *out, size_t *left_out)
{
    struct polygon s = {.t = dt_new_in(0, pages), .work = dt_stop_of(NULL)};
    struct dt_added added;
    enum dt_status status = s.t == NULL ? DT_NOMEM : dt_add(s.t, p, n, &added);
    if (status == DT_OK)
        status = triangulate(&s, end, rings, out);
    *left_out = s.n;
    dt_enforcer_clear(&s.enforcer);
    free(s.loose);
    dt_free(s.t);
    return status;
}
