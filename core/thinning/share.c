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
#include <string.h>

void dt_share_clear(struct dt_share *h)
{
    free(h->sector);
    dt_array_free(h->point);
    dt_array_free(h->of);
    dt_array_free(h->off);
    dt_array_free(h->block);
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

/* There is room up to a multiple of four. */
static enum dt_status reserve_points(struct dt_share *h, size_t n)
{
    n += 3;
    if (n <= h->point_cap)
        return DT_OK;
    size_t cap = dt_array_room(h->point_cap, n, UINT32_MAX);
    if (!dt_array_resize(NULL, &h->point, h->points, cap, sizeof *h->point) ||
        !dt_array_resize(NULL, &h->of, 0, cap, sizeof *h->of) ||
        !dt_array_resize(NULL, &h->off, 0, cap, sizeof *h->off))
        return DT_NOMEM;
    h->point_cap = cap;
    return DT_OK;
}

static enum dt_status reserve_blocks(struct dt_share *h, size_t n)
{
    if (n <= h->block_cap)
        return DT_OK;
    size_t cap = dt_array_room(h->block_cap, n, UINT32_MAX);
    if (!dt_array_resize(NULL, &h->block, h->blocks, cap, sizeof *h->block))
        return DT_NOMEM;
    h->block_cap = cap;
    return DT_OK;
}

/* ---- the sector of a point ---- */

/* Whether q, as seen from p at (x, y), is in the sector or in those after it, given that it is less than a half turn from the
 * edge where that begins. *sign: 0 if q is on the line of that edge. */
static inline bool is_after(const struct dt_sector *s, struct dt_point p, struct dt_point q,
                            double x, double y, int *sign)
{
    double left = s->way.x * y, right = s->way.y * x, det = left - right;
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

/* The sector of a block; DT_NONE: edges may divide it. */
static uint32_t sector_of_block(const struct dt_share *h, struct dt_point p,
                                const struct dt_bunch *b)
{
    uint32_t i = 1, end = h->half;
    int side = 1;
    if (h->on_line) {
        side = dt_block_order(b, p);
        i = side > 0 ? 2 : 1;
        end = 0;
    } else if (h->half < h->sectors) {
        side = dt_block_side(b, p, h->sector[0].way);
        i = side > 0 ? 1 : h->half;
        end = side > 0 ? h->half : h->sectors;
    }
    while (side != 0 && i < end && (side = dt_block_side(b, p, h->sector[i].way)) > 0)
        i++;
    return side != 0 ? i - 1 : DT_NONE;
}

/* ---- blocks ---- */

/* Fetches what finding the sector of a block will read, and what its parts will if they are points. */
static void fetch_block(const struct dt_samples *s, uint32_t item)
{
    dt_fetch(dt_item_block(s, item));
    if (dt_item_level(item) == 1)
        dt_fetch(&s->rounded[DT_BLOCK_POINTS * dt_item_number(item)]);
}

/* Whether the sectors are few enough for floats. */
static bool is_coarse(const struct dt_share *h)
{
    return !h->on_line && h->sectors <= DT_COARSE_SECTORS;
}

/* The parts of a block that edges divide get behind the blocks that are left, or behind the points, so that they are fetched until it
 * is their turn. */
static enum dt_status divide(const struct dt_samples *s, struct dt_share *h, uint32_t item)
{
    uint32_t part, n = dt_item_parts(s, item, &part);
    const bool are_points = dt_item_level(part) == 0;
    if ((are_points ? reserve_points(h, h->points + n) : reserve_blocks(h, h->blocks + n)) != DT_OK)
        return DT_NOMEM;
    for (uint32_t end = part + n; part < end; part++)
        if (are_points) {
            dt_fetch(&s->rounded[part]);
            h->point[h->points++].item = part;
        } else {
            fetch_block(s, part);
            h->block[h->blocks++].item = part;
        }
    return DT_OK;
}

/* Finds the sectors of blocks, and how far their worst points are off at least, or divides them. */
static enum dt_status share_blocks(const struct dt_samples *s, struct dt_share *h,
                                   struct dt_point p, struct dt_stop *stop)
{
    size_t known = 0, points = h->points;
    for (size_t k = 0; k < h->blocks; k++) {
        const uint32_t item = h->block[k].item;
        const struct dt_bunch *b = dt_item_block(s, item);
        const uint32_t of = sector_of_block(h, p, b);
        if (of == DT_NONE && divide(s, h, item) != DT_OK)
            return DT_NOMEM;
        if (of != DT_NONE) {
            struct dt_sector *sector = &h->sector[of];
            dt_worst_raise(&sector->worst, dt_block_off_range(b, &sector->plane).least);
            sector->blocks++;
            h->block[known++] = (struct dt_shared){item, of};
        }
        if (k % DT_POLL_MISSES == DT_POLL_MISSES - 1 && dt_stopped(stop))
            return dt_stop_status(stop);
    }
    h->blocks = known;
    for (; points < h->points; points++)
        h->point[points] = s->rounded[h->point[points].item];
    return DT_OK;
}

/* ---- points ---- */

/* Finds the sectors of the points of an array from `from` on, except that of the new vertex, and how far they are off. */
static void share_exactly(const struct dt_samples *s, struct dt_share *h, size_t from, uint32_t n,
                          uint32_t vertex)
{
    for (size_t k = from; k < from + n; k++) {
        const uint32_t item = h->point[k].item;
        h->of[k] = item == vertex ? DT_NONE : sector_of(h, s->v[vertex].at, s->v[item].at);
        h->off[k] = 0;
        if (item == vertex)
            continue;
        struct dt_sector *sector = &h->sector[h->of[k]];
        dt_worst_add(&sector->worst, s->v, item, dt_plane_off(&sector->plane, &s->v[item]));
        sector->n++;
    }
}

enum { BATCH = 64 }; /* points */

/* Finds the sectors of points that floats have left in doubt, and how far they are off. The new vertex is one of them, and stays without
 * a sector. */
static void settle_doubts(const struct dt_samples *s, struct dt_share *h, size_t from, size_t end,
                          uint32_t vertex)
{
    size_t doubt[BATCH];
    uint32_t doubts = 0;
    for (size_t k = from; k < end; k++)
        if (h->of[k] == DT_NONE && h->point[k].item != vertex) {
            dt_fetch(&s->v[h->point[k].item]);
            doubt[doubts++] = k;
        }
    for (uint32_t i = 0; i < doubts; i++) {
        const uint32_t item = h->point[doubt[i]].item;
        const uint32_t of = sector_of(h, s->v[vertex].at, s->v[item].at);
        struct dt_sector *sector = &h->sector[of];
        dt_worst_add(&sector->worst, s->v, item, dt_plane_off(&sector->plane, &s->v[item]));
        h->of[doubt[i]] = of;
        h->off[doubt[i]] = 0;
    }
}

/* The same as share_exactly, but about how far most points are off. */
static void share_coarsely(const struct dt_samples *s, struct dt_share *h, size_t from, uint32_t n,
                           uint32_t vertex)
{
    dt_coarse_find(&h->coarse, h->point + from, n, h->of + from, h->off + from);
    settle_doubts(s, h, from, from + n, vertex);
    dt_coarse_tally(&h->coarse, n, h->of + from, h->off + from);
}

static enum dt_status share_points(const struct dt_samples *s, struct dt_share *h, uint32_t vertex,
                                   struct dt_stop *stop)
{
    for (size_t k = h->points; k % 4 != 0; k++)
        h->point[k] = (struct dt_rounded){0};
    for (size_t from = 0, n; from < h->points; from += n) {
        n = h->points - from < BATCH ? h->points - from : BATCH;
        if (is_coarse(h))
            share_coarsely(s, h, from, (uint32_t)n, vertex);
        else
            share_exactly(s, h, from, (uint32_t)n, vertex);
        if (from % DT_POLL_MISSES == DT_POLL_MISSES - n && dt_stopped(stop))
            return dt_stop_status(stop);
    }
    for (uint32_t i = 0; is_coarse(h) && i < h->sectors; i++) {
        const double least = (double)h->coarse.most[i] - 1.01 * (double)h->coarse.error[i];
        dt_worst_raise(&h->sector[i].worst, least / s->per_value);
        h->sector[i].n = h->coarse.count[i];
    }
    return DT_OK;
}

/* ---- lists ---- */

/* Makes room for the points. Writes the blocks, and looks at those that may have the worst points. */
static void begin_lists(struct dt_facets *f, struct dt_share *h)
{
    dt_facets_make_room(f, h->blocks + h->points);
    for (uint32_t i = 0; i < h->sectors; i++) {
        struct dt_sector *s = &h->sector[i];
        s->n += s->blocks;
        s->first = dt_facets_take(f, s->n);
        s->blocks = 0;
    }
    for (size_t k = 0; k < h->blocks; k++) {
        struct dt_sector *s = &h->sector[h->block[k].sector];
        f->pool[s->first + s->blocks++] = (struct dt_rounded){0, 0, 0, h->block[k].item};
        dt_worst_add_block(&s->worst, f->samples, h->block[k].item, &s->plane);
    }
}

/* Writes the points of the sectors, and looks at those that may be the worst ones. */
static void write_coarsely(struct dt_facets *f, struct dt_share *h)
{
    const struct dt_sample *v = f->samples->v;
    uint32_t end[DT_COARSE_SECTORS];
    float most[DT_COARSE_SECTORS];
    size_t n = 0;
    for (uint32_t i = 0; i < h->sectors; i++) {
        end[i] = h->sector[i].first + h->sector[i].blocks;
        most[i] = h->coarse.most[i] - 2 * h->coarse.error[i];
    }
    for (size_t k = 0; k < h->points; k++) {
        const uint32_t of = h->of[k];
        if (of == DT_NONE)
            continue;
        f->pool[end[of]++] = h->point[k];
        if (!(h->off[k] < most[of])) { /* also if it or the limit is nan */
            dt_fetch(&v[h->point[k].item]);
            h->block[n++] = (struct dt_shared){h->point[k].item, of};
        }
    }
    for (size_t k = 0; k < n; k++) {
        struct dt_sector *s = &h->sector[h->block[k].sector];
        const uint32_t item = h->block[k].item;
        dt_worst_add(&s->worst, v, item, dt_plane_off(&s->plane, &v[item]));
    }
}

static void write_points(struct dt_facets *f, struct dt_share *h)
{
    for (size_t k = 0; k < h->points; k++)
        if (h->of[k] != DT_NONE) {
            struct dt_sector *s = &h->sector[h->of[k]];
            f->pool[s->first++ + s->blocks] = h->point[k];
        }
    for (uint32_t i = 0; i < h->sectors; i++)
        h->sector[i].first -= h->sector[i].n - h->sector[i].blocks;
}

/* The items of the facets that have been replaced become those of sectors. */
static enum dt_status share(struct dt_facets *f, struct dt_share *h, uint32_t vertex,
                            struct dt_stop *stop)
{
    enum dt_status status = share_blocks(f->samples, h, f->samples->v[vertex].at, stop);
    if (status == DT_OK)
        status = share_points(f->samples, h, vertex, stop);
    if (status == DT_OK)
        status = reserve_blocks(h, h->points);
    if (status != DT_OK)
        return status;
    begin_lists(f, h);
    if (is_coarse(h))
        write_coarsely(f, h);
    else
        write_points(f, h);
    for (uint32_t i = 0; i < h->sectors && status == DT_OK; i++) {
        const struct dt_sector *s = &h->sector[i];
        const struct dt_facet facet = {.off = s->worst.off,
                                       .first = s->first,
                                       .n = s->n,
                                       .blocks = s->blocks,
                                       .worst = s->worst.point};
        status = dt_facet_set(f, s->base, &s->plane, facet, stop);
    }
    return status;
}

/* Takes the list of the facet of a record that has been replaced; there is room for it. */
static void take_list(struct dt_facets *f, struct dt_share *h, uint32_t base)
{
    const struct dt_facet *facet = &f->facet[base / 8];
    const struct dt_rounded *list = f->pool + facet->first;
    for (uint32_t k = 0; k < facet->blocks; k++) {
        fetch_block(f->samples, list[k].item);
        h->block[h->blocks++].item = list[k].item;
    }
    for (uint32_t k = facet->blocks; k < facet->n; k++)
        h->point[h->points++] = list[k];
    dt_facet_empty(f, base);
}

/* The sector of the facet with that base half edge: from there on around the new vertex. */
static void add_sector(struct dt_facets *f, struct dt_share *h, uint32_t base, struct dt_point p)
{
    struct dt_point to = f->xy[dt_origin(&f->set->mesh, base)];
    struct dt_corners c = dt_facet_corners(f, base);
    struct dt_sector *s = &h->sector[h->sectors++];
    *s = (struct dt_sector){.to = to,
                            .way = {to.x - p.x, to.y - p.y},
                            .on_left = dt_compare_xy(p, to) < 0,
                            .base = base,
                            .plane = dt_plane_of(&c, f->samples->largest),
                            .worst = dt_worst_none};
    if (h->sectors <= DT_COARSE_SECTORS)
        dt_coarse_add(&h->coarse, f->samples, s->way, &s->plane);
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
    size_t n = 0, blocks = 0;
    for (uint32_t i = 0; i < c->rims; i++) {
        const struct dt_facet *facet = &f->facet[c->record[i] / 8];
        n += facet->n;
        blocks += facet->blocks;
        dt_fetch(f->pool + facet->first);
    }
    if (reserve_sectors(h, c->rims) != DT_OK || reserve_points(h, n) != DT_OK ||
        reserve_blocks(h, blocks) != DT_OK)
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
    const struct dt_facet *facet = &f->facet[base / 8];
    if (reserve_sectors(h, 2) != DT_OK || reserve_points(h, facet->n) != DT_OK ||
        reserve_blocks(h, facet->blocks) != DT_OK)
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
    h->points = 0;
    h->blocks = 0;
    if (status == DT_OK)
        status = line ? take_line(f, h, base, sample) : take_star(f, h, sample);
    return status == DT_OK ? share(f, h, sample, stop) : status;
}
