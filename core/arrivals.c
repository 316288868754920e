/* arrivals.c - see arrivals.h.
 *
 * A hash table of a million points answers each question with cache misses. So the points are first
 * dealt into parts by their hash, equal places into one part, and each part gets a small table of
 * its own, which stays in the cache:
 *
 *      items    0 1 2 ... end-1 | end ... end+n-1      the vertices, then the arrivals in order
 *                    \  \   /  /                       1. count, 2. deal: by slices of items
 *      entries  part 0 | part 1 | part 2 | ...         of a part in order of items
 *                  |       |        |                  3. compare: by parts
 *      same     for each arrival the item it equals, DT_NONE if it is the first at its place
 *                                                      4. enter: by slices of arrivals
 *
 * The first of a place in its part is the representative: a vertex of the set, or else the smallest id.
 * The threads write to places of their own, so their number does not show in the result. */
#include "core/arrivals.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"

enum {
    FEW = 4096,    /* arrivals that are looked up one by one */
    PART = 4096,   /* items of a part at most, while there are not more than MOST_BITS bits */
    MOST_BITS = 11 /* of a part's number: cache lines that are written to in turn */
};

struct entry {
    uint32_t tag; /* another piece of the hash */
    uint32_t item;
};

struct arrivals {
    struct dt_points *p;
    const struct dt_point *q;
    uint32_t end, n; /* vertices and arrivals */
    unsigned bits;   /* 2^bits parts */
    unsigned slices;
    uint64_t seed; /* differs from process to process, so that no input can be aimed at one part */
    uint32_t *at;  /* [slice][part]: how many entries it has, then where the next one goes */
    uint32_t *start; /* [part], and one more: its first entry */
    struct entry *entry;
    uint32_t *same;
    uint32_t *table; /* [slice][2^table_bits]: indices of entries, for one part at a time */
    unsigned table_bits;
    uint32_t fresh[DT_MAX_THREADS]; /* first arrivals at their places, by slice */
    bool crowded[DT_MAX_THREADS];   /* a table has been too small */
    struct dt_stop *stop;
};

/* A slice of n items, in pieces between which it polls. */
static struct dt_piece before_slice(const struct arrivals *a, uint32_t n, unsigned slice)
{
    return dt_before_first(dt_slice(n, slice, a->slices));
}

static bool next_piece(const struct arrivals *a, uint32_t n, unsigned slice, struct dt_piece *at)
{
    return dt_next_piece(a->stop, dt_slice(n, slice + 1, a->slices), at);
}

static uint32_t parts(const struct arrivals *a)
{
    return 1u << a->bits;
}

static struct dt_point place(const struct arrivals *a, uint32_t item)
{
    return item < a->end ? a->p->xy[item] : a->q[item - a->end];
}

static uint64_t hash(const struct arrivals *a, struct dt_point q)
{
    return dt_place_hash(q.x, q.y, a->seed);
}

static uint32_t part_of(const struct arrivals *a, uint64_t h)
{
    return (uint32_t)(h >> 32) >> (32 - a->bits);
}

static uint32_t tag_of(uint64_t h)
{
    return (uint32_t)(h >> (32 - MOST_BITS)); /* the bits after those of the part */
}

/* ---- by slices of items ---- */

static void count(void *arg, unsigned slice)
{
    struct arrivals *a = arg;
    uint32_t *next = a->at + (size_t)slice * parts(a), items = a->end + a->n;
    memset(next, 0, parts(a) * sizeof *next);
    for (struct dt_piece at = before_slice(a, items, slice); next_piece(a, items, slice, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            next[part_of(a, hash(a, place(a, i)))]++;
}

/* Where each slice's entries of each part go. */
static void lay_out(struct arrivals *a)
{
    uint32_t at = 0;
    for (uint32_t part = 0; part < parts(a); part++) {
        a->start[part] = at;
        for (unsigned slice = 0; slice < a->slices; slice++) {
            uint32_t *here = &a->at[(size_t)slice * parts(a) + part];
            uint32_t entries = *here;
            *here = at;
            at += entries;
        }
    }
    a->start[parts(a)] = at;
}

static void deal(void *arg, unsigned slice)
{
    struct arrivals *a = arg;
    uint32_t *next = a->at + (size_t)slice * parts(a), items = a->end + a->n;
    for (struct dt_piece at = before_slice(a, items, slice); next_piece(a, items, slice, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            uint64_t h = hash(a, place(a, i));
            a->entry[next[part_of(a, h)]++] = (struct entry){tag_of(h), i};
        }
}

/* ---- by parts ---- */

static bool coincide(const struct arrivals *a, struct entry e, struct entry f)
{
    if (e.tag != f.tag)
        return false;
    struct dt_point p = place(a, e.item), q = place(a, f.item);
    return p.x == q.x && p.y == q.y;
}

/* The entry of the table that coincides with e, or the place where there is none. */
static uint32_t *look_up(const struct arrivals *a, uint32_t *table, struct entry e)
{
    uint32_t mask = (1u << a->table_bits) - 1, at = e.tag >> (32 - a->table_bits);
    while (table[at] != DT_NONE && !coincide(a, a->entry[table[at]], e))
        at = (at + 1) & mask;
    return &table[at];
}

/* False: more places than the table has room for. */
static bool compare_part(const struct arrivals *a, uint32_t *table, uint32_t part)
{
    uint32_t room = (1u << a->table_bits) / 4 * 3;
    memset(table, 0xff, sizeof *table << a->table_bits); /* all DT_NONE */
    for (uint32_t i = a->start[part]; i < a->start[part + 1]; i++) {
        uint32_t item = a->entry[i].item, *at = look_up(a, table, a->entry[i]);
        uint32_t first = *at == DT_NONE ? DT_NONE : a->entry[*at].item;
        if (item >= a->end)
            a->same[item - a->end] = first;
        if (first == DT_NONE) {
            if (room-- == 0)
                return false;
            *at = i;
        }
    }
    return true;
}

static void compare(void *arg, unsigned slice)
{
    struct arrivals *a = arg;
    uint32_t *table = a->table + ((size_t)slice << a->table_bits);
    uint32_t last = dt_slice(parts(a), slice + 1, a->slices);
    a->crowded[slice] = false;
    for (uint32_t part = dt_slice(parts(a), slice, a->slices); part < last && !dt_stopped(a->stop);
         part++)
        if (!compare_part(a, table, part))
            a->crowded[slice] = true;
}

/* ---- by slices of arrivals ---- */

static void count_fresh(void *arg, unsigned slice)
{
    struct arrivals *a = arg;
    uint32_t fresh = 0;
    for (struct dt_piece at = before_slice(a, a->n, slice); next_piece(a, a->n, slice, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            fresh += a->same[i] == DT_NONE;
    a->fresh[slice] = fresh;
}

static void enter(void *arg, unsigned slice)
{
    const struct arrivals *a = arg;
    struct dt_points *p = a->p;
    uint32_t v = a->end;
    for (unsigned before = 0; before < slice; before++)
        v += a->fresh[before];
    for (struct dt_piece at = before_slice(a, a->n, slice); next_piece(a, a->n, slice, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            if (a->same[i] != DT_NONE)
                continue;
            p->xy[v] = (struct dt_point){a->q[i].x + 0.0, a->q[i].y + 0.0}; /* -0 becomes 0 */
            p->id[v++] = p->next_id + i;
        }
}

/* ---- ids and aliases ---- */

static void take_back(struct dt_points *p, uint32_t n, uint32_t end)
{
    for (uint32_t id = p->next_id + n; id-- > p->next_id;) {
        uint32_t v = dt_idmap_get(&p->value, id);
        if (v == DT_NONE)
            continue;
        dt_idmap_unset(&p->value, id);
        if (v & DT_ALIAS_BIT)
            dt_points_leave_group(p, v & ~DT_ALIAS_BIT);
    }
    p->end = end;
}

/* The id of the representative with which arrival i coincides. */
static uint32_t representative(const struct arrivals *a, uint32_t i)
{
    uint32_t first = a->same[i];
    return first < a->end ? a->p->id[first] : a->p->next_id + (first - a->end);
}

static enum dt_status make_alias(struct arrivals *a, uint32_t i)
{
    enum { AHEAD = 16 }; /* arrivals; long enough for a cache miss */
    struct dt_points *p = a->p;
    uint32_t later = i + 2 * AHEAD, soon = i + AHEAD;
    if (later < a->n && a->same[later] != DT_NONE)
        dt_idmap_fetch(&p->value, representative(a, later));
    uint32_t v = soon < a->n && a->same[soon] != DT_NONE
                     ? dt_idmap_get(&p->value, representative(a, soon))
                     : DT_NONE;
    if (v < p->group_cap)
        dt_fetch(&p->group[v]);
    struct dt_point at = {a->q[i].x + 0.0, a->q[i].y + 0.0};
    return dt_points_join(p, p->next_id + i, at, dt_idmap_get(&p->value, representative(a, i)));
}

/* Gives each arrival its vertex, or makes it an alias. */
static enum dt_status name(struct arrivals *a)
{
    struct dt_points *p = a->p;
    p->end = a->end;
    for (unsigned slice = 0; slice < a->slices; slice++)
        p->end += a->fresh[slice];
    enum dt_status status = DT_OK;
    uint32_t i = 0;
    for (uint32_t v = a->end; i < a->n && status == DT_OK; i++) {
        if (a->same[i] == DT_NONE)
            dt_idmap_set(&p->value, p->next_id + i, v++);
        else
            status = make_alias(a, i);
        if (i % DT_POLL_MISSES == 0 && dt_stopped(a->stop))
            status = dt_stop_status(a->stop);
    }
    if (status != DT_OK)
        take_back(p, i, a->end);
    return status;
}

/* ---- all of it ---- */

bool dt_arrivals_suit(const struct dt_points *p, size_t n)
{
    return p->tol == 0 && p->free_count == 0 && n >= FEW && n >= p->end;
}

static enum dt_status allocate(struct arrivals *a)
{
    struct dt_pages *pages = a->p->pages;
    uint32_t items = a->end + a->n;
    while (a->bits < MOST_BITS && items >> a->bits > PART)
        a->bits++;
    a->table_bits = 1;
    while (1u << a->table_bits < 2 * (items >> a->bits))
        a->table_bits++;
    a->at = dt_array_new_in(pages, (size_t)a->slices << a->bits, sizeof *a->at);
    a->start = dt_array_new_in(pages, parts(a) + (size_t)1, sizeof *a->start);
    a->entry = dt_array_new_in(pages, items, sizeof *a->entry);
    a->same = dt_array_new_in(pages, a->n, sizeof *a->same);
    a->table = dt_array_new_in(pages, (size_t)a->slices << a->table_bits, sizeof *a->table);
    if (a->at == NULL || a->start == NULL || a->entry == NULL || a->same == NULL ||
        a->table == NULL)
        return DT_NOMEM;
    a->seed = (uint64_t)(uintptr_t)a->entry * 0xD1B54A32D192ED03u;
    return DT_OK;
}

/* A pass over all slices. What it leaves behind is of no use unless DT_OK. */
static enum dt_status pass(struct arrivals *a, const struct dt_pool *pool,
                           void (*job)(void *arg, unsigned slice))
{
    dt_run(pool, a->slices, job, a);
    return dt_stop_status(a->stop);
}

static enum dt_status find_same(struct arrivals *a, const struct dt_pool *pool,
                                struct dt_work *work)
{
    enum dt_status status = dt_work(work, 2 * ((uint64_t)a->end + a->n));
    if (status == DT_OK)
        status = pass(a, pool, count);
    if (status == DT_OK) {
        lay_out(a);
        status = pass(a, pool, deal);
    }
    if (status == DT_OK)
        status = pass(a, pool, compare);
    if (status != DT_OK)
        return status;
    for (unsigned slice = 0; slice < a->slices; slice++)
        if (a->crowded[slice])
            return DT_TOOSMALL;
    return DT_OK;
}

static void free_arrays(struct arrivals *a)
{
    dt_array_free(a->at);
    dt_array_free(a->start);
    dt_array_free(a->entry);
    dt_array_free(a->same);
    dt_array_free(a->table);
}

enum dt_status dt_arrivals_add(struct dt_points *p, const struct dt_point *q, uint32_t n,
                               const struct dt_pool *pool, struct dt_work *work,
                               struct dt_added *out)
{
    struct dt_stop stop = dt_work_stop(work);
    struct arrivals a = {.p = p, .q = q, .end = p->end, .n = n, .bits = 1, .stop = &stop};
    a.slices = dt_threads_for(pool, n);
    enum dt_status status = allocate(&a);
    if (status == DT_OK)
        status = find_same(&a, pool, work);
    if (status == DT_OK)
        status = pass(&a, pool, count_fresh);
    if (status == DT_OK)
        status = pass(&a, pool, enter);
    if (status == DT_OK)
        status = name(&a);
    if (status == DT_OK) {
        *out = (struct dt_added){p->next_id, n, n - (p->end - a.end)};
        dt_points_arrived(p, n);
    }
    free_arrays(&a);
    return status;
}

enum dt_status dt_arrivals_distinct(struct dt_points *p, struct dt_work *work)
{
    struct dt_stop stop = dt_work_stop(work);
    struct arrivals a = {.p = p, .q = p->xy, .n = p->end, .bits = 1, .slices = 1, .stop = &stop};
    enum dt_status status = p->end < FEW ? DT_TOOSMALL : allocate(&a);
    if (status == DT_OK)
        status = find_same(&a, NULL, work);
    for (uint32_t i = 0; status == DT_OK && i < a.n; i++)
        if (a.same[i] != DT_NONE)
            status = DT_CORRUPT;
    free_arrays(&a);
    return status;
}
