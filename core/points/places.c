/* places.c - a chained hash table of cells; see places.h. */
#include "core/points/places.h"

#include <math.h>

#include "core/exact/predicates.h"
#include "core/memory/memory.h"

void dt_places_clear(struct dt_places *p)
{
    dt_array_free(p->bucket);
    dt_array_free(p->next);
    *p = (struct dt_places){.pages = p->pages};
}

/* The column (or row) of cells that v lies in. Monotone, which is all that the search below relies
 * on. */
static double cell(const struct dt_places *p, double v)
{
    return p->tol > 0 ? floor(v / (2 * p->tol)) : v;
}

static uint32_t bucket_of(const struct dt_places *p, double column, double row)
{
    return (uint32_t)dt_place_hash(column, row, p->seed) & p->mask;
}

static uint32_t home(const struct dt_places *p, struct dt_point q)
{
    return bucket_of(p, cell(p, q.x), cell(p, q.y));
}

void dt_places_enter(struct dt_places *p, const struct dt_point *xy, uint32_t v)
{
    uint32_t b = home(p, xy[v]);
    p->next[v] = p->bucket[b];
    p->bucket[b] = v;
}

void dt_places_leave(struct dt_places *p, const struct dt_point *xy, uint32_t v)
{
    uint32_t *at = &p->bucket[home(p, xy[v])];
    while (*at != v)
        at = &p->next[*at];
    *at = p->next[v];
}

/* An empty table for `cap` vertices; DT_NOMEM: nothing to free. */
static enum dt_status new_table(struct dt_places *p, size_t cap)
{
    size_t buckets = 16;
    while (buckets < cap)
        buckets *= 2;
    p->bucket = dt_array_new_in(p->pages, buckets, sizeof *p->bucket);
    p->next = dt_array_new_in(p->pages, cap, sizeof *p->next);
    if (p->bucket == NULL || p->next == NULL) {
        dt_places_clear(p);
        return DT_NOMEM;
    }
    memset(p->bucket, 0xff, buckets * sizeof *p->bucket); /* all DT_NONE */
    p->mask = (uint32_t)buckets - 1;
    p->cap = (uint32_t)cap;
    return DT_OK;
}

enum dt_status dt_places_reserve(struct dt_places *p, double tol, const struct dt_point *xy,
                                 const uint32_t *id, uint32_t end, uint32_t verts,
                                 struct dt_stop *work)
{
    if (p->bucket != NULL && verts <= p->cap)
        return DT_OK;
    struct dt_places fresh = {.pages = p->pages, .tol = tol};
    enum dt_status status = dt_work_allows(work, end) ? DT_OK : DT_TOOLONG;
    if (status == DT_OK)
        status = new_table(&fresh, dt_array_room(p->cap, verts, DT_MAX_POINTS));
    fresh.seed =
        p->bucket != NULL ? p->seed : (uint64_t)(uintptr_t)fresh.bucket * 0xD1B54A32D192ED03u;
    for (uint32_t v = 0; status == DT_OK && v < end; v++) {
        if (id[v] != DT_NONE)
            dt_places_enter(&fresh, xy, v);
        if ((v & DT_WORK_MASK) == DT_WORK_MASK)
            status = dt_work(work, DT_WORK_BLOCK);
    }
    dt_places_clear(status == DT_OK ? p : &fresh);
    if (status == DT_OK)
        *p = fresh;
    return status;
}

void dt_places_fetch(const struct dt_places *p, const struct dt_point *xy, const struct dt_point *q,
                     size_t n)
{
    enum { MISSES = 12 }; /* places that are looked up while a cache miss takes place */
    if (p->tol != 0)
        return;
    if (n > 2 * MISSES)
        dt_fetch(&p->bucket[home(p, q[2 * MISSES])]);
    uint32_t v = n > MISSES ? p->bucket[home(p, q[MISSES])] : DT_NONE;
    if (v != DT_NONE) {
        dt_fetch(&xy[v]);
        dt_fetch(&p->next[v]);
    }
}

/* The nearer of best and the vertices in one bucket that are within reach of q. A bucket may hold
 * other cells' vertices, too: they are out of reach, or equally good. */
static uint32_t nearest_in(const struct dt_places *p, uint32_t b, const struct dt_point *xy,
                           const uint32_t *id, struct dt_point q, uint32_t except, uint32_t best)
{
    for (uint32_t v = p->bucket[b]; v != DT_NONE; v = p->next[v]) {
        if (v == except || dt_compare_radius(xy[v], q, p->tol) > 0)
            continue;
        int nearer = best == DT_NONE ? -1 : dt_compare_distance(q, xy[v], xy[best]);
        if (nearer < 0 || (nearer == 0 && id[v] < id[best]))
            best = v;
    }
    return best;
}

/* The next column after c that a value can have: cells are integers, but beyond 2^53 not every
 * integer is a double. */
static double cell_after(double c)
{
    return fmax(c + 1, nextafter(c, HUGE_VAL));
}

uint32_t dt_places_find(const struct dt_places *p, const struct dt_point *xy, const uint32_t *id,
                        struct dt_point q, uint32_t except)
{
    if (p->tol == 0) {
        for (uint32_t v = p->bucket[home(p, q)]; v != DT_NONE; v = p->next[v])
            if (xy[v].x == q.x && xy[v].y == q.y && v != except)
                return v;
        return DT_NONE;
    }
    /* Rounded outwards, so that monotony of cell() makes the search complete. */
    double reach = nextafter(p->tol, HUGE_VAL);
    double left = cell(p, nextafter(q.x - reach, -HUGE_VAL)),
           right = cell(p, nextafter(q.x + reach, HUGE_VAL));
    double bottom = cell(p, nextafter(q.y - reach, -HUGE_VAL)),
           top = cell(p, nextafter(q.y + reach, HUGE_VAL));
    uint32_t best = DT_NONE;
    for (double c = left; c <= right; c = cell_after(c))
        for (double r = bottom; r <= top; r = cell_after(r))
            best = nearest_in(p, bucket_of(p, c, r), xy, id, q, except, best);
    return best;
}
