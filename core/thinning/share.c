/* share.c - see share.h.
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
#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"
#include "core/query/locate.h"

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

/* ---- from the beginning ---- */

/* Whether a point on the edge of the half edge belongs to the facet on its left. */
static bool owns_edge(const struct dt_facets *f, uint32_t half)
{
    const struct dt_mesh *m = &f->set->mesh;
    return dt_compare_xy(f->xy[dt_origin(m, half)], f->xy[dt_dest(m, half)]) < 0;
}

/* The record whose facet has the point, near a half edge; DT_NONE: it is a vertex. *near becomes one there. */
static uint32_t facet_of(const struct dt_facets *f, struct dt_point q, uint32_t *near)
{
    const struct dt_mesh *m = &f->set->mesh;
    uint32_t half;
    enum dt_where where = dt_walk(m, f->xy, *near, q, &half);
    *near = half;
    if (where == DT_ON_VERTEX)
        return DT_NONE;
    if (where != DT_ON_EDGE)
        return dt_base(half);
    uint32_t twin = dt_twin(m, half);
    if (!dt_mesh_is_line(m) && (dt_is_ghost(m, half) || dt_is_ghost(m, twin)))
        return dt_base(dt_is_ghost(m, half) ? twin : half);
    return dt_base(owns_edge(f, half) ? half : twin);
}

/* The bases of the facets of all points and blocks, by level; DT_NONE: of none, or of several. */
struct homes {
    uint32_t *base; /* owns: of points, then of blocks in the order of samples.h */
};

static uint32_t *home_of(const struct homes *h, const struct dt_samples *s, uint32_t item)
{
    uint32_t level = dt_item_level(item), number = dt_item_number(item);
    return &h->base[level == 0 ? number : s->n + s->start[level] + number];
}

static enum dt_status find_homes(const struct dt_facets *f, const bool *kept, struct homes *h,
                                 struct dt_stop *stop)
{
    const struct dt_samples *s = f->samples;
    uint32_t near = f->set->mesh.hull, part;
    for (struct dt_piece at = dt_pieces(0, s->n); dt_next_piece(stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            h->base[i] = kept[i] || isnan(s->v[i].z) ? DT_NONE : facet_of(f, s->v[i].at, &near);
    for (uint32_t level = 1; level <= s->levels; level++)
        for (struct dt_piece at = dt_pieces(0, s->count[level]); dt_next_piece(stop, &at);)
            for (uint32_t i = at.a; i < at.b; i++) {
                uint32_t item = dt_item_of(level, i), n = dt_item_parts(s, item, &part);
                uint32_t home = *home_of(h, s, part);
                for (uint32_t k = 1; k < n; k++)
                    home = *home_of(h, s, part + k) == home ? home : DT_NONE;
                *home_of(h, s, item) = home;
            }
    return dt_stop_status(stop);
}

/* Counts the items that the item becomes in the lists, or appends them. */
static void settle(struct dt_facets *f, const struct homes *h, uint32_t item, bool append)
{
    const struct dt_samples *s = f->samples;
    uint32_t home = *home_of(h, s, item), part = 0, n = 0;
    if (home != DT_NONE) {
        struct dt_facet *facet = &f->facet[home / 8];
        if (append)
            f->pool[facet->first + facet->n] = item;
        facet->n++;
    } else if (dt_item_level(item) > 0) {
        n = dt_item_parts(s, item, &part);
    }
    for (uint32_t k = 0; k < n; k++)
        settle(f, h, part + k, append);
}

static void settle_all(struct dt_facets *f, const struct homes *h, bool append)
{
    const struct dt_samples *s = f->samples;
    for (uint32_t i = 0; i < s->count[s->levels]; i++)
        settle(f, h, dt_item_of(s->levels, i), append);
}

/* Writes the lists of all facets. */
static void fill_pool(struct dt_facets *f, const struct homes *h)
{
    settle_all(f, h, false);
    for (uint32_t i = 0; i < f->set->mesh.tri_end; i++) {
        f->facet[i].first = dt_facets_take(f, f->facet[i].n);
        f->facet[i].n = 0;
    }
    settle_all(f, h, true);
}

static void add_item(struct dt_worst *w, const struct dt_samples *s, uint32_t item,
                     const struct dt_plane *p)
{
    if (dt_item_level(item) == 0)
        dt_worst_add(w, s->v, item, dt_plane_off(p, &s->v[item]));
    else
        dt_worst_add_block(w, s, item, p);
}

/* Finds the worst point of a facet that has its list. */
static enum dt_status measure(struct dt_facets *f, uint32_t base, struct dt_stop *stop)
{
    struct dt_corners c = dt_facet_corners(f, base);
    struct dt_plane p = dt_plane_of(&c, f->samples->largest);
    struct dt_worst w = dt_worst_none;
    struct dt_facet facet = f->facet[base / 8];
    f->facet[base / 8].n = 0;
    for (uint32_t k = 0; k < facet.n; k++) {
        add_item(&w, f->samples, f->pool[facet.first + k], &p);
        if (k % DT_POLL_MISSES == 0 && dt_stopped(stop))
            return dt_stop_status(stop);
    }
    facet.off = w.off;
    facet.worst = w.point;
    dt_facet_set(f, base, &p, facet);
    return DT_OK;
}

enum dt_status dt_share_all(struct dt_facets *f, const bool *kept, struct dt_stop *stop)
{
    const struct dt_samples *s = f->samples;
    struct homes h = {dt_array_new(2 * (size_t)s->n + DT_BLOCK_LEVELS, sizeof *h.base)};
    enum dt_status status = h.base == NULL ? DT_NOMEM : DT_OK;
    if (f->set->mesh.vertices >= 2 && status == DT_OK) {
        status = find_homes(f, kept, &h, stop);
        if (status == DT_OK)
            fill_pool(f, &h);
        for (uint32_t i = 0; i < f->set->mesh.tri_end && status == DT_OK; i++)
            if (dt_is_facet(f, 8 * i))
                status = measure(f, 8 * i, stop);
    }
    dt_array_free(h.base);
    return status;
}

/* ---- around a new vertex ---- */

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
static inline uint32_t sector_of(const struct dt_share *h, struct dt_point p, struct dt_point q)
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

/* The same for points that are on no line of an edge, else DT_NONE. Branches would be unpredictable, so there is none for each
 * edge: bit i of `left` says whether q is left of edge i. */
static inline uint32_t sector_at_once(const struct dt_share *h, struct dt_point p,
                                      struct dt_point q)
{
    const dt_lanes x = dt_lanes_both(q.x - p.x), y = dt_lanes_both(q.y - p.y);
    uint32_t left = 0, sure = 0, n = h->sectors;
    for (uint32_t i = 0; i < n; i += 2) {
        dt_lanes plus = dt_lanes_load(&h->x[i]) * y, minus = dt_lanes_load(&h->y[i]) * x;
        dt_lanes size = dt_lanes_both(DT_ORIENT_BOUND) * (dt_lanes_abs(plus) + dt_lanes_abs(minus));
        dt_lanes det = plus - minus;
        left |= (uint32_t)dt_lanes_bits(det > size) << i;
        sure |= (uint32_t)dt_lanes_bits(dt_lanes_abs(det) > size) << i;
    }
    const uint32_t all = (1u << n) - 1, before = (1u << h->half) - 1;
    const uint32_t second = 0 - (~left & 1 & (h->half < n));
    const uint32_t from = (before & second) | (1 & ~second),
                   end = (before & ~second) | (all & second);
    return (sure & all) == all ? (uint32_t)__builtin_ctz((~left & ~from) | ~end) - 1 : DT_NONE;
}

/* The sector of a point. */
static inline uint32_t sector_of_point(const struct dt_share *h, struct dt_point p,
                                       struct dt_point q)
{
    uint32_t of = DT_NONE;
    if (h->sectors <= DT_SECTORS_AT_ONCE && !h->on_line)
        of = sector_at_once(h, p, q);
    return of != DT_NONE ? of : sector_of(h, p, q);
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

/* Fetches what find_sector will read. */
static void fetch_item(const struct dt_samples *s, uint32_t item)
{
    if (dt_item_level(item) == 0)
        dt_fetch(&s->v[item]);
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

/* Finds the sector of an item, and how far it is off the plane there; drops the new vertex. */
static enum dt_status find_sector(struct dt_facets *f, struct dt_share *h, uint32_t item,
                                  uint32_t vertex)
{
    const struct dt_samples *s = f->samples;
    const struct dt_point p = s->v[vertex].at;
    if (item == vertex)
        return DT_OK;
    uint32_t of = dt_item_level(item) == 0 ? sector_of_point(h, p, s->v[item].at)
                                           : sector_of_block(h, p, dt_item_block(s, item));
    if (of == DT_NONE)
        return divide(s, h, item);
    if (h->items == h->item_cap && reserve_items(h, h->items + 1) != DT_OK)
        return DT_NOMEM;
    h->item[h->items++] = (struct dt_shared){item, of};
    h->sector[of].n++;
    add_item(&h->sector[of].worst, s, item, &h->sector[of].plane);
    return DT_OK;
}

/* The items of the facets that have been replaced become those of sectors. */
static enum dt_status share(struct dt_facets *f, struct dt_share *h, uint32_t vertex,
                            struct dt_stop *stop)
{
    enum dt_status status = DT_OK;
    h->items = 0;
    for (size_t k = 0; k < h->olds && status == DT_OK; k++) {
        status = find_sector(f, h, h->old[k], vertex);
        if (k % DT_POLL_MISSES == DT_POLL_MISSES - 1 && dt_stopped(stop))
            status = dt_stop_status(stop);
    }
    if (status != DT_OK)
        return status;
    uint32_t first = dt_facets_take(f, h->items);
    for (uint32_t i = 0; i < h->sectors; i++) {
        h->sector[i].first = first;
        first += h->sector[i].n;
    }
    for (size_t k = 0; k < h->items; k++)
        f->pool[h->sector[h->item[k].sector].first++] = h->item[k].item;
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
    if (h->sectors < DT_SECTORS_AT_ONCE) {
        h->x[h->sectors] = to.x - p.x;
        h->y[h->sectors] = to.y - p.y;
    }
    h->sector[h->sectors++] = (struct dt_sector){.to = to,
                                                 .x = to.x - p.x,
                                                 .y = to.y - p.y,
                                                 .on_left = dt_compare_xy(p, to) < 0,
                                                 .base = base,
                                                 .plane = dt_plane_of(&c, f->samples->largest),
                                                 .worst = dt_worst_none};
}

/* The star of the new vertex, whose records are those of the cavity. At the hull it begins behind infinity. */
static void see_star(struct dt_facets *f, struct dt_share *h, struct dt_point p)
{
    const struct dt_mesh *m = &f->set->mesh;
    const struct dt_cavity *c = &f->set->scratch;
    uint32_t first = 0;
    for (uint32_t i = 0; c->open && i < c->rims; i++)
        first = c->rim[i].origin == DT_NONE ? i : first;
    for (uint32_t k = 0, i = first; k < c->rims; k++, i = i + 1 < c->rims ? i + 1 : 0)
        if (!dt_is_ghost(m, c->record[i]))
            add_sector(f, h, c->record[i], p);
    h->half = h->sectors;
    for (uint32_t i = 1; !c->open && i < h->half; i++)
        if (dt_orient2d(h->sector[0].to, h->sector[i].to, p) <= 0)
            h->half = i;
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
    see_star(f, h, f->samples->v[vertex].at);
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
