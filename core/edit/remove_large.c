/* remove_large.c - filling the hole of a vertex v of high degree. Divide and conquer triangulates the rim vertices
 * separately, and the triangles of that triangulation with which v is in conflict are copied. A triangle of the hole is
 * a triangle whose circle holds v and no other point. Its corners are rim vertices, so it is among the copied ones. */
#include "core/divide/divide.h"
#include "core/edit/insert.h"
#include "core/edit/remove.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"

enum { STEPS_EACH = 8 }; /* what a rim vertex costs in all */

/* The triangulation of the rim's finite vertices. */
struct patch {
    struct dt_point *in, *p; /* owns: by place in the rim, and by vertex of the patch */
    uint32_t *from;          /* owns: vertex of the patch -> place among the finite rim vertices */
    uint32_t n;
    uint32_t skip; /* 1 if the rim starts at infinity, so that finite vertex i is rim[i + skip] */
    struct dt_mesh mesh;
    struct dt_cavity hole; /* the part of it that is wanted */
    uint32_t *copy; /* owns: record of the patch -> record of the mesh, DT_NONE if not wanted */
};

static void patch_clear(struct patch *w)
{
    dt_array_free(w->in);
    dt_array_free(w->p);
    dt_array_free(w->from);
    dt_array_free(w->copy);
    dt_mesh_clear(&w->mesh);
    dt_cavity_clear(&w->hole);
}

static enum dt_status triangulate_rim(struct patch *w, const struct dt_point *xy,
                                      const struct dt_cavity *c)
{
    w->skip = c->rim[0].origin == DT_NONE;
    w->n = c->rims - w->skip;
    w->in = dt_array_new(w->n, sizeof *w->in);
    w->p = dt_array_new(w->n, sizeof *w->p);
    w->from = dt_array_new(w->n, sizeof *w->from);
    if (w->in == NULL || w->p == NULL || w->from == NULL)
        return DT_NOMEM;
    for (uint32_t i = 0; i < w->n; i++)
        w->in[i] = xy[c->rim[i + w->skip].origin];
    struct dt_options opt = {.cancel = c->work == NULL ? NULL : c->work->cancel};
    return dt_divide(w->in, NULL, w->n, w->p, w->from, &w->mesh, &opt);
}

/* Finds the triangles to be copied and gives each a record of the star, from the front of
 * c->record. */
static enum dt_status choose_triangles(struct patch *w, struct dt_point v,
                                       const struct dt_cavity *c)
{
    w->copy = dt_array_new(w->mesh.tri_end, sizeof *w->copy);
    if (w->copy == NULL)
        return DT_NOMEM;
    uint32_t t = 0;
    while (!dt_conflict(&w->mesh, w->p, 8 * t, v))
        t++;
    w->hole.work = c->work;
    enum dt_status status = dt_find_cavity(&w->mesh, w->p, 8 * t, v, &w->hole);
    if (status != DT_OK)
        return status;
    for (uint32_t i = 0; i < w->mesh.tri_end; i++)
        w->copy[i] = DT_NONE;
    for (uint32_t i = 0; i < w->hole.records; i++)
        w->copy[w->hole.record[i] / 8] = c->record[i];
    return DT_OK;
}

/* The half edge of the mesh that the patch's half edge h becomes. */
static uint32_t copied(const struct patch *w, uint32_t h)
{
    return w->copy[h / 8] + (h & 7);
}

static void copy_triangle(const struct patch *w, struct dt_mesh *m, const struct dt_cavity *c,
                          uint32_t t, uint32_t face)
{
    uint32_t to = w->copy[t / 8];
    dt_face_begin(m, to, dt_is_ghost(&w->mesh, t) ? 0 : face);
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t u = w->mesh.half[t + k], twin = dt_twin(&w->mesh, t + k);
        uint32_t place = u == DT_NONE ? 0 : w->from[u] + w->skip;
        m->half[to + k] = c->rim[place].origin;
        if (w->copy[twin / 8] != DT_NONE)
            m->half[to + k + 4] = copied(w, twin);
        else
            dt_link(m, to + k, c->rim[place].beyond);
    }
    if (m->half[to + 2] == DT_NONE) {
        m->ghosts++;
        m->hull = to;
        m->leaving[m->half[to + 1]] = to + 1;
    }
}

enum dt_status dt_remove_large(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                               struct dt_cavity *c, uint32_t face)
{
    struct patch w = {0};
    enum dt_status status = dt_work(c->work, (uint64_t)STEPS_EACH * c->rims);
    if (status == DT_OK)
        status = triangulate_rim(&w, xy, c);
    if (status == DT_OK)
        status = choose_triangles(&w, xy[v], c);
    if (status == DT_OK) {
        m->ghosts -= 2 * w.skip;
        for (uint32_t i = 0; i < w.hole.records; i++)
            copy_triangle(&w, m, c, w.hole.record[i], face);
        for (uint32_t i = w.hole.records; i < c->records; i++)
            dt_mesh_drop(m, c->record[i]);
    }
    patch_clear(&w);
    return status;
}
