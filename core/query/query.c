/* query.c - the triangles at points, edges and triangles; where a place lies. */
#include "core/query/query.h"
#include "core/mesh/star.h"

#include "core/exact/predicates.h"
#include "core/memory/sort.h"
#include "core/query/locate.h"

#include <stdlib.h>
#include <string.h>

enum { DENSE_LEAST = 1000 }; /* ids from which on sorting them needs something better than qsort */

void dt_triangle_ids(const struct dt *t, uint32_t h, bool cw, uint32_t row[3])
{
    const uint32_t *corner = t->mesh.half + dt_base(h), *id = t->points.id;
    row[0] = id[corner[0]];
    row[1] = id[corner[cw ? 2 : 1]];
    row[2] = id[corner[cw ? 1 : 2]];
    dt_triangle_turn(row);
}

int dt_triangle_compare(const void *p, const void *q)
{
    const uint32_t *a = p, *b = q;
    for (int i = 0; i < 3; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

bool dt_triangle_precedes(const struct dt *t, uint32_t h, uint32_t g)
{
    uint32_t one[3], other[3];
    dt_triangle_ids(t, h, false, one);
    dt_triangle_ids(t, g, false, other);
    return dt_triangle_compare(one, other) < 0;
}

/* There must be room. */
static void append_triangle(const struct dt *t, uint32_t h, bool cw, struct dt_ids *out)
{
    dt_triangle_ids(t, h, cw, out->v + out->n);
    out->n += 3;
}

/* Appends the ring, and replaces each of its points by the triangle that the point begins, from the last one on. */
enum dt_status dt_triangles_at_point(const struct dt *t, uint32_t a, bool cw, struct dt_ids *out)
{
    size_t from = out->n;
    uint32_t v;
    bool on_hull;
    enum dt_status s = dt_read_vertex(t, a, &v);
    if (s != DT_OK || dt_mesh_is_line(&t->mesh))
        return s;
    s = dt_ring(t, a, cw, out, &a, &on_hull);
    size_t n = out->n - from;
    if (s == DT_OK)
        s = dt_ids_reserve(out, 2 * n);
    out->n = from;
    if (s != DT_OK)
        return s;
    uint32_t *ring = out->v + from, first = ring[0];
    out->n += 3 * (n - on_hull);
    for (size_t i = n - on_hull; i-- > 0;) {
        uint32_t row[3] = {a, ring[i], i + 1 < n ? ring[i + 1] : first};
        dt_triangle_turn(row);
        memcpy(ring + 3 * i, row, sizeof row);
    }
    return DT_OK;
}

enum dt_status dt_triangles_at_edge(const struct dt *t, uint32_t a, uint32_t b, bool cw,
                                    struct dt_ids *out)
{
    uint32_t u, v;
    enum dt_status s = dt_read_vertex(t, a, &u);
    if (s == DT_OK)
        s = dt_read_vertex(t, b, &v);
    if (s != DT_OK)
        return s;
    uint32_t h = dt_edge_between(&t->mesh, u, v);
    if (h == DT_NONE)
        return DT_NOEDGE;
    s = dt_ids_reserve(out, 6);
    if (s != DT_OK)
        return s;
    uint32_t twin = dt_twin(&t->mesh, h);
    if (!dt_is_ghost(&t->mesh, h))
        append_triangle(t, h, cw, out);
    if (!dt_is_ghost(&t->mesh, twin))
        append_triangle(t, twin, cw, out);
    return DT_OK;
}

/* A half edge of the triangle with these corners, in any order; DT_NONE if there is none. */
static uint32_t half_of_triangle(const struct dt_mesh *m, const uint32_t v[3])
{
    uint32_t h = dt_edge_between(m, v[0], v[1]);
    if (h == DT_NONE || dt_apex_of(m, h) == v[2])
        return h;
    return dt_apex_of(m, dt_twin(m, h)) == v[2] ? dt_twin(m, h) : DT_NONE;
}

enum dt_status dt_triangles_at_triangle(const struct dt *t, uint32_t a, uint32_t b, uint32_t c,
                                        bool cw, struct dt_ids *out)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t v[3];
    enum dt_status s = dt_read_vertex(t, a, &v[0]);
    if (s == DT_OK)
        s = dt_read_vertex(t, b, &v[1]);
    if (s == DT_OK)
        s = dt_read_vertex(t, c, &v[2]);
    if (s != DT_OK)
        return s;
    uint32_t h = half_of_triangle(m, v);
    if (h == DT_NONE)
        return DT_NOTRIANGLE;
    s = dt_ids_reserve(out, 9);
    if (s != DT_OK)
        return s;
    for (uint32_t k = 0; k < 3;
         k++) { /* across the edge that does not touch the corner before: v[k], v[k + 1] */
        uint32_t opposite = v[(k + 2) % 3];
        while (dt_apex_of(m, h) != opposite)
            h = dt_next(h);
        if (!dt_is_ghost(m, dt_twin(m, h)))
            append_triangle(t, dt_twin(m, h), cw, out);
    }
    return DT_OK;
}

enum dt_where dt_place_find(const struct dt *t, struct dt_point q, uint32_t near, uint32_t *half)
{
    const struct dt_points *p = &t->points;
    *half = DT_NONE;
    if (t->mesh.vertices >= 2)
        return dt_find(t, &(struct dt_place){q, near}, half);
    bool there = t->mesh.vertices == 1 && dt_compare_xy(p->xy[t->mesh.alone], q) == 0;
    return there ? DT_ON_VERTEX : DT_OUTSIDE;
}

enum dt_status dt_locate(const struct dt *t, struct dt_point q, struct dt_location *out)
{
    return dt_locate_place(t, &(struct dt_place){q, DT_NONE}, out);
}

enum dt_status dt_locate_place(const struct dt *t, const struct dt_place *q,
                               struct dt_location *out)
{
    enum dt_status s = dt_readable(t);
    if (s != DT_OK)
        return s;
    const struct dt_mesh *m = &t->mesh;
    uint32_t h, a, b;
    *out = (struct dt_location){.id = {DT_NONE, DT_NONE, DT_NONE}};
    out->where = dt_place_find(t, q->at, q->near, &h);
    switch (out->where) {
    case DT_ON_VERTEX:
        out->id[0] = t->points.id[h == DT_NONE ? m->alone : dt_origin(m, h)];
        break;
    case DT_ON_EDGE:
        a = t->points.id[dt_origin(m, h)];
        b = t->points.id[dt_dest(m, h)];
        out->id[0] = a < b ? a : b;
        out->id[1] = a < b ? b : a;
        break;
    case DT_INSIDE:
        dt_triangle_ids(t, h, false, out->id);
        break;
    case DT_OUTSIDE:
        break;
    }
    return DT_OK;
}

/* Sorts by a bitmap of the numbers from the least to the largest, if that has few words for its
 * bits: linear, and hardly any work beside reading and writing the result. */
static bool sort_dense(uint32_t *v, size_t n)
{
    uint32_t least = v[0], largest = v[0];
    for (size_t i = 1; i < n; i++) {
        least = v[i] < least ? v[i] : least;
        largest = v[i] > largest ? v[i] : largest;
    }
    size_t words = (largest - least) / 64 + 1, k = 0;
    uint64_t *bits = words <= n ? calloc(words, sizeof *bits) : NULL;
    if (bits == NULL)
        return false;
    for (size_t i = 0; i < n; i++)
        bits[(v[i] - least) / 64] |= (uint64_t)1 << (v[i] - least) % 64;
    for (size_t w = 0; w < words; w++)
        for (uint64_t left = bits[w]; left != 0; left &= left - 1)
            v[k++] = least + (uint32_t)(64 * w) + (uint32_t)__builtin_ctzll(left);
    free(bits);
    return true;
}

void dt_vertices_to_ids(const struct dt *t, struct dt_ids *list, size_t from)
{
    if (list->n == from)
        return;
    uint32_t *v = list->v + from;
    size_t n = list->n - from;
    for (size_t i = 0; i < n; i++)
        v[i] = t->points.id[v[i]];
    if (n < DENSE_LEAST || !sort_dense(v, n))
        dt_sort_ids(v, n, t->points.pages, NULL);
}
