/* definition.c - triangulations by definition. */
#include "tests/oracle/definition.h"

#include <stdlib.h>

#include "core/exact/predicates.h"
#include "tests/test.h"

static bool is_delaunay(const struct dt_point *p, uint32_t n, uint32_t a, uint32_t b, uint32_t c)
{
    for (uint32_t d = 0; d < n; d++)
        if (d != a && d != b && d != c && dt_incircle_perturbed(p[a], p[b], p[c], p[d]) > 0)
            return false;
    return true;
}

uint32_t defined_triangles(const struct dt_point *p, uint32_t n, struct triangle *out)
{
    uint32_t count = 0;
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = a + 1; b < n; b++)
            for (uint32_t c = a + 1; c < n; c++)
                if (c != b && dt_orient2d(p[a], p[b], p[c]) > 0 && is_delaunay(p, n, a, b, c)) {
                    CHECK(count < 2 * n);
                    out[count++] = (struct triangle){{a, b, c}};
                }
    return count;
}

static int compare_triangles(const void *a, const void *b)
{
    const uint32_t *u = ((const struct triangle *)a)->v, *v = ((const struct triangle *)b)->v;
    int k = 0;
    while (k < 2 && u[k] == v[k])
        k++;
    return u[k] < v[k] ? -1 : u[k] > v[k];
}

uint32_t mesh_triangles(const struct dt_mesh *m, const uint32_t *number, struct triangle *out)
{
    uint32_t count = 0;
    for (uint32_t h = 0; h < 8 * m->tri_end; h += 8) {
        if (dt_is_dead(m, h) || dt_is_ghost(m, h))
            continue;
        uint32_t v[3] = {number[m->half[h]], number[m->half[h + 1]], number[m->half[h + 2]]}, k = 0;
        while (v[k] > v[(k + 1) % 3] || v[k] > v[(k + 2) % 3])
            k++;
        out[count++] = (struct triangle){{v[k], v[(k + 1) % 3], v[(k + 2) % 3]}};
    }
    qsort(out, count, sizeof *out, compare_triangles);
    return count;
}

static const char *half_edge_fault(const struct dt_mesh *m, const struct dt_point *p, uint32_t h)
{
    uint32_t w = dt_twin(m, h);
    if (w >= 8 * m->tri_end || (w & 7) > 2 || dt_twin(m, w) != h)
        return "a twin is not mutual";
    if (dt_origin(m, w) != dt_dest(m, h) || dt_origin(m, h) != dt_dest(m, w))
        return "twins differ in their ends";
    if (dt_is_ghost(m, h) || dt_is_ghost(m, w))
        return NULL;
    if (dt_incircle_perturbed(p[dt_origin(m, h)], p[dt_dest(m, h)], p[dt_apex_of(m, h)],
                              p[dt_apex_of(m, w)]) >= 0)
        return "an edge is not locally Delaunay";
    return NULL;
}

static const char *record_fault(const struct dt_mesh *m, const struct dt_point *p, uint32_t h)
{
    const uint32_t *v = m->half + h;
    if (v[2] != DT_NONE)
        return dt_orient2d(p[v[0]], p[v[1]], p[v[2]]) > 0 ? NULL : "a triangle is not ccw";
    uint32_t next =
        dt_base(dt_twin(m, h + 1)); /* the ghost u->v is followed by v->next, clockwise */
    if (dt_twin(m, h + 1) != next + 2 || !dt_is_ghost(m, next))
        return "ghosts do not follow one another";
    if (dt_orient2d(p[v[0]], p[v[1]], p[m->half[next + 1]]) > 0)
        return "the hull is not convex";
    return NULL;
}

const char *mesh_fault(const struct dt_mesh *m, const struct dt_point *p, uint32_t n)
{
    uint32_t ghosts = 0;
    if (m->vertices != n || m->tri_end != (n < 2 ? 0 : 2 * n - 2) || m->dead != 0)
        return "wrong size";
    for (uint32_t h = 0; h < 8 * m->tri_end; h += 8) {
        const char *fault = NULL;
        for (uint32_t k = 0; k < 3 && fault == NULL; k++)
            fault = half_edge_fault(m, p, h + k);
        if (fault == NULL)
            fault = record_fault(m, p, h);
        if (fault != NULL)
            return fault;
        ghosts += dt_is_ghost(m, h);
    }
    if (ghosts != m->ghosts)
        return "wrong number of ghosts";
    for (uint32_t v = 0; v < n && n > 1; v++)
        if ((m->leaving[v] & 7) > 2 || dt_origin(m, m->leaving[v]) != v)
            return "leaving[] does not leave";
    return NULL;
}

static int compare_points(const void *a, const void *b)
{
    return dt_compare_xy(*(const struct dt_point *)a, *(const struct dt_point *)b);
}

uint32_t keep_distinct(struct dt_point *p, uint32_t n)
{
    uint32_t kept = 0;
    qsort(p, n, sizeof *p, compare_points);
    for (uint32_t i = 0; i < n; i++)
        if (kept == 0 || compare_points(&p[i], &p[kept - 1]) != 0)
            p[kept++] = p[i];
    for (uint32_t i = kept; i > 1; i--) {
        uint32_t j = test_below(i);
        struct dt_point swap = p[i - 1];
        p[i - 1] = p[j];
        p[j] = swap;
    }
    return kept;
}
