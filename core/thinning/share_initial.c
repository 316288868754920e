/* share_initial.c - which facets of the beginning have which points; see share.h. */
#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/query/locate.h"
#include "core/thinning/share.h"

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

/* Whether all of a block is inside the facet. */
static bool contains(const struct dt_facets *f, uint32_t base, const struct dt_bunch *b)
{
    const struct dt_mesh *m = &f->set->mesh;
    const struct dt_point first = f->xy[dt_origin(m, base)], second = f->xy[dt_dest(m, base)];
    if (dt_mesh_is_line(m))
        return dt_block_order(b, first) > 0 && dt_block_order(b, second) < 0;
    bool inside = true;
    for (uint32_t h = base, end = h + 3; inside && h < end; h++) {
        const struct dt_point o = f->xy[dt_origin(m, h)], to = f->xy[dt_dest(m, h)];
        inside = dt_block_side(b, o, (struct dt_point){to.x - o.x, to.y - o.y}) > 0;
    }
    return inside;
}

/* The bases of the facets of points and blocks. */
struct homes {
    struct dt_facets *f;
    const bool *kept;
    struct dt_stop *stop;
    uint32_t near; /* a half edge where the last point was */
    /* owns: of points, then of blocks in the order of samples.h; DT_NONE: of none, or parts have their own */
    uint32_t *base;
};

static uint32_t *home_of(const struct homes *h, uint32_t item)
{
    const struct dt_samples *s = h->f->samples;
    uint32_t level = dt_item_level(item), number = dt_item_number(item);
    return &h->base[level == 0 ? number : s->n + s->start[level] + number];
}

/* The facet that has all points of a block; DT_NONE: there may be several, or points without a value. */
static uint32_t facet_of_block(struct homes *h, uint32_t block)
{
    const struct dt_samples *s = h->f->samples;
    const struct dt_bunch *b = dt_item_block(s, block);
    uint32_t base = DT_NONE, first = block;
    while (dt_item_level(first) > 0)
        (void)dt_item_parts(s, first, &first);
    if (!isnan(b->most))
        base = facet_of(h->f, s->v[first].at, &h->near);
    return base != DT_NONE && contains(h->f, base, b) ? base : DT_NONE;
}

/* Finds the homes of an item, and of its parts if it has none. */
static void find_homes(struct homes *h, uint32_t item)
{
    enum { POLLED = 5 }; /* blocks of this level have DT_POLL_MISSES points */
    const struct dt_samples *s = h->f->samples;
    const uint32_t level = dt_item_level(item);
    uint32_t part = 0, n = 0, *home = home_of(h, item);
    if (level == POLLED && dt_stopped(h->stop))
        return;
    if (level > 0) {
        *home = facet_of_block(h, item);
        n = *home == DT_NONE ? dt_item_parts(s, item, &part) : 0;
    } else if (h->kept[item] || isnan(s->v[item].z)) {
        *home = DT_NONE;
    } else {
        *home = facet_of(h->f, s->v[item].at, &h->near);
    }
    for (uint32_t end = part + n; part < end; part++)
        find_homes(h, part);
}

static void find_all_homes(struct homes *h)
{
    const struct dt_samples *s = h->f->samples;
    for (uint32_t i = 0; i < s->count[s->levels]; i++)
        find_homes(h, dt_item_of(s->levels, i));
}

/* The three passes over items: all are counted; blocks are appended to lists, then points. */
enum settling { COUNT, BLOCKS, POINTS };

static void settle_in(struct dt_facets *f, struct dt_facet *facet, uint32_t item, enum settling how)
{
    const bool is_block = dt_item_level(item) > 0;
    if (how == COUNT)
        facet->n++;
    else if (is_block == (how == BLOCKS)) {
        const struct dt_rounded block = {0, 0, 0, item};
        f->pool[facet->first + facet->n++] = is_block ? block : f->samples->rounded[item];
        facet->blocks += is_block;
    }
}

/* Does so with the items that the item becomes in the lists. */
static void settle(const struct homes *h, uint32_t item, enum settling how)
{
    uint32_t home = *home_of(h, item), part = 0, n = 0;
    if (home != DT_NONE) {
        settle_in(h->f, &h->f->facet[home / 8], item, how);
    } else if (dt_item_level(item) > 0) {
        n = dt_item_parts(h->f->samples, item, &part);
    }
    for (uint32_t k = 0; k < n; k++)
        settle(h, part + k, how);
}

static void settle_all(const struct homes *h, enum settling how)
{
    const struct dt_samples *s = h->f->samples;
    for (uint32_t i = 0; i < s->count[s->levels]; i++)
        settle(h, dt_item_of(s->levels, i), how);
}

/* Writes the lists of all facets. */
static void fill_pool(struct dt_facets *f, const struct homes *h)
{
    settle_all(h, COUNT);
    for (uint32_t i = 0; i < f->set->mesh.tri_end; i++) {
        f->facet[i].first = dt_facets_take(f, f->facet[i].n);
        f->facet[i].n = 0;
    }
    settle_all(h, BLOCKS);
    settle_all(h, POINTS);
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
    for (uint32_t k = 0; k < facet.blocks; k++) {
        const uint32_t item = f->pool[facet.first + k].item;
        dt_worst_raise(&w, dt_block_off_range(dt_item_block(f->samples, item), &p).least);
    }
    for (uint32_t k = 0; k < facet.n; k++) {
        add_item(&w, f->samples, f->pool[facet.first + k].item, &p);
        if (k % DT_POLL_MISSES == 0 && dt_stopped(stop))
            return dt_stop_status(stop);
    }
    facet.off = w.off;
    facet.worst = w.point;
    return dt_facet_set(f, base, &p, facet, stop);
}

enum dt_status dt_share_all(struct dt_facets *f, const bool *kept, struct dt_pages *pages,
                            struct dt_stop *stop)
{
    const size_t n = f->samples->n, items = n + n / 8 + DT_BLOCK_LEVELS;
    struct homes h = {f, kept, stop, f->set->mesh.hull,
                      dt_array_new_in(pages, items, sizeof *h.base)};
    enum dt_status status = h.base == NULL ? DT_NOMEM : DT_OK;
    if (f->set->mesh.vertices >= 2 && status == DT_OK) {
        find_all_homes(&h);
        status = dt_stop_status(stop);
        if (status == DT_OK)
            fill_pool(f, &h);
        for (uint32_t i = 0; i < f->set->mesh.tri_end && status == DT_OK; i++)
            if (dt_is_facet(f, 8 * i))
                status = measure(f, 8 * i, stop);
    }
    dt_array_free(h.base);
    return status;
}
