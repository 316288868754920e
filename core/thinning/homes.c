/* homes.c - which facets of the beginning have which points; see share.h. */
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
static void settle(struct dt_facets *f, const struct homes *h, uint32_t item, enum settling how)
{
    const struct dt_samples *s = f->samples;
    uint32_t home = *home_of(h, s, item), part = 0, n = 0;
    if (home != DT_NONE) {
        settle_in(f, &f->facet[home / 8], item, how);
    } else if (dt_item_level(item) > 0) {
        n = dt_item_parts(s, item, &part);
    }
    for (uint32_t k = 0; k < n; k++)
        settle(f, h, part + k, how);
}

static void settle_all(struct dt_facets *f, const struct homes *h, enum settling how)
{
    const struct dt_samples *s = f->samples;
    for (uint32_t i = 0; i < s->count[s->levels]; i++)
        settle(f, h, dt_item_of(s->levels, i), how);
}

/* Writes the lists of all facets. */
static void fill_pool(struct dt_facets *f, const struct homes *h)
{
    settle_all(f, h, COUNT);
    for (uint32_t i = 0; i < f->set->mesh.tri_end; i++) {
        f->facet[i].first = dt_facets_take(f, f->facet[i].n);
        f->facet[i].n = 0;
    }
    settle_all(f, h, BLOCKS);
    settle_all(f, h, POINTS);
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
    const struct dt_samples *s = f->samples;
    struct homes h = {dt_array_new_in(pages, 2 * (size_t)s->n + DT_BLOCK_LEVELS, sizeof *h.base)};
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
