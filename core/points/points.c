/* points.c - arrival, coincidence and departure of points.
 *
 * Invariants:
 * 1. A live id has a value, a vertex or an alias.
 * 2. id[] of a vertex in use is its representative, whose value is that vertex.
 * 3. group[] of a vertex is a root, and the representative of the root is id[].
 * 4. With tolerance 0 a representative has the smallest id of all points at its place. */
#include "core/points/points.h"

#include "core/control/parallel.h"
#include "core/memory/memory.h"

void dt_points_init(struct dt_points *p, double tol, struct dt_pages *pages)
{
    *p = (struct dt_points){.pages = pages,
                            .tol = tol,
                            .free_list = DT_NONE,
                            .value = {.keeper = pages},
                            .places = {.pages = pages}};
    dt_aliases_init(&p->aliases, pages);
}

void dt_points_unplan(struct dt_points *p)
{
    dt_array_free(p->plan);
    p->plan = NULL;
}

void dt_points_clear(struct dt_points *p)
{
    dt_points_unplan(p);
    dt_array_free(p->xy);
    dt_array_free(p->id);
    dt_array_free(p->group);
    dt_idmap_clear(&p->value);
    dt_aliases_clear(&p->aliases);
    dt_places_clear(&p->places);
    dt_points_init(p, p->tol, p->pages);
}

/* The root of the aliases of vertex v, DT_NONE if it has none. */
static uint32_t group_of(const struct dt_points *p, uint32_t v)
{
    return p->group == NULL ? DT_NONE : p->group[v];
}

/* Makes room in group[] for n vertices. */
static enum dt_status reserve_groups(struct dt_points *p, uint32_t n)
{
    if (n <= p->group_cap)
        return DT_OK;
    if (!dt_array_resize(p->pages, &p->group, p->group_cap, n, sizeof *p->group))
        return DT_NOMEM;
    for (; p->group_cap < n; p->group_cap++)
        p->group[p->group_cap] = DT_NONE;
    return DT_OK;
}

enum dt_status dt_points_copy(const struct dt_points *p, struct dt_points *copy,
                              struct dt_stop *stop)
{
    dt_points_init(copy, p->tol, p->pages);
    copy->xy = dt_array_new_in(p->pages, p->end, sizeof *p->xy);
    copy->id = dt_array_new_in(p->pages, p->end, sizeof *p->id);
    if (p->plan != NULL)
        copy->plan = dt_array_new_in(p->pages, p->end, sizeof *p->plan);
    if (copy->xy == NULL || copy->id == NULL || (p->plan != NULL && copy->plan == NULL) ||
        dt_idmap_copy(&p->value, &copy->value, stop) != DT_OK ||
        dt_aliases_copy(&p->aliases, &copy->aliases, stop) != DT_OK) {
        dt_points_clear(copy);
        return DT_NOMEM;
    }
    copy->cap = p->end;
    if (p->group != NULL && reserve_groups(copy, copy->cap) != DT_OK) {
        dt_points_clear(copy);
        return DT_NOMEM;
    }
    dt_copy(copy->xy, p->xy, p->end, sizeof *p->xy, stop);
    dt_copy(copy->id, p->id, p->end, sizeof *p->id, stop);
    if (p->plan != NULL)
        dt_copy(copy->plan, p->plan, p->end, sizeof *p->plan, stop);
    if (p->group != NULL)
        dt_copy(copy->group, p->group, p->end, sizeof *p->group, stop);
    copy->end = p->end;
    copy->free_count = p->free_count;
    copy->free_list = p->free_list;
    copy->next_id = p->next_id;
    return DT_OK; /* places are built when first needed */
}

size_t dt_points_memory(const struct dt_points *p)
{
    size_t places = p->places.bucket == NULL
                        ? 0
                        : ((size_t)p->places.mask + 1 + p->places.cap) * sizeof(uint32_t);
    return p->cap * (sizeof *p->xy + sizeof *p->id) + p->group_cap * sizeof *p->group +
           (p->plan == NULL ? 0 : p->end * sizeof *p->plan) + dt_idmap_memory(&p->value) +
           dt_aliases_memory(&p->aliases) + places;
}

struct dt_point dt_points_xy(const struct dt_points *p, uint32_t id)
{
    uint32_t v = dt_idmap_get(&p->value, id);
    return v & DT_ALIAS_BIT ? p->aliases.alias[v & ~DT_ALIAS_BIT].xy : p->xy[v];
}

/* ---- vertices ---- */

/* Makes room for n more vertices in every array. */
static enum dt_status reserve_vertices(struct dt_points *p, size_t n, struct dt_stop *work)
{
    size_t need = p->end + (n > p->free_count ? n - p->free_count : 0);
    if (need > DT_MAX_POINTS)
        return DT_TOOBIG;
    if (need > p->cap) {
        /* A first batch gets exactly what it needs, so that sets that are loaded once waste no memory. */
        size_t cap = p->cap == 0 ? need : dt_array_room(p->cap, need, DT_MAX_POINTS);
        if (!dt_array_resize(p->pages, &p->xy, p->end, cap, sizeof *p->xy))
            return DT_NOMEM;
        if (!dt_array_resize(p->pages, &p->id, p->end, cap, sizeof *p->id))
            return DT_NOMEM;
        p->cap = (uint32_t)cap;
    }
    if (p->group != NULL && reserve_groups(p, p->cap) != DT_OK)
        return DT_NOMEM;
    return p->places.bucket == NULL
               ? DT_OK
               : dt_places_reserve(&p->places, p->tol, p->xy, p->id, p->end, (uint32_t)need, work);
}

enum dt_status dt_points_index(struct dt_points *p, struct dt_stop *work)
{
    return dt_places_reserve(&p->places, p->tol, p->xy, p->id, p->end, p->cap, work);
}

uint32_t dt_points_find(const struct dt_points *p, struct dt_point q, uint32_t except)
{
    return dt_places_find(&p->places, p->xy, p->id, q, except);
}

uint32_t dt_points_enter(struct dt_points *p, uint32_t id, struct dt_point q)
{
    dt_points_unplan(p);
    uint32_t v = p->free_list;
    if (v != DT_NONE) {
        p->free_list = (uint32_t)p->xy[v].x;
        p->free_count--;
        if (p->free_list != DT_NONE) { /* for the next one */
            dt_fetch(&p->xy[p->free_list]);
            dt_fetch(&p->id[p->free_list]);
        }
    } else {
        v = p->end++;
    }
    p->xy[v] = q;
    p->id[v] = id;
    dt_idmap_set(&p->value, id, v);
    if (p->places.bucket != NULL)
        dt_places_enter(&p->places, p->xy, v);
    return v;
}

static void free_vertex(struct dt_points *p, uint32_t v)
{
    dt_points_unplan(p);
    if (p->places.bucket != NULL)
        dt_places_leave(&p->places, p->xy, v);
    p->id[v] = DT_NONE;
    p->xy[v].x = p->free_list; /* exact: a 32-bit number */
    p->free_list = v;
    p->free_count++;
}

/* The point id at q takes over vertex v, and its group if it has one. */
static void take_over(struct dt_points *p, uint32_t v, uint32_t id, struct dt_point q)
{
    bool moves = p->xy[v].x != q.x || p->xy[v].y != q.y;
    bool entered = p->places.bucket != NULL;
    if (p->id[v] != id)
        dt_changes_name(p->changes, v);
    if (p->id[v] != id && group_of(p, v) != DT_NONE)
        dt_aliases_rename(&p->aliases, group_of(p, v), id);
    if (moves)
        dt_points_unplan(p);
    if (moves && entered)
        dt_places_leave(&p->places, p->xy, v);
    p->xy[v] = q;
    p->id[v] = id;
    dt_idmap_set(&p->value, id, v);
    if (moves && entered)
        dt_places_enter(&p->places, p->xy, v);
}

/* ---- aliases ---- */

/* Makes room for one more alias of any vertex. */
static enum dt_status reserve_alias(struct dt_points *p)
{
    enum dt_status status = dt_aliases_reserve(&p->aliases);
    return status == DT_OK ? reserve_groups(p, p->cap) : status;
}

/* The point id at q becomes an alias of vertex v. There is room. */
static void become_alias(struct dt_points *p, uint32_t id, struct dt_point q, uint32_t v)
{
    if (p->group[v] == DT_NONE)
        p->group[v] = dt_aliases_new_group(&p->aliases, p->id[v]);
    dt_idmap_set(&p->value, id, DT_ALIAS_BIT | dt_aliases_join(&p->aliases, p->group[v], id, q));
}

void dt_points_leave_group(struct dt_points *p, uint32_t index)
{
    uint32_t representative = dt_aliases_leave(&p->aliases, index);
    if (representative != DT_NONE)
        p->group[dt_idmap_get(&p->value, representative)] = DT_NONE;
}

/* ---- adding ---- */

enum dt_status dt_points_reserve_ids(struct dt_points *p, size_t n)
{
    if (n > DT_MAX_POINTS - dt_points_live(p) || n > DT_NONE - p->next_id)
        return DT_TOOBIG;
    dt_idmap_trim(&p->value);
    return dt_idmap_reserve(&p->value, p->next_id, n);
}

enum dt_status dt_points_reserve(struct dt_points *p, size_t n, struct dt_stop *work)
{
    enum dt_status status = dt_points_reserve_ids(p, n);
    return status == DT_OK ? reserve_vertices(p, n, work) : status;
}

enum dt_status dt_points_join(struct dt_points *p, uint32_t id, struct dt_point q, uint32_t v)
{
    enum dt_status status = reserve_alias(p);
    if (status == DT_OK)
        become_alias(p, id, q, v);
    return status;
}

void dt_points_arrived(struct dt_points *p, uint32_t n)
{
    p->next_id += n;
}

void dt_points_take_back(struct dt_points *p, uint32_t n)
{
    for (uint32_t id = p->next_id + n; id-- > p->next_id;) {
        uint32_t v = dt_idmap_get(&p->value, id);
        if (v == DT_NONE)
            continue;
        dt_idmap_unset(&p->value, id);
        if (v & DT_ALIAS_BIT)
            dt_points_leave_group(p, v & ~DT_ALIAS_BIT);
        else
            free_vertex(p, v);
    }
}

/* ---- deleting ---- */

const struct dt_alias *dt_points_heir(const struct dt_points *p, uint32_t v, const uint32_t *ids,
                                      size_t n)
{
    uint32_t root = group_of(p, v);
    uint32_t i = root == DT_NONE ? DT_NONE : dt_aliases_lowest_but(&p->aliases, root, ids, n);
    return i == DT_NONE ? NULL : &p->aliases.alias[i];
}

enum dt_status dt_points_delete_ready(struct dt_points *p, const uint32_t *ids, size_t n,
                                      struct dt_stop *work)
{
    bool heirs = false;
    dt_idmap_trim(&p->value);
    for (size_t i = 0; p->tol > 0 && p->aliases.count > 0 && !heirs && i < n; i++) {
        uint32_t v = dt_idmap_get(&p->value, ids[i]);
        heirs = !(v & DT_ALIAS_BIT) && group_of(p, v) != DT_NONE;
    }
    return heirs ? dt_points_index(p, work)
                 : DT_OK; /* successors check whether their place is occupied */
}

/* The aliases of vertex `from`, which has some, become aliases of vertex `to`. */
static void move_family(struct dt_points *p, uint32_t from, uint32_t to)
{
    if (p->group[to] == DT_NONE) {
        dt_aliases_rename(&p->aliases, p->group[from], p->id[to]);
        p->group[to] = p->group[from];
    } else {
        p->group[to] = dt_aliases_unite(&p->aliases, p->group[from], p->group[to]);
    }
    p->group[from] = DT_NONE;
}

/* The alias `index` of vertex v represents it from now on, and v is at its place. */
static void succeed(struct dt_points *p, uint32_t v, uint32_t index)
{
    struct dt_alias next = p->aliases.alias[index];
    dt_changes_row(p->changes, next.id);
    dt_points_leave_group(p, index);
    take_over(p, v, next.id, next.xy);
}

/* The same, where the alias is at the place of v, whose representative becomes an alias. */
static void promote(struct dt_points *p, uint32_t v, uint32_t index)
{
    uint32_t old = p->id[v];
    dt_changes_row(p->changes, old);
    succeed(p, v, index);
    become_alias(p, old, p->xy[v], v);
}

/* The successor of v's representative, the alias `index`, is at the place of another vertex `at`: the smaller
 * id of the two represents both groups. */
static void unite(struct dt_points *p, uint32_t v, uint32_t at, uint32_t index)
{
    move_family(p, v, at);
    if (p->aliases.alias[index].id < p->id[at])
        promote(p, at, index);
    free_vertex(p, v);
}

/* The representative of vertex v is deleted: its lowest alias takes over, or the vertex becomes free. */
static void vacate(struct dt_points *p, uint32_t v)
{
    uint32_t root = group_of(p, v);
    if (root == DT_NONE) {
        free_vertex(p, v);
        return;
    }
    uint32_t i = p->aliases.group[root].lowest;
    struct dt_point to = p->aliases.alias[i].xy;
    uint32_t at = p->tol > 0 ? dt_points_find(p, to, v) : DT_NONE;
    if (at != DT_NONE && p->xy[at].x == to.x && p->xy[at].y == to.y)
        unite(p, v, at, i);
    else
        succeed(p, v, i);
}

void dt_points_delete(struct dt_points *p, uint32_t id)
{
    uint32_t v = dt_idmap_get(&p->value, id);
    dt_changes_row(p->changes, id);
    if (v & DT_ALIAS_BIT)
        dt_points_leave_group(p, v & ~DT_ALIAS_BIT);
    else
        vacate(p, v);
    dt_idmap_unset(&p->value, id);
}

/* Prefetches the data that the deletion of a point some ids later reads first. */
static void fetch_later(const struct dt_points *p, const uint32_t *ids, size_t n, size_t i)
{
    enum { AHEAD = 16 }; /* points; as long as a cache miss takes */
    if (i + 2 * AHEAD < n)
        dt_idmap_fetch(&p->value, ids[i + 2 * AHEAD]);
    uint32_t v = i + AHEAD < n ? dt_idmap_get(&p->value, ids[i + AHEAD]) : DT_NONE;
    if (v == DT_NONE)
        return;
    if (v & DT_ALIAS_BIT) {
        dt_fetch(&p->aliases.alias[v & ~DT_ALIAS_BIT]);
        return;
    }
    dt_fetch(&p->xy[v]);
    dt_fetch(&p->id[v]);
    if (p->group != NULL)
        dt_fetch(&p->group[v]);
}

void dt_points_delete_all(struct dt_points *p, const uint32_t *ids, size_t n, struct dt_stop *stop)
{
    for (int aliases = p->aliases.count > 0; aliases >= 0; aliases--)
        for (size_t i = 0; i < n && (i % DT_POLL_MISSES != 0 || !dt_stopped(stop)); i++) {
            uint32_t v = dt_idmap_get(&p->value, ids[i]);
            fetch_later(p, ids, n, i);
            if (v != DT_NONE && (!aliases || (v & DT_ALIAS_BIT)))
                dt_points_delete(p, ids[i]);
        }
}

void dt_points_shift(struct dt_points *p, uint32_t v, struct dt_point to)
{
    dt_changes_row(p->changes, p->id[v]);
    take_over(p, v, p->id[v], to);
}

/* ---- moving ---- */

enum dt_status dt_points_move_ready(struct dt_points *p, uint32_t id, struct dt_stop *work)
{
    enum dt_status status = dt_points_delete_ready(p, &id, 1, work);
    if (status == DT_OK)
        status = reserve_vertices(p, 1, work);
    return status == DT_OK ? reserve_alias(p) : status;
}

uint32_t dt_points_arrive(struct dt_points *p, uint32_t id, struct dt_point to, uint32_t at)
{
    if (at == DT_NONE)
        return dt_points_enter(p, id, to);
    become_alias(p, id, to, at);
    if (p->xy[at].x == to.x && p->xy[at].y == to.y && id < p->id[at])
        promote(p, at, dt_idmap_get(&p->value, id) & ~DT_ALIAS_BIT);
    return DT_NONE;
}

/* ---- new numbers ----
 *
 * The vertices in their new order have their ids in any order. So entering the new vertices writes all over the map
 * of ids: the entries of some vertices further on are prefetched. */

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
    if (p->group != NULL && reserve_groups(p, n) != DT_OK)
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
