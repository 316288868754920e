/* arrivals.c - see arrivals.h.
 *
 *     items    0 1 2 ... end-1 | end ... end+n-1      the vertices, then the arrivals in order
 *     sorted   as for a build (divide.h), so that equal points are neighbours; the smallest of equal items stays,
 *              and all that stay become the vertices of the set in this order
 *     same     for an item that does not stay: the item that it coincides with
 *
 * So the set has the plan of a build. The result does not depend on the number of threads. */
#include "core/edit/arrivals.h"

#include "core/control/parallel.h"
#include "core/divide/divide.h"
#include "core/memory/memory.h"

enum {
    FEW = 4096,    /* arrivals that are looked up one by one instead of sorted */
    FEW_FIRST = 64 /* the same in an empty set */
};

struct arrivals {
    struct dt_points *p;
    const struct dt_point *q;
    uint32_t end, n;        /* vertices and arrivals */
    uint32_t stay;          /* items that are vertices in the end */
    struct dt_named sorted; /* items; later the new vertices; in the end the old ones */
    struct dt_named spare;  /* p also holds spare.from and plan.same */
    struct dt_plan plan;
    struct dt_options opt;
    struct dt_stop stop;
};

/* ---- sorting ---- */

static enum dt_status allocate(struct arrivals *a)
{
    struct dt_pages *pages = a->p->pages;
    size_t items = (size_t)a->end + a->n;
    a->sorted.p = dt_array_new_in(pages, items, sizeof *a->sorted.p);
    a->sorted.from = dt_array_new_in(pages, items, sizeof *a->sorted.from);
    a->plan.step = dt_array_new_in(pages, items, sizeof *a->plan.step);
    a->spare.p = dt_array_new_in(pages, items, sizeof *a->spare.p + 2 * sizeof(uint32_t));
    if (a->sorted.p == NULL || a->sorted.from == NULL || a->plan.step == NULL || a->spare.p == NULL)
        return DT_NOMEM;
    a->spare.from = (uint32_t *)(a->spare.p + items);
    a->plan.same = a->spare.from + items;
    return DT_OK;
}

static void free_arrays(struct arrivals *a)
{
    dt_array_free(a->sorted.p);
    dt_array_free(a->sorted.from);
    dt_array_free(a->spare.p);
    dt_array_free(a->plan.step);
}

/* The items as one array: where there are vertices and arrivals, they are copied to the spare points. */
static struct dt_source gather(struct arrivals *a)
{
    if (a->end == 0 || a->n == 0)
        return (struct dt_source){a->n == 0 ? a->p->xy : a->q, NULL};
    dt_copy(a->spare.p, a->p->xy, a->end, sizeof *a->q, &a->stop);
    dt_copy(a->spare.p + a->end, a->q, a->n, sizeof *a->q, &a->stop);
    for (struct dt_piece at = dt_pieces(0, a->end + a->n); dt_next_piece(&a->stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            a->spare.from[i] = i;
    return (struct dt_source){a->spare.p, a->spare.from};
}

static enum dt_status sort(struct arrivals *a)
{
    struct dt_source in = gather(a);
    if (dt_stopped(&a->stop))
        return dt_stop_status(&a->stop);
    return dt_divide_sort(in, a->end + a->n, a->sorted, a->spare, a->plan, a->p->pages, &a->opt);
}

/* The id of the item's point: the old id of an earlier point, or the next id of a new one. */
static uint32_t id_of(const struct arrivals *a, const uint32_t *old_id, uint32_t item)
{
    return item < a->end ? old_id[item] : a->p->next_id + (item - a->end);
}

/* Releases the bytes that an array of n items does not need. */
static void *fit(struct arrivals *a, void *array, uint32_t n, size_t size)
{
    void *fitting = dt_array_grow_in(a->p->pages, array, n, n, size);
    return fitting == NULL ? array : fitting;
}

/* Leaves out points that coincide with others, and replaces items by ids. */
static enum dt_status close_ranks(struct arrivals *a)
{
    struct dt_point *xy = a->sorted.p;
    uint32_t *name = a->sorted.from, v = 0;
    uint16_t *step = a->plan.step;
    for (struct dt_piece at = dt_pieces(0, a->end + a->n); dt_next_piece(&a->stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            bool left_out = name[i] & DT_COINCIDENT;
            if (step[i] != 0 && (v < i || left_out))
                dt_plan_move(step, i, v, left_out);
            if (left_out)
                continue;
            xy[v] = xy[i];
            name[v++] = id_of(a, a->p->id, name[i]);
        }
    a->stay = v;
    if (v < a->end + a->n) {
        a->sorted.p = fit(a, a->sorted.p, v, sizeof *xy);
        a->sorted.from = fit(a, a->sorted.from, v, sizeof *name);
    }
    return dt_stop_status(&a->stop);
}

/* ---- ids and aliases ---- */

/* The id of the representative with which arrival i coincides. */
static uint32_t representative(const struct arrivals *a, uint32_t i)
{
    return id_of(a, a->sorted.from, a->plan.same[a->end + i]);
}

/* Whether arrival i, which may be beyond the last one, has no vertex and is no alias yet. */
static bool is_left(const struct arrivals *a, uint32_t i)
{
    return i < a->n && dt_idmap_get(&a->p->value, a->p->next_id + i) == DT_NONE;
}

static enum dt_status make_alias(struct arrivals *a, uint32_t i)
{
    enum { AHEAD = 16 }; /* arrivals; long enough for a cache miss */
    struct dt_points *p = a->p;
    uint32_t later = i + 2 * AHEAD, soon = i + AHEAD;
    if (is_left(a, later))
        dt_idmap_fetch(&p->value, representative(a, later));
    uint32_t v = is_left(a, soon) ? dt_idmap_get(&p->value, representative(a, soon)) : DT_NONE;
    if (v < p->group_cap)
        dt_fetch(&p->group[v]);
    struct dt_point at = {a->q[i].x + 0.0, a->q[i].y + 0.0}; /* -0 becomes 0 */
    return dt_points_join(p, p->next_id + i, at, dt_idmap_get(&p->value, representative(a, i)));
}

static enum dt_status make_aliases(struct arrivals *a)
{
    enum dt_status status = DT_OK;
    if (a->stay == a->end + a->n)
        return DT_OK;
    for (uint32_t i = 0; i < a->n && status == DT_OK; i++) {
        if (is_left(a, i))
            status = make_alias(a, i);
        if (i % DT_POLL_MISSES == 0 && dt_stopped(&a->stop))
            status = dt_stop_status(&a->stop);
    }
    return status;
}

/* ---- all of it ---- */

bool dt_arrivals_suit(const struct dt_points *p, size_t n)
{
    return p->tol == 0 && p->free_count == 0 && n >= (p->end == 0 ? FEW_FIRST : FEW) && n >= p->end;
}

/* The sorted points become the set's vertices, and the others aliases. */
static enum dt_status install(struct arrivals *a)
{
    struct dt_points *p = a->p;
    enum dt_status status = dt_points_renumber(p, &a->sorted.p, &a->sorted.from, a->stay, &a->opt);
    if (status != DT_OK)
        return status;
    dt_idmap_count(&p->value, p->next_id, a->n);
    status = make_aliases(a);
    if (status != DT_OK) { /* as it was: this takes no memory */
        dt_points_take_back(p, a->n);
        dt_points_renumber(p, &a->sorted.p, &a->sorted.from, a->end, NULL);
        return status;
    }
    dt_points_arrived(p, a->n);
    p->plan = a->plan.step;
    a->plan.step = NULL;
    return DT_OK;
}

/* Adds n points, for which there are ids, to a set without free vertices. */
static enum dt_status add_sorted(struct dt_points *p, const struct dt_point *q, uint32_t n,
                                 const struct dt_options *opt, struct dt_added *out)
{
    struct arrivals a = {.p = p, .q = q, .end = p->end, .n = n, .stop = dt_stop_of(opt)};
    if (opt != NULL)
        a.opt = *opt;
    struct dt_added done = {.first = p->next_id, .added = n};
    enum dt_status status = allocate(&a);
    if (status == DT_OK)
        status = sort(&a);
    if (status == DT_OK)
        status = close_ranks(&a);
    if (status == DT_OK && n == 0 && a.stay < a.end)
        status = DT_CORRUPT;
    if (status == DT_OK)
        status = install(&a);
    if (status == DT_OK) {
        done.coincident = a.end + n - a.stay;
        *out = done;
    }
    free_arrays(&a);
    return status;
}

enum dt_status dt_arrivals_add(struct dt_points *p, const struct dt_point *q, size_t n,
                               const struct dt_options *opt, struct dt_added *out)
{
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status status = dt_work(&work, 2 * ((uint64_t)p->end + n));
    if (status == DT_OK)
        status = dt_points_reserve_ids(p, n);
    return status == DT_OK ? add_sorted(p, q, (uint32_t)n, opt, out) : status;
}

enum dt_status dt_arrivals_sort(struct dt_points *p, const struct dt_options *opt)
{
    struct dt_added none;
    return p->end == 0 ? DT_OK : add_sorted(p, NULL, 0, opt, &none);
}
