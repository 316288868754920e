/* renumber.c - see renumber.h.
 *
 * The vertices in their new order have their ids in any order, so entering the new vertices into the map
 * of ids writes all over it: a cache miss for each. For large sets the ids are dealt first,
 *
 *      id       v: 0 1 2 3 ... n-1        the ids of the vertices
 *                   \   \ /   \           1. count, 2. deal: by slices of vertices
 *      pairs    part 0 | part 1 | ...     (id, v), by ids: those of a part are neighbours
 *                  |       |              3. settle: by parts
 *      value    id: 0 1 2 ...
 *
 * and the part of the map that one of the parts writes to stays in the cache. Steps 1 and 2 can be given up;
 * step 3 changes the set, so only one that is disposable can be given up then. Up to a few million vertices
 * all steps are one. */
#include "core/points/renumber.h"

#include <string.h>

#include "core/control/parallel.h"
#include "core/control/stop.h"
#include "core/memory/memory.h"

enum {
    MANY = 1 << 21,     /* vertices that are worth dealing */
    PART_BITS = 16,     /* ids of a part, unless that makes too many parts */
    MOST_PARTS = 1 << 8 /* cache lines that are written to in turn */
};

struct pair {
    uint32_t id, v;
};

struct renumbering {
    struct dt_points *p;
    struct dt_stop stop;
    struct dt_stop *late; /* the same, if it may still be asked when *p changes; else NULL */
    const uint32_t *id;
    uint32_t n;
    unsigned slices;
    struct pair *pair;
    unsigned shift; /* of an id, to its part */
    uint32_t start[MOST_PARTS + 1];
    uint32_t at[DT_MAX_THREADS][MOST_PARTS]; /* how many pairs, then where the next one goes */
};

/* ---- all in one ---- */

/* The next piece of a slice of vertices. */
static bool next_piece(const struct renumbering *r, struct dt_stop *stop, unsigned slice,
                       struct dt_piece *at)
{
    return dt_next_piece(stop, dt_slice(r->n, slice + 1, r->slices), at);
}

static struct dt_piece before_slice(const struct renumbering *r, unsigned slice)
{
    return dt_before_first(dt_slice(r->n, slice, r->slices));
}

static void settle_slice(void *arg, unsigned slice)
{
    const struct renumbering *r = arg;
    for (struct dt_piece at = before_slice(r, slice); next_piece(r, r->late, slice, &at);)
        for (uint32_t v = at.a; v < at.b; v++)
            *dt_idmap_at(&r->p->value, r->id[v]) = v;
}

/* ---- in parts ---- */

static void count(void *arg, unsigned slice)
{
    struct renumbering *r = arg;
    uint32_t *pairs = r->at[slice];
    memset(pairs, 0, sizeof r->at[slice]);
    for (struct dt_piece at = before_slice(r, slice); next_piece(r, &r->stop, slice, &at);)
        for (uint32_t v = at.a; v < at.b; v++)
            pairs[r->id[v] >> r->shift]++;
}

/* Where each slice's pairs of each part go. */
static void lay_out(struct renumbering *r)
{
    uint32_t at = 0;
    for (uint32_t part = 0; part < MOST_PARTS; part++) {
        r->start[part] = at;
        for (unsigned slice = 0; slice < r->slices; slice++) {
            uint32_t pairs = r->at[slice][part];
            r->at[slice][part] = at;
            at += pairs;
        }
    }
    r->start[MOST_PARTS] = at;
}

static void deal(void *arg, unsigned slice)
{
    struct renumbering *r = arg;
    struct pair *pair = r->pair;
    uint32_t *next = r->at[slice];
    for (struct dt_piece at = before_slice(r, slice); next_piece(r, &r->stop, slice, &at);)
        for (uint32_t v = at.a; v < at.b; v++)
            pair[next[r->id[v] >> r->shift]++] = (struct pair){r->id[v], v};
}

static void settle_part(void *arg, unsigned part)
{
    const struct renumbering *r = arg;
    if (dt_stopped(r->late))
        return;
    for (uint32_t i = r->start[part]; i < r->start[part + 1]; i++)
        *dt_idmap_at(&r->p->value, r->pair[i].id) = r->pair[i].v;
}

static void settle_in_parts(struct renumbering *r, const struct dt_pool *pool)
{
    r->pair = dt_array_new_in(r->p->pages, r->n, sizeof *r->pair);
    if (r->pair == NULL) {
        dt_stop_because(&r->stop, DT_NOMEM);
        return;
    }
    r->shift = PART_BITS;
    while ((r->p->value.pages * (uint64_t)DT_ID_PAGE - 1) >> r->shift >= MOST_PARTS)
        r->shift++;
    dt_run(pool, r->slices, count, r);
    if (!dt_stopped(&r->stop)) {
        lay_out(r);
        dt_run(pool, r->slices, deal, r);
    }
    if (!dt_stopped(&r->stop))
        dt_run(pool, MOST_PARTS, settle_part, r);
    dt_array_free(r->pair);
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

enum dt_status dt_points_renumber(struct dt_points *p, struct dt_point *xy, uint32_t *id,
                                  uint32_t n, const struct dt_options *opt)
{
    const struct dt_pool *pool = opt == NULL ? NULL : opt->pool;
    struct renumbering r;
    r.p = p;
    r.stop = dt_stop_of(opt);
    r.late = opt != NULL && opt->disposable ? &r.stop : NULL;
    r.id = id;
    r.n = n;
    r.slices = dt_threads_for(pool, n);
    if (n >= MANY)
        settle_in_parts(&r, pool);
    else
        dt_run(pool, r.slices, settle_slice, &r);
    if (dt_stop_status(&r.stop) == DT_OK)
        settle_groups(p, r.late);
    if (dt_stop_status(&r.stop) != DT_OK)
        return dt_stop_status(&r.stop);
    dt_array_free(p->xy);
    dt_array_free(p->id);
    p->xy = xy;
    p->id = id;
    p->end = p->cap = n;
    p->free_count = 0;
    p->free_list = DT_NONE;
    dt_points_unplan(p);
    dt_places_clear(&p->places);
    return DT_OK;
}
