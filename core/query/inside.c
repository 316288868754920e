/* inside.c - what borders enclose: regions, places, triangles and edges. */
#include <stdlib.h>

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
    uint32_t faces,
        last; /* faces, and the one before; a run of triangles of one face counts once */
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

enum dt_status dt_region_check(const struct dt *t, uint32_t number)
{
    struct dt_enclosure in;
    return dt_enclosure_of(t, number, &in);
}

/* Whether the row of the table is inside: a triangle with the edge from its first corner to its second. */
static bool is_inside(const struct dt *t, const struct dt_enclosure *in, const struct dt_cursor *c,
                      const uint32_t *row)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t h = dt_half_between(m, dt_points_vertex(&t->points, row[0]),
                                 dt_points_vertex(&t->points, row[1]));
    uint32_t left = dt_face(m, h), right = dt_face(m, dt_twin(m, h));
    if (c->table == DT_EDGES)
        return dt_encloses(in, left) || (right != left && dt_encloses(in, right));
    return dt_encloses(in, c->cw ? right : left);
}

/* Appends the next rows that are inside. *done: there are no more. */
static enum dt_status read_rows(const struct dt *t, const struct dt_enclosure *in,
                                struct dt_cursor *c, struct dt_ids *out, bool *done)
{
    enum { ROWS = 1024 };
    uint32_t row[3 * ROWS], width = c->table == DT_EDGES ? 2 : 3;
    size_t rows = 0, words = 0;
    enum dt_status status = dt_table_read(t, c, row, 3 * ROWS, ROWS, &rows, &words);
    *done = status == DT_OK && rows == 0;
    status = status == DT_TOOLONG ? DT_OK : status; /* to be called again */
    if (status == DT_OK)
        status = dt_ids_reserve(out, words);
    for (size_t i = 0; status == DT_OK && i < rows * width; i += width) {
        bool inside = is_inside(t, in, c, row + i);
        for (uint32_t k = 0; inside && k < width; k++)
            out->v[out->n++] = row[i + k];
    }
    return status;
}

enum dt_status dt_inside(const struct dt *t, uint32_t number, enum dt_table table, bool cw,
                         const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_stop stop = dt_stop_of(opt);
    struct dt_cursor c;
    size_t from = out->n;
    struct dt_enclosure in;
    bool done = false;
    enum dt_status status = dt_enclosure_of(t, number, &in);
    if (status == DT_NOREGION && number == DT_NONE)
        return DT_OK;
    if (status == DT_OK)
        status = dt_table_begin(t, NULL, table, cw, &c);
    while (status == DT_OK && !done) {
        status = read_rows(t, &in, &c, out, &done);
        if (status == DT_OK && dt_stopped(&stop))
            status = dt_stop_status(&stop);
    }
    if (status != DT_OK)
        out->n = from;
    return status;
}
