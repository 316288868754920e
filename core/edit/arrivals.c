/* arrivals.c - see arrivals.h.
 *
 *     items    0 1 2 ... end-1 | end ... end+n-1      the vertices, then the arrivals in order
 *     sorted   as for a build (divide.h), so that equal points are neighbours
 *     place    of each item among the sorted, or DT_COINCIDENT and the smallest item that it coincides with
 *
 * An arrival that coincides with none before it becomes a vertex: in the sorted order if there have been no
 * vertices, with the plan of the build, else in order of arrival. The result does not depend on the number of
 * threads. */
#include "core/edit/arrivals.h"

#include "core/control/parallel.h"
#include "core/divide/divide.h"
#include "core/memory/memory.h"
#include "core/points/renumber.h"

enum {
    FEW = 4096,    /* arrivals that are looked up one by one instead of sorted */
    FEW_FIRST = 64 /* the same in an empty set */
};

struct arrivals {
    struct dt_points *p;
    const struct dt_point *q;
    uint32_t end, n;        /* vertices and arrivals */
    struct dt_named sorted; /* the set's own arrays if end = 0 */
    struct dt_named spare;
    uint32_t *place; /* by item; the sort writes those of items that coincide */
    struct dt_plan plan;
    uint32_t fresh[DT_MAX_THREADS]; /* arrivals that become vertices, by slice */
    unsigned slices;
    struct dt_options opt;
    struct dt_stop stop;
};

static struct dt_piece slice_of(const struct arrivals *a, unsigned slice)
{
    return dt_slice_pieces(a->n, slice, a->slices);
}

/* A pass over all slices. Its result is undefined unless DT_OK. */
static enum dt_status pass(struct arrivals *a, void (*job)(void *arg, unsigned slice))
{
    dt_run(a->opt.pool, a->slices, job, a);
    return dt_stop_status(&a->stop);
}

/* ---- which coincide ---- */

/* The vertices and the arrivals become the spare points. */
static struct dt_source gather(struct arrivals *a)
{
    dt_copy(a->spare.p, a->p->xy, a->end, sizeof *a->q, &a->stop);
    dt_copy(a->spare.p + a->end, a->q, a->n, sizeof *a->q, &a->stop);
    for (struct dt_piece at = dt_pieces(0, a->end + a->n); dt_next_piece(&a->stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            a->spare.from[i] = i;
    return (struct dt_source){a->spare.p, a->spare.from};
}

static enum dt_status allocate(struct arrivals *a)
{
    struct dt_pages *pages = a->p->pages;
    size_t items = (size_t)a->end + a->n;
    a->spare.p = dt_array_new_in(pages, items, sizeof *a->spare.p);
    a->spare.from = dt_array_new_in(pages, items, sizeof *a->spare.from);
    a->place = dt_array_new_in(pages, items, sizeof *a->place);
    a->plan.step = dt_array_new_in(pages, items, sizeof *a->plan.step);
    if (a->sorted.p == NULL) {
        a->sorted.p = dt_array_new_in(pages, items, sizeof *a->sorted.p);
        a->sorted.from = dt_array_new_in(pages, items, sizeof *a->sorted.from);
    }
    bool ok = a->spare.p != NULL && a->spare.from != NULL && a->place != NULL &&
              a->plan.step != NULL && a->sorted.p != NULL && a->sorted.from != NULL;
    return ok ? DT_OK : DT_NOMEM;
}

static void free_arrays(struct arrivals *a)
{
    if (a->sorted.p != a->p->xy)
        dt_array_free(a->sorted.p);
    if (a->sorted.from != a->p->id)
        dt_array_free(a->sorted.from);
    dt_array_free(a->spare.p);
    dt_array_free(a->spare.from);
    dt_array_free(a->place);
    dt_array_free(a->plan.step);
}

/* Sorts the items and finds out which coincide. */
static enum dt_status sort(struct arrivals *a)
{
    uint32_t items = a->end + a->n;
    struct dt_source in = {a->q, NULL};
    if (a->end > 0)
        in = gather(a);
    if (dt_stopped(&a->stop))
        return dt_stop_status(&a->stop);
    a->plan.same = a->place;
    return dt_divide_sort(in, items, a->sorted, a->spare, a->plan, a->p->pages, &a->opt);
}

/* A pass of its own: among the stores of a sort, those that miss the cache would hold up the others. */
static void note_places(void *arg, unsigned slice)
{
    struct arrivals *a = arg;
    uint32_t items = a->end + a->n;
    const uint32_t *from = a->sorted.from;
    for (struct dt_piece at = dt_slice_pieces(items, slice, a->slices);
         dt_next_piece(&a->stop, &at);)
        for (uint32_t v = at.a; v < at.b; v++) {
            uint32_t item = from[v] & ~DT_COINCIDENT;
            if (item == from[v])
                a->place[item] = v;
            else
                a->place[item] |= DT_COINCIDENT;
        }
}

/* The item that item i coincides with, DT_NONE if there is none before it. */
static uint32_t same(const struct arrivals *a, uint32_t i)
{
    uint32_t place = a->place[i];
    return place & DT_COINCIDENT ? place & ~DT_COINCIDENT : DT_NONE;
}

static void count_fresh(void *arg, unsigned slice)
{
    struct arrivals *a = arg;
    uint32_t fresh = 0;
    for (struct dt_piece at = slice_of(a, slice); dt_next_piece(&a->stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            fresh += same(a, a->end + i) == DT_NONE;
    a->fresh[slice] = fresh;
}

/* ---- vertices ---- */

/* In order of arrival. */
static void enter(void *arg, unsigned slice)
{
    struct arrivals *a = arg;
    struct dt_points *p = a->p;
    uint32_t v = a->end;
    for (unsigned before = 0; before < slice; before++)
        v += a->fresh[before];
    for (struct dt_piece at = slice_of(a, slice); dt_next_piece(&a->stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            if (same(a, a->end + i) != DT_NONE)
                continue;
            p->xy[v] = (struct dt_point){a->q[i].x + 0.0, a->q[i].y + 0.0}; /* -0 becomes 0 */
            p->id[v] = p->next_id + i;
            a->place[a->end + i] = v++;
        }
}

/* As they are sorted: those that coincide with others are left out. */
static void close_ranks(struct arrivals *a)
{
    struct dt_points *p = a->p;
    uint32_t v = 0;
    for (struct dt_piece at = dt_pieces(0, a->n); dt_next_piece(&a->stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            uint32_t item = p->id[i];
            uint16_t step = a->plan.step[i];
            a->plan.step[i] = 0;
            if (step != 0)
                a->plan.step[v] = step;
            if (item & DT_COINCIDENT)
                continue;
            p->xy[v] = p->xy[i];
            p->id[v] = p->next_id + item;
            a->place[item] = v++;
        }
}

static enum dt_status make_vertices(struct arrivals *a)
{
    struct dt_points *p = a->p;
    p->end = a->end;
    for (unsigned slice = 0; slice < a->slices; slice++)
        p->end += a->fresh[slice];
    if (a->end > 0)
        return pass(a, enter);
    if (p->end < a->n || p->next_id > 0)
        close_ranks(a);
    return dt_stop_status(&a->stop);
}

/* ---- ids and aliases ---- */

/* The id of the representative with which arrival i coincides. */
static uint32_t representative(const struct arrivals *a, uint32_t i)
{
    uint32_t first = same(a, a->end + i);
    return first < a->end ? a->p->id[first] : a->p->next_id + (first - a->end);
}

static bool is_alias(const struct arrivals *a, uint32_t i)
{
    return i < a->n && same(a, a->end + i) != DT_NONE;
}

static enum dt_status make_alias(struct arrivals *a, uint32_t i)
{
    enum { AHEAD = 16 }; /* arrivals; long enough for a cache miss */
    struct dt_points *p = a->p;
    uint32_t later = i + 2 * AHEAD, soon = i + AHEAD;
    if (is_alias(a, later))
        dt_idmap_fetch(&p->value, representative(a, later));
    uint32_t v = is_alias(a, soon) ? dt_idmap_get(&p->value, representative(a, soon)) : DT_NONE;
    if (v < p->group_cap)
        dt_fetch(&p->group[v]);
    struct dt_point at = {a->q[i].x + 0.0, a->q[i].y + 0.0};
    return dt_points_join(p, p->next_id + i, at, dt_idmap_get(&p->value, representative(a, i)));
}

static void name_vertices(struct arrivals *a, struct dt_piece at)
{
    const uint32_t *vertex = a->place + a->end;
    for (uint32_t i = at.a, run; i < at.b; i += run) {
        for (run = 0; i + run < at.b && !is_alias(a, i + run);)
            run++;
        dt_idmap_set_run(&a->p->value, a->p->next_id + i, vertex + i, run);
        run += i + run < at.b;
    }
}

/* Gives each arrival its vertex, or makes it an alias. */
static enum dt_status name(struct arrivals *a)
{
    struct dt_points *p = a->p;
    enum dt_status status = DT_OK;
    for (struct dt_piece at = dt_pieces(0, a->n); dt_next_piece(&a->stop, &at);)
        name_vertices(a, at);
    for (uint32_t i = 0; p->end - a->end < a->n && i < a->n && status == DT_OK; i++) {
        if (is_alias(a, i))
            status = make_alias(a, i);
        if (i % DT_POLL_MISSES == 0 && dt_stopped(&a->stop))
            status = dt_stop_status(&a->stop);
    }
    if (status == DT_OK)
        status = dt_stop_status(&a->stop);
    if (status != DT_OK)
        dt_points_take_back(p, a->n);
    return status;
}

/* ---- all of it ---- */

bool dt_arrivals_suit(const struct dt_points *p, size_t n)
{
    return p->tol == 0 && p->free_count == 0 && n >= (p->end == 0 ? FEW_FIRST : FEW) && n >= p->end;
}

/* The set gets the plan if its vertices are in that order. */
static void keep_plan(struct arrivals *a)
{
    if (a->end > 0)
        return;
    a->p->plan = a->plan.step;
    a->plan.step = NULL;
}

/* Adds n > 0 points for which there is room; the table of places must be empty. */
static enum dt_status add_sorted(struct dt_points *p, const struct dt_point *q, uint32_t n,
                                 const struct dt_pool *pool, struct dt_work *work,
                                 struct dt_added *out)
{
    struct arrivals a = {.p = p, .q = q, .end = p->end, .n = n};
    a.opt = (struct dt_options){.pool = pool, .cancel = work == NULL ? NULL : work->cancel};
    a.stop = dt_stop_of(&a.opt);
    a.slices = dt_threads_for(pool, n);
    if (p->end == 0)
        a.sorted = (struct dt_named){p->xy, p->id};
    enum dt_status status = dt_work(work, 2 * ((uint64_t)a.end + n));
    if (status == DT_OK)
        status = allocate(&a);
    if (status == DT_OK)
        status = sort(&a);
    if (status == DT_OK)
        status = pass(&a, note_places);
    if (status == DT_OK)
        status = pass(&a, count_fresh);
    if (status == DT_OK)
        status = make_vertices(&a);
    if (status == DT_OK)
        status = name(&a);
    if (status == DT_OK) {
        *out = (struct dt_added){p->next_id, n, n - (p->end - a.end)};
        dt_points_arrived(p, n);
        dt_points_unplan(p);
        keep_plan(&a);
    } else {
        p->end = a.end; /* no vertex was free before (dt_arrivals_suit) */
        p->free_count = 0;
        p->free_list = DT_NONE;
    }
    free_arrays(&a);
    return status;
}

enum dt_status dt_arrivals_add(struct dt_points *p, const struct dt_point *q, size_t n,
                               const struct dt_pool *pool, struct dt_work *work,
                               struct dt_added *out)
{
    if (!dt_arrivals_suit(p, n))
        return dt_points_add(p, q, n, work, out);
    dt_places_clear(&p->places); /* built again when needed, which may be never */
    enum dt_status status = dt_points_reserve(p, n, work);
    return status == DT_OK ? add_sorted(p, q, (uint32_t)n, pool, work, out) : status;
}

enum dt_status dt_arrivals_sort(struct dt_points *p, const struct dt_options *opt)
{
    struct arrivals a = {.p = p, .q = p->xy, .n = p->end};
    a.opt = (struct dt_options){.pool = opt == NULL ? NULL : opt->pool,
                                .cancel = opt == NULL ? NULL : opt->cancel};
    a.stop = dt_stop_of(&a.opt);
    a.slices = dt_threads_for(a.opt.pool, a.n);
    enum dt_status status = a.n == 0 ? DT_OK : allocate(&a);
    if (status == DT_OK && a.n > 0)
        status = sort(&a);
    for (struct dt_piece at = dt_pieces(0, a.n); dt_next_piece(&a.stop, &at);)
        for (uint32_t v = at.a; v < at.b && status == DT_OK; v++)
            if (a.sorted.from[v] & DT_COINCIDENT)
                status = DT_CORRUPT;
            else
                a.sorted.from[v] = p->id[a.sorted.from[v]];
    if (status == DT_OK)
        status = dt_stop_status(&a.stop);
    if (status == DT_OK && a.n > 0)
        status = dt_points_renumber(p, a.sorted.p, a.sorted.from, a.n, &a.opt);
    if (status == DT_OK && a.n > 0)
        keep_plan(&a);
    free_arrays(&a);
    return status;
}
