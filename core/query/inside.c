/* inside.c - queries of the inside of borders: regions, places, triangles and edges. */
#include <stdlib.h>

#include "core/memory/memory.h"
#include "core/memory/sort.h"
#include "core/mesh/fixed.h"
#include "core/query/query.h"

static enum dt_status readable(const struct dt *t)
{
    if (!dt_is_live(t))
        return DT_UNTRIANGULATED;
    return dt_surveyed(t) ? DT_OK : DT_UNSURVEYED;
}

/* NULL: there are none. */
static const struct dt_regions *regions_of(const struct dt *t)
{
    return dt_is_constrained(t) ? &t->constraints->regions : NULL;
}

/* ---- all regions ---- */

/* before[f]: the triangles of the faces before f. */
static void count_triangles(const struct dt *t, uint32_t faces, uint32_t *before)
{
    const struct dt_mesh *m = &t->mesh;
    for (uint32_t f = 0; f <= faces; f++)
        before[f] = 0;
    for (uint32_t h = 0; h < 8 * m->tri_end; h += 8)
        if (!dt_is_dead(m, h) && !dt_is_ghost(m, h))
            before[dt_face(m, h) + 1]++;
    for (uint32_t f = 0; f < faces; f++)
        before[f + 1] += before[f];
}

enum dt_status dt_regions(const struct dt *t, struct dt_region **rows, size_t *n,
                          struct dt_region *inside)
{
    const struct dt_regions *r = regions_of(t);
    enum dt_status status = readable(t);
    if (status != DT_OK)
        return status;
    uint32_t count = r == NULL ? 0 : r->n, faces = r == NULL ? 0 : r->faces;
    struct dt_region *row = malloc((count + (size_t)1) * sizeof *row);
    uint32_t *before = malloc((faces + (size_t)1) * sizeof *before);
    if (row == NULL || before == NULL) {
        free(row);
        free(before);
        return DT_NOMEM;
    }
    *rows = row;
    *n = count;
    *inside = (struct dt_region){.closed = true, .area = r == NULL ? 0 : r->area};
    if (r != NULL)
        count_triangles(t, faces, before);
    for (uint32_t i = 0; i < count; i++)
        row[i] = r->region[i];
    for (uint32_t i = 0; r != NULL && i < r->ranges; i++)
        row[r->range[i].region].triangles += before[r->range[i].end] - before[r->range[i].first];
    for (uint32_t f = 0; f < faces; f++)
        inside->triangles += r->inside[f] ? before[f + 1] - before[f] : 0;
    free(before);
    return DT_OK;
}

/* ---- a place ---- */

/* The regions of the faces around a place, each as often as faces are in it. */
struct around {
    const struct dt *t;
    struct dt_stop work;
    struct dt_ids regions; /* owns */
    uint32_t faces, last; /* faces, and the one before; triangles of one face in a row count once */
};

static enum dt_status add_face(struct around *a, uint32_t face)
{
    const struct dt_regions *r = regions_of(a->t);
    if (a->faces > 0 && face == a->last)
        return dt_work(&a->work, 1);
    a->faces++;
    a->last = face;
    uint32_t n = dt_regions_of(r, face, NULL, 0);
    enum dt_status status = dt_work(&a->work, 1 + (uint64_t)n);
    if (status == DT_OK && n > 0)
        status = dt_ids_reserve(&a->regions, n);
    if (status == DT_OK && n > 0)
        a->regions.n += dt_regions_of(r, face, a->regions.v + a->regions.n, n);
    return status;
}

static enum dt_status look_around(struct around *a, enum dt_where where, uint32_t half)
{
    const struct dt_mesh *m = &a->t->mesh;
    uint32_t h = half;
    if (where == DT_OUTSIDE || half == DT_NONE)
        return DT_OK;
    enum dt_status status = add_face(a, dt_face(m, h));
    if (where == DT_ON_EDGE && status == DT_OK)
        return add_face(a, dt_face(m, dt_twin(m, h)));
    while (where == DT_ON_VERTEX && status == DT_OK && (h = dt_turn_ccw(m, h)) != half)
        status = add_face(a, dt_face(m, h));
    return status;
}

/* Numbers of the regions that all faces are in, and of those that some are in. */
static enum dt_status split(struct around *a, struct dt_ids *in, struct dt_ids *on)
{
    const struct dt_regions *r = regions_of(a->t);
    struct dt_ids *all = &a->regions;
    enum dt_status status = dt_ids_reserve(in, all->n);
    if (status == DT_OK)
        status = dt_ids_reserve(on, all->n);
    if (status != DT_OK)
        return status;
    dt_sort_ids(all->v, all->n, NULL, NULL);
    for (size_t i = 0, k = 0; i < all->n; i += k) {
        for (k = 1; i + k < all->n && all->v[i + k] == all->v[i]; k++)
            ;
        struct dt_ids *to = k == a->faces ? in : on;
        to->v[to->n++] = r->region[all->v[i]].number;
    }
    return DT_OK;
}

enum dt_status dt_regions_at(const struct dt *t, struct dt_point q, const struct dt_options *opt,
                             struct dt_ids *in, struct dt_ids *on)
{
    struct around a = {.t = t, .work = dt_stop_of(opt)};
    uint32_t half;
    enum dt_status status = readable(t);
    if (status != DT_OK || regions_of(t) == NULL)
        return status;
    enum dt_where where = dt_place_find(t, q, DT_NONE, &half);
    status = look_around(&a, where, half);
    if (status == DT_OK)
        status = split(&a, in, on);
    free(a.regions.v);
    return status;
}

/* ---- triangles and edges ---- */

enum dt_status dt_enclosure_of(const struct dt *t, uint32_t number, struct dt_enclosure *out)
{
    const struct dt_regions *r = regions_of(t);
    enum dt_status status = readable(t);
    if (status != DT_OK)
        return status;
    *out = (struct dt_enclosure){r, DT_NONE};
    if (!dt_has_borders(t))
        return DT_NOREGION;
    if (number == DT_NONE)
        return DT_OK;
    const struct dt_region *region = dt_regions_find(r, number);
    if (region == NULL)
        return DT_NOREGION;
    out->region = (uint32_t)(region - r->region);
    return region->closed ? DT_OK : DT_OPEN;
}

bool dt_has_closed_border(const struct dt *t)
{
    const struct dt_regions *r = regions_of(t);
    bool closed = false;
    for (uint32_t i = 0; r != NULL && i < r->n; i++)
        closed = closed || r->region[i].closed;
    return closed;
}

enum dt_status dt_region_check(const struct dt *t, uint32_t number)
{
    struct dt_enclosure in;
    return dt_enclosure_of(t, number, &in);
}

/* Whether the triangle of the half edge is inside; ghosts are not. */
static bool has(const struct dt *t, const struct dt_enclosure *in, uint32_t h)
{
    return dt_encloses(in, dt_face(&t->mesh, h));
}

/* Triangles, as their smallest ids and their half edges; or edges, as ids. */
struct keys {
    uint64_t *v; /* owns room for all there may be */
    size_t n;
};

static void add_triangle(const struct dt *t, const struct dt_enclosure *in, uint32_t h,
                         struct keys *keys)
{
    uint32_t row[3];
    if (!has(t, in, h))
        return;
    dt_triangle_ids(t, h, false, row);
    keys->v[keys->n++] = (uint64_t)row[0] << 32 | h;
}

/* Each edge once: by its inner side with the smaller half edge. */
static void add_edges(const struct dt *t, const struct dt_enclosure *in, uint32_t h,
                      struct keys *keys)
{
    const struct dt_mesh *m = &t->mesh;
    if (!has(t, in, h))
        return;
    for (uint32_t k = h; k < h + 3; k++) {
        uint32_t twin = dt_twin(m, k);
        if (twin < k && has(t, in, twin))
            continue;
        uint32_t a = t->points.id[dt_origin(m, k)], b = t->points.id[dt_dest(m, k)];
        keys->v[keys->n++] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    }
}

static enum dt_status find_keys(const struct dt *t, const struct dt_enclosure *in, bool edges,
                                struct dt_stop *stop, struct keys *keys)
{
    const struct dt_mesh *m = &t->mesh;
    size_t most = 0;
    for (uint32_t h = 0; h < 8 * m->tri_end; h += 8)
        most += !dt_is_dead(m, h) && has(t, in, h) ? (edges ? 3 : 1) : 0;
    keys->v = dt_array_new(most + 1, sizeof *keys->v);
    if (keys->v == NULL)
        return DT_NOMEM;
    for (uint32_t h = 0; h < 8 * m->tri_end; h += 8) {
        if ((h & 0xffff) == 0 && dt_stopped(stop))
            return dt_stop_status(stop);
        if (!dt_is_dead(m, h))
            edges ? add_edges(t, in, h, keys) : add_triangle(t, in, h, keys);
    }
    dt_sort_keys(keys->v, keys->n);
    return DT_OK;
}

/* Rows of one smallest id are sorted among themselves. */
static void put_triangles(const struct dt *t, const struct keys *keys, bool cw, uint32_t *row)
{
    for (size_t i = 0, k; i < keys->n; i += k) {
        for (k = 0; i + k < keys->n && keys->v[i + k] >> 32 == keys->v[i] >> 32; k++)
            dt_triangle_ids(t, (uint32_t)keys->v[i + k], cw, row + 3 * (i + k));
        qsort(row + 3 * i, k, 3 * sizeof *row, dt_triangle_compare);
    }
}

static void put_edges(const struct keys *keys, uint32_t *row)
{
    for (size_t i = 0; i < keys->n; i++) {
        row[2 * i] = (uint32_t)(keys->v[i] >> 32);
        row[2 * i + 1] = (uint32_t)keys->v[i];
    }
}

static enum dt_status put_rows(const struct dt *t, const struct keys *keys, bool edges, bool cw,
                               struct dt_ids *out)
{
    size_t words = keys->n * (edges ? 2 : 3);
    enum dt_status status = dt_ids_reserve(out, words);
    if (status != DT_OK || words == 0)
        return status;
    if (edges)
        put_edges(keys, out->v + out->n);
    else
        put_triangles(t, keys, cw, out->v + out->n);
    out->n += words;
    return DT_OK;
}

enum dt_status dt_inside(const struct dt *t, uint32_t number, enum dt_table table, bool cw,
                         const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_stop stop = dt_stop_of(opt);
    struct dt_enclosure in;
    struct keys keys = {0};
    bool edges = table == DT_EDGES;
    enum dt_status status = dt_enclosure_of(t, number, &in);
    if (status == DT_NOREGION && number == DT_NONE)
        return DT_OK;
    if (status == DT_OK)
        status = find_keys(t, &in, edges, &stop, &keys);
    if (status == DT_OK)
        status = put_rows(t, &keys, edges, cw, out);
    dt_array_free(keys.v);
    return status;
}
