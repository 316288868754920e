/* plan.c - the record of a build; see plan.h. Its merges are counted in 12 bits: as deep as four grids of 24 bits for
 * each halving of all points (divide.c). */
#include "core/divide/plan.h"

#include "core/divide/small_sort.h"

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
static void make_block(const struct dt_plan *w, const uint32_t *from, uint32_t lo, uint32_t n)
{
    uint32_t places = 0;
    for (uint32_t v = lo; v < lo + n; v++)
        places += !(from[v] & DT_COINCIDENT);
    w->step[lo] = (uint16_t)(w->step[lo] | places);
}

/* At most DT_BLOCK points. */
static void sort_block(const struct dt_plan *w, struct dt_point *p, uint32_t *from, uint32_t lo,
                       uint32_t n)
{
    if (dt_block_sort(p + lo, from + lo, n)) {
        w->step[lo] = (uint16_t)(w->step[lo] | n);
        return;
    }
    mark_runs(w, p + lo, from + lo, n);
    make_block(w, from, lo, n);
}

/* Returns how many of n sorted points precede a cut near the middle that parts no coincident points; n: all coincide. */
static uint32_t cut_of(const struct dt_point *p, uint32_t n)
{
    uint32_t mid = n / 2;
    while (mid > 0 && p[mid - 1].x == p[mid].x && p[mid - 1].y == p[mid].y)
        mid--;
    if (mid > 0)
        return mid;
    for (mid = 1; mid < n && p[mid].x == p[0].x && p[mid].y == p[0].y;)
        mid++;
    return mid;
}

void dt_plan_few(const struct dt_plan *w, struct dt_point *p, uint32_t *from, uint32_t lo,
                 uint32_t n)
{
    if (n <= DT_BLOCK) {
        sort_block(w, p, from, lo, n);
        return;
    }
    unsigned axis = dt_few_sort(p + lo, from + lo, n);
    uint32_t half = cut_of(p + lo, n), mid = lo + half;
    if (half == n) {
        dt_plan_place(w, p, from, lo, n);
        return;
    }
    dt_plan_cut(w, lo, mid, lo + n, axis);
    dt_plan_few(w, p, from, lo, half);
    dt_plan_few(w, p, from, mid, n - half);
}

void dt_plan_place(const struct dt_plan *w, struct dt_point *p, uint32_t *from, uint32_t lo,
                   uint32_t n)
{
    mark_place(w, from + lo, n);
    for (uint32_t v = lo; v < lo + n; v++)
        p[v] = (struct dt_point){p[v].x + 0.0, p[v].y + 0.0}; /* -0 becomes 0 */
    make_block(w, from, lo, n);
}
