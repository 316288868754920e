/* plan.c - the record of a build; see plan.h. Its merges are counted in 12 bits: as deep as four grids of 24 bits for
 * each halving of all points (divide.c). */
#include "core/divide/plan.h"

#include "core/divide/few.h"

/* Marks n > 0 neighbours at one place, of which the one with the smallest name stays. */
static void mark_place(const struct dt_plan *w, uint32_t *from, uint32_t n)
{
    uint32_t first = from[0];
    for (uint32_t i = 1; i < n; i++)
        first = from[i] < first ? from[i] : first;
    for (uint32_t i = 0; i < n; i++)
        if (from[i] != first) {
            w->same[from[i]] = first;
            from[i] |= DT_COINCIDENT;
        }
}

/* Sorted points: all that coincide are marked. */
static void mark_runs(const struct dt_plan *w, const struct dt_point *p, uint32_t *from, uint32_t n)
{
    for (uint32_t i = 0, end; i < n; i = end) {
        for (end = i + 1; end < n && p[end].x == p[i].x && p[end].y == p[i].y;)
            end++;
        mark_place(w, from + i, end - i);
    }
}

/* The n sorted points from lo on become a block, those left out that coincide with others. */
static struct dt_blocks make_block(const struct dt_plan *w, const uint32_t *from, uint32_t lo,
                                   uint32_t n)
{
    uint32_t places = 0;
    for (uint32_t v = lo; v < lo + n; v++)
        places += !(from[v] & DT_COINCIDENT);
    w->step[lo] = (uint16_t)places;
    return (struct dt_blocks){places, lo, lo};
}

/* At most DT_BLOCK points. */
static struct dt_blocks sort_block(const struct dt_plan *w, struct dt_point *p, uint32_t *from,
                                   uint32_t lo, uint32_t n)
{
    if (!dt_block_sort(p + lo, from + lo, n)) {
        mark_runs(w, p + lo, from + lo, n);
        return make_block(w, from, lo, n);
    }
    w->step[lo] = (uint16_t)n;
    return (struct dt_blocks){n, lo, lo};
}

/* One half of more points, some of which are marked. */
static struct dt_blocks sort_marked(const struct dt_plan *w, struct dt_point *p, uint32_t *from,
                                    uint32_t lo, uint32_t n)
{
    dt_insertion_sort(0, p + lo, from + lo, n);
    return make_block(w, from, lo, n);
}

static bool any_coincide(const struct dt_point *p, uint32_t n)
{
    bool coincide = false;
    for (uint32_t i = 1; i < n; i++)
        coincide |= (p[i - 1].x == p[i].x) & (p[i - 1].y == p[i].y);
    return coincide;
}

struct dt_blocks dt_plan_few(const struct dt_plan *w, struct dt_point *p, uint32_t *from,
                             uint32_t lo, uint32_t n)
{
    if (n <= DT_BLOCK)
        return sort_block(w, p, from, lo, n);
    uint32_t half = n / 2, mid = lo + half;
    unsigned axis = dt_few_sort(p + lo, from + lo, n);
    struct dt_blocks a, b;
    if (any_coincide(p + lo, n)) {
        mark_runs(w, p + lo, from + lo, n);
        a = sort_marked(w, p, from, lo, half);
        b = sort_marked(w, p, from, mid, n - half);
    } else {
        a = sort_block(w, p, from, lo, half);
        b = sort_block(w, p, from, mid, n - half);
    }
    return dt_plan_join(w, a, b, axis);
}

struct dt_blocks dt_plan_place(const struct dt_plan *w, struct dt_point *p, uint32_t *from,
                               uint32_t lo, uint32_t n)
{
    mark_place(w, from + lo, n);
    for (uint32_t v = lo; v < lo + n; v++)
        p[v] = (struct dt_point){p[v].x + 0.0, p[v].y + 0.0}; /* -0 becomes 0 */
    return make_block(w, from, lo, n);
}

struct dt_blocks dt_plan_join(const struct dt_plan *w, struct dt_blocks a, struct dt_blocks b,
                              unsigned axis)
{
    if (a.n == 0)
        return b;
    if (b.n == 0)
        return a;
    w->step[b.first] = (uint16_t)(w->step[b.first] | axis << 3);
    w->step[b.last] = (uint16_t)(w->step[b.last] + (1u << 4));
    return (struct dt_blocks){a.n + b.n, a.first, b.last};
}
