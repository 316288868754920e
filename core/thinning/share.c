/* share.c - which triangles of the star of a new vertex have which points; see share.h.
 *
 * A new vertex p replaces the facets around it by its star. Each point of theirs is found in the sector between two
 * edges of the star:
 *
 *          3        2        The first edge divides the sectors into those that begin on its left, less than a half turn
 *            \  q  /         from it, and the others. In each half a point is left of an edge if and only if its direction
 *             \   /          comes after that of the edge, so the edges are tried one after the other.
 *       4 ----- p ----- 1
 */
#include "core/thinning/share.h"

#include "core/edit/insert.h"
#include "core/exact/lanes.h"
#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"

#include <stdlib.h>

void dt_share_clear(struct dt_share *h)
{
    free(h->sector);
    dt_array_free(h->old);
    dt_array_free(h->item);
    *h = (struct dt_share){0};
}

static enum dt_status reserve_sectors(struct dt_share *h, uint32_t n)
{
    if (n <= h->cap)
        return DT_OK;
    uint32_t cap = n + n / 2 + 16;
    free(h->sector);
    h->sector = malloc(cap * sizeof *h->sector);
    h->cap = h->sector != NULL ? cap : 0;
    return h->cap > 0 ? DT_OK : DT_NOMEM;
}

static enum dt_status reserve_old(struct dt_share *h, size_t n)
{
    if (n <= h->old_cap)
        return DT_OK;
    size_t cap = dt_array_room(h->old_cap, n, UINT32_MAX);
    uint32_t *old = dt_array_grow(h->old, h->olds, cap, sizeof *old);
    if (old == NULL)
        return DT_NOMEM;
    h->old = old;
    h->old_cap = cap;
    return DT_OK;
}

static enum dt_status reserve_items(struct dt_share *h, size_t n)
{
    if (n <= h->item_cap)
        return DT_OK;
    size_t cap = dt_array_room(h->item_cap, n, UINT32_MAX);
    struct dt_shared *item = dt_array_grow(h->item, h->items, cap, sizeof *item);
    if (item == NULL)
        return DT_NOMEM;
    h->item = item;
    h->item_cap = cap;
    return DT_OK;
}

/* ---- the sector of a point ---- */

/* Whether q, as seen from p at (x, y), is in the sector or in those after it, given that it is less than a half turn from the
 * edge where that begins. *sign: 0 if q is on the line of that edge. */
static inline bool is_after(const struct dt_sector *s, struct dt_point p, struct dt_point q,
                            double x, double y, int *sign)
{
    double left = s->x * y, right = s->y * x, det = left - right;
    if (fabs(det) > DT_ORIENT_BOUND * (fabs(left) + fabs(right))) {
        *sign = 1;
        return det > 0;
    }
    *sign = dt_orient2d_exact(s->to, q, p);
    return *sign > 0 || (*sign == 0 && s->on_left);
}

/* The sector of q. */
static uint32_t sector_of(const struct dt_share *h, struct dt_point p, struct dt_point q)
{
    if (h->on_line)
        return dt_compare_xy(p, q) < 0;
    double x = q.x - p.x, y = q.y - p.y;
    uint32_t i = 1, end = h->half;
    int sign = 1;
    if (h->half < h->sectors) {
        bool after = is_after(&h->sector[0], p, q, x, y, &sign);
        if (sign == 0 && dt_compare_xy(p, q) != dt_compare_xy(p, h->sector[0].to))
            after = false; /* opposite */
        if (!after) {
            i = h->half;
            end = h->sectors;
        }
    }
    while (i < end && is_after(&h->sector[i], p, q, x, y, &sign))
        i++;
    return i - 1;
}

/* The same of a block that is less than a half turn from the edge: *sure is false unless all of it is on one side of the
 * line of the edge. */
static inline bool is_block_after(const struct dt_sector *s, const struct dt_bunch *b, double x,
                                  double y, bool *sure)
{
    double left = s->x * y, right = s->y * x, det = left - right;
    double reach = fabs(s->x) * b->height + fabs(s->y) * b->width;
    double size = fabs(left) + fabs(right);
    *sure = *sure && fabs(det) > reach * (1 + 0x1p-48) + DT_ORIENT_BOUND * size;
    return det > 0;
}

/* The sector of a block; DT_NONE: edges may divide it. */
static uint32_t sector_of_block(const struct dt_share *h, struct dt_point p,
                                const struct dt_bunch *b)
{
    double x = b->at.x - p.x, y = b->at.y - p.y;
    uint32_t i = 1, end = h->half;
    bool sure = !h->on_line;
    if (h->half < h->sectors && !is_block_after(&h->sector[0], b, x, y, &sure)) {
        i = h->half;
        end = h->sectors;
    }
    while (sure && i < end && is_block_after(&h->sector[i], b, x, y, &sure))
        i++;
    return sure ? i - 1 : DT_NONE;
}

#define LOOKED_AT (-1.0f)

/* Fetches what finding its sector will read. */
static void fetch_item(const struct dt_samples *s, uint32_t item)
{
    if (dt_item_level(item) == 0)
        dt_fetch(&s->rounded[item]);
    else
        dt_fetch(dt_item_block(s, item));
}

/* The parts of a block that edges divide get behind the items that are left, so that they are fetched until it is their turn. */
static enum dt_status divide(const struct dt_samples *s, struct dt_share *h, uint32_t item)
{
    uint32_t part, n = dt_item_parts(s, item, &part);
    if (h->olds + n > h->old_cap && reserve_old(h, h->olds + n) != DT_OK)
        return DT_NOMEM;
    for (uint32_t k = 0; k < n; k++) {
        fetch_item(s, part + k);
        h->old[h->olds++] = part + k;
    }
    return DT_OK;
}

/* There is room. */
static inline void add_shared(struct dt_share *h, struct dt_shared i)
{
    h->item[h->items++] = i;
    h->sector[i.sector].n++;
}

/* Whether the sectors are few enough for floats. */
static bool is_coarse(const struct dt_share *h)
{
    return !h->on_line && h->sectors <= DT_COARSE_SECTORS;
}

/* Adds the points of a block that floats do not show to be less off than the worst one. */
static void add_block_coarsely(struct dt_worst *w, const struct dt_samples *s, uint32_t item,
                               const struct dt_sector *sector, const struct dt_coarse_plane *p)
{
    uint32_t part, n;
    if (dt_block_is_less_off(dt_item_block(s, item), &sector->plane, w->off))
        return;
    n = dt_item_parts(s, item, &part);
    const float least = dt_coarse_least(p, w->off);
    for (uint32_t end = part + n; part < end; part++)
        if (dt_item_level(part) > 0)
            add_block_coarsely(w, s, part, sector, p);
        else if (!(dt_coarse_plane_off(p, &s->rounded[part]) < least)) /* also if that is nan */
            dt_worst_add(w, s->v, part, dt_plane_off(&sector->plane, &s->v[part]));
}

/* Finds the sector of a block, and its worst point, or divides it. */
static enum dt_status share_block(struct dt_facets *f, struct dt_share *h, uint32_t item,
                                  struct dt_point p)
{
    const struct dt_samples *s = f->samples;
    uint32_t of = sector_of_block(h, p, dt_item_block(s, item));
    if (of == DT_NONE)
        return divide(s, h, item);
    if (reserve_items(h, h->items + 1) != DT_OK)
        return DT_NOMEM;
    struct dt_sector *sector = &h->sector[of];
    if (is_coarse(h)) {
        const struct dt_coarse_plane plane = dt_coarse_plane(&h->coarse, of, s);
        add_block_coarsely(&sector->worst, s, item, sector, &plane);
    } else
        dt_worst_add_block(&sector->worst, s, item, &sector->plane);
    add_shared(h, (struct dt_shared){item, of, LOOKED_AT});
    return DT_OK;
}

/* Finds the sectors of points, and how far they are off. */
static void share_exactly(struct dt_facets *f, struct dt_share *h,
                          const struct dt_coarse_points *points, struct dt_point p)
{
    const struct dt_sample *v = f->samples->v;
    for (uint32_t k = 0; k < points->n; k++) {
        const uint32_t item = points->item[k], of = sector_of(h, p, v[item].at);
        struct dt_sector *s = &h->sector[of];
        dt_worst_add(&s->worst, v, item, dt_plane_off(&s->plane, &v[item]));
        add_shared(h, (struct dt_shared){item, of, LOOKED_AT});
    }
}

/* The same, but about how far. */
static void share_coarsely(struct dt_facets *f, struct dt_share *h, struct dt_coarse_points *points,
                           struct dt_point p)
{
    const struct dt_sample *v = f->samples->v;
    uint32_t doubt[DT_COARSE_POINTS], doubts = 0;
    dt_coarse_find(&h->coarse, points);
    for (uint32_t k = 0; k < points->n; k++)
        if (points->sector[k] == DT_NONE) {
            dt_fetch(&v[points->item[k]]);
            doubt[doubts++] = k;
        }
    for (uint32_t i = 0; i < doubts; i++)
        points->sector[doubt[i]] = sector_of(h, p, v[points->item[doubt[i]]].at);
    float most[DT_COARSE_SECTORS];
    uint32_t n[DT_COARSE_SECTORS];
    for (uint32_t i = 0; i < h->sectors; i++) {
        most[i] = h->sector[i].most;
        n[i] = h->sector[i].n;
    }
    struct dt_shared *out = h->item + h->items;
    for (uint32_t k = 0; k < points->n; k++) {
        const uint32_t of = points->sector[k];
        const float off = dt_coarse_off(&h->coarse, of, points, k);
        out[k] = (struct dt_shared){points->item[k], of, off};
        n[of]++;
        most[of] = dt_float_most(off, most[of]);
    }
    h->items += points->n;
    for (uint32_t i = 0; i < h->sectors; i++) {
        h->sector[i].most = most[i];
        h->sector[i].n = n[i];
    }
}

static enum dt_status share_points(struct dt_facets *f, struct dt_share *h,
                                   struct dt_coarse_points *points, struct dt_point p)
{
    if (points->n == 0) /* there may be no array of items yet */
        return DT_OK;
    if (reserve_items(h, h->items + points->n) != DT_OK)
        return DT_NOMEM;
    if (is_coarse(h))
        share_coarsely(f, h, points, p);
    else
        share_exactly(f, h, points, p);
    points->n = 0;
    return DT_OK;
}

/* Finds the sectors of all items of the facets that have been replaced, except the new vertex. */
static enum dt_status share_items(struct dt_facets *f, struct dt_share *h, uint32_t vertex,
                                  struct dt_stop *stop)
{
    const struct dt_samples *s = f->samples;
    const struct dt_point p = s->v[vertex].at;
    struct dt_coarse_points points = {.n = 0};
    enum dt_status status = DT_OK;
    h->items = 0;
    for (size_t k = 0; k < h->olds && status == DT_OK; k++) {
        const uint32_t item = h->old[k];
        if (dt_item_level(item) > 0)
            status = share_block(f, h, item, p);
        else if (item != vertex)
            dt_coarse_see(&h->coarse, &points, item, &s->rounded[item]);
        if (points.n == DT_COARSE_POINTS || (k + 1 == h->olds && status == DT_OK))
            status = share_points(f, h, &points, p);
        if (k % DT_POLL_MISSES == DT_POLL_MISSES - 1 && dt_stopped(stop))
            status = dt_stop_status(stop);
    }
    return status;
}

/* Looks at the points that may be the worst ones. */
static void look_at(struct dt_facets *f, struct dt_share *h, const struct dt_shared *item, size_t n)
{
    const struct dt_sample *v = f->samples->v;
    for (size_t k = 0; k < n; k++) {
        struct dt_sector *s = &h->sector[item[k].sector];
        dt_worst_add(&s->worst, v, item[k].item, dt_plane_off(&s->plane, &v[item[k].item]));
    }
}

/* Writes the lists of the sectors, and finds their worst points. */
static void write_lists(struct dt_facets *f, struct dt_share *h)
{
    const struct dt_sample *v = f->samples->v;
    size_t n = 0;
    uint32_t first = dt_facets_take(f, h->items);
    for (uint32_t i = 0; i < h->sectors; i++) {
        struct dt_sector *s = &h->sector[i];
        s->first = first;
        first += s->n;
        s->most = is_coarse(h) ? s->most - 2 * h->coarse.error[i] : HUGE_VALF;
    }
    for (size_t k = 0; k < h->items; k++) {
        const struct dt_shared i = h->item[k];
        struct dt_sector *s = &h->sector[i.sector];
        f->pool[s->first++] = i.item;
        if (!(i.off < s->most) && !(i.off < 0)) { /* also if it or the limit is nan */
            dt_fetch(&v[i.item]);
            h->item[n++] = i;
        }
    }
    look_at(f, h, h->item, n);
}

/* The items of the facets that have been replaced become those of sectors. */
static enum dt_status share(struct dt_facets *f, struct dt_share *h, uint32_t vertex,
                            struct dt_stop *stop)
{
    enum dt_status status = share_items(f, h, vertex, stop);
    if (status != DT_OK)
        return status;
    write_lists(f, h);
    for (uint32_t i = 0; i < h->sectors; i++) {
        const struct dt_sector *s = &h->sector[i];
        dt_facet_set(
            f, s->base, &s->plane,
            (struct dt_facet){
                .off = s->worst.off, .first = s->first - s->n, .n = s->n, .worst = s->worst.point});
    }
    return DT_OK;
}

/* Takes the list of the facet of a record that has been replaced; there is room for it. */
static void take_list(struct dt_facets *f, struct dt_share *h, uint32_t base)
{
    const struct dt_facet *facet = &f->facet[base / 8];
    const uint32_t *list = f->pool + facet->first;
    for (uint32_t k = 0; k < facet->n; k++) {
        fetch_item(f->samples, list[k]);
        h->old[h->olds++] = list[k];
    }
    dt_facet_empty(f, base);
}

/* The sector of the facet with that base half edge: from there on around the new vertex. */
static void add_sector(struct dt_facets *f, struct dt_share *h, uint32_t base, struct dt_point p)
{
    struct dt_point to = f->xy[dt_origin(&f->set->mesh, base)];
    struct dt_corners c = dt_facet_corners(f, base);
    struct dt_sector *s = &h->sector[h->sectors++];
    *s = (struct dt_sector){.to = to,
                            .x = to.x - p.x,
                            .y = to.y - p.y,
                            .on_left = dt_compare_xy(p, to) < 0,
                            .base = base,
                            .plane = dt_plane_of(&c, f->samples->largest),
                            .worst = dt_worst_none};
    if (h->sectors <= DT_COARSE_SECTORS)
        dt_coarse_add(&h->coarse, f->samples, s->x, s->y, &s->plane);
}

/* The star of the new vertex, whose records are those of the cavity. At the hull it begins behind infinity. */
static void see_star(struct dt_facets *f, struct dt_share *h, uint32_t vertex)
{
    const struct dt_point p = f->samples->v[vertex].at;
    const struct dt_mesh *m = &f->set->mesh;
    const struct dt_cavity *c = &f->set->scratch;
    uint32_t first = 0;
    for (uint32_t i = 0; c->open && i < c->rims; i++)
        first = c->rim[i].origin == DT_NONE ? i : first;
    dt_coarse_begin(&h->coarse, f->samples, vertex);
    for (uint32_t k = 0, i = first; k < c->rims; k++, i = i + 1 < c->rims ? i + 1 : 0)
        if (!dt_is_ghost(m, c->record[i]))
            add_sector(f, h, c->record[i], p);
    h->half = h->sectors;
    for (uint32_t i = 1; !c->open && i < h->half; i++)
        if (dt_orient2d(h->sector[0].to, h->sector[i].to, p) <= 0)
            h->half = i;
    dt_coarse_end(&h->coarse, h->half);
}

/* The lists of the facets in these records, and the sectors that replace them. */
static enum dt_status take_star(struct dt_facets *f, struct dt_share *h, uint32_t vertex)
{
    const struct dt_cavity *c = &f->set->scratch;
    size_t n = 0;
    for (uint32_t i = 0; i < c->rims; i++)
        n += f->facet[c->record[i] / 8].n;
    if (reserve_sectors(h, c->rims) != DT_OK || reserve_old(h, n + 1) != DT_OK)
        return DT_NOMEM;
    h->on_line = false;
    for (uint32_t i = 0; i < c->rims; i++)
        take_list(f, h, c->record[i]);
    see_star(f, h, vertex);
    return DT_OK;
}

/* The same for an edge of points on a line that has become two; base: of the ghost whose corners ascend. */
static enum dt_status take_line(struct dt_facets *f, struct dt_share *h, uint32_t base,
                                uint32_t vertex)
{
    const struct dt_point p = f->samples->v[vertex].at;
    if (reserve_sectors(h, 2) != DT_OK || reserve_old(h, f->facet[base / 8].n + 1) != DT_OK)
        return DT_NOMEM;
    h->on_line = true;
    dt_coarse_begin(&h->coarse, f->samples, vertex);
    take_list(f, h, base);
    add_sector(f, h, base, p);
    add_sector(f, h, dt_base(dt_twin(&f->set->mesh, base + 1)), p);
    return DT_OK;
}

/* Whether the vertex is on a fixed edge of the triangle: then *half is that. */
static bool is_on_fixed(const struct dt_facets *f, struct dt_point q, uint32_t *half)
{
    const struct dt_mesh *m = &f->set->mesh;
    for (uint32_t h = dt_base(*half), end = h + 3; m->fixed != NULL && h < end; h++)
        if (dt_is_fixed(m, h) &&
            dt_orient2d(f->xy[dt_origin(m, h)], f->xy[dt_dest(m, h)], q) == 0) {
            *half = h;
            return true;
        }
    return false;
}

/* The facet's worst point becomes a vertex of the mesh. */
static enum dt_status insert(struct dt_facets *f, uint32_t base, uint32_t sample,
                             struct dt_stop *stop)
{
    const struct dt_point q = f->samples->v[sample].at;
    const uint32_t v = f->vertices;
    uint32_t half = base;
    bool line = dt_mesh_is_line(&f->set->mesh);
    f->xy[v] = q;
    f->z[v] = f->samples->v[sample].z;
    f->sample[v] = sample;
    bool on_edge = line || is_on_fixed(f, q, &half);
    f->set->scratch.work = stop;
    f->set->scratch.changes = NULL;
    enum dt_status status = dt_insert(&f->set->mesh, f->xy, v, on_edge ? DT_ON_EDGE : DT_INSIDE,
                                      half, &f->set->scratch);
    f->vertices += status == DT_OK;
    return status;
}

enum dt_status dt_share_insert(struct dt_facets *f, struct dt_share *h, uint32_t facet,
                               struct dt_stop *stop)
{
    const uint32_t base = 8 * facet, sample = f->facet[facet].worst;
    const bool line = dt_mesh_is_line(&f->set->mesh);
    enum dt_status status = insert(f, base, sample, stop);
    h->sectors = 0;
    h->olds = 0;
    if (status == DT_OK)
        status = line ? take_line(f, h, base, sample) : take_star(f, h, sample);
    return status == DT_OK ? share(f, h, sample, stop) : status;
}
