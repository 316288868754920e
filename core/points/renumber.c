/* renumber.c - see renumber.h.
 *
 * The vertices in their new order have their ids in any order, so entering the new vertices into the map
 * of ids writes all over it: the entries of some vertices further on are prefetched. */
#include "core/points/renumber.h"

#include "core/control/parallel.h"
#include "core/control/stop.h"
#include "core/memory/memory.h"

struct renumbering {
    struct dt_points *p;
    struct dt_stop *stop; /* NULL: it cannot be stopped any more */
    const uint32_t *id;
    uint32_t n;
    unsigned slices;
};

static void settle_slice(void *arg, unsigned slice)
{
    enum { AHEAD = 32 }; /* vertices; longer than a cache miss */
    const struct renumbering *r = arg;
    struct dt_piece at = dt_slice_pieces(r->n, slice, r->slices);
    while (dt_next_piece(r->stop, &at))
        for (uint32_t v = at.a; v < at.b; v++) {
            if (v + AHEAD < at.end)
                dt_fetch(dt_idmap_at(&r->p->value, r->id[v + AHEAD]));
            *dt_idmap_at(&r->p->value, r->id[v]) = v;
        }
}

/* The groups of aliases find the new vertices of their representatives. */
static void settle_groups(struct dt_points *p, struct dt_stop *stop)
{
    enum { AHEAD = 24 }; /* groups; long enough for a cache miss */
    const struct dt_alias_group *g = p->aliases.group;
    uint32_t n = p->group == NULL ? 0 : p->aliases.groups;
    for (uint32_t v = 0; v < p->group_cap; v++)
        p->group[v] = DT_NONE;
    for (uint32_t i = 0; i < n && (i % DT_POLL_MISSES != 0 || !dt_stopped(stop)); i++) {
        if (i + 2 * AHEAD < n)
            dt_idmap_fetch(&p->value, g[i + 2 * AHEAD].representative);
        if (i + AHEAD < n && dt_aliases_is_root(&p->aliases, i + AHEAD))
            dt_fetch(&p->group[dt_idmap_get(&p->value, g[i + AHEAD].representative)]);
        if (dt_aliases_is_root(&p->aliases, i))
            p->group[dt_idmap_get(&p->value, g[i].representative)] = i;
    }
}

enum dt_status dt_points_renumber(struct dt_points *p, struct dt_point **xy, uint32_t **id,
                                  uint32_t n, const struct dt_options *opt)
{
    const struct dt_pool *pool = opt == NULL ? NULL : opt->pool;
    struct dt_stop stop = dt_stop_of(opt);
    struct dt_stop *late = opt != NULL && opt->disposable ? &stop : NULL;
    struct renumbering r = {p, late, *id, n, dt_threads_for(pool, n)};
    struct dt_point *old_xy = p->xy;
    uint32_t *old_id = p->id;
    if (opt != NULL && dt_stopped(&stop))
        return dt_stop_status(&stop);
    if (p->group != NULL && dt_points_reserve_groups(p, n) != DT_OK)
        return DT_NOMEM;
    dt_run(pool, r.slices, settle_slice, &r);
    settle_groups(p, late);
    if (dt_stop_status(&stop) != DT_OK)
        return dt_stop_status(&stop);
    p->xy = *xy;
    p->id = *id;
    *xy = old_xy;
    *id = old_id;
    p->end = p->cap = n;
    p->free_count = 0;
    p->free_list = DT_NONE;
    dt_points_unplan(p);
    dt_places_clear(&p->places);
    return DT_OK;
}
