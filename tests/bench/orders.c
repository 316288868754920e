/* orders.c - uniform points, sorted by a number that each order computes from a place. */
#include "tests/bench/orders.h"

#include <math.h>
#include <stdlib.h>

struct ranked {
    double rank;
    struct dt_point p;
};

static int compare_ranks(const void *a, const void *b)
{
    double x = ((const struct ranked *)a)->rank, y = ((const struct ranked *)b)->rank;
    return (x > y) - (x < y);
}

/* Uniform points by ascending rank; unsorted if there is no memory. */
static void fill_by(double (*rank)(struct dt_point p), struct dt_point *p, size_t n, uint64_t *r)
{
    family_find("uniform")->fill(p, n, r);
    struct ranked *all = malloc((n + 1) * sizeof *all);
    if (all == NULL)
        return;
    for (size_t i = 0; i < n; i++)
        all[i] = (struct ranked){rank(p[i]), p[i]};
    qsort(all, n, sizeof *all, compare_ranks);
    for (size_t i = 0; i < n; i++)
        p[i] = all[i].p;
    free(all);
}

static double by_x(struct dt_point p)
{
    return p.x;
}

static double by_x_down(struct dt_point p)
{
    return -p.x;
}

static double by_y(struct dt_point p)
{
    return p.y;
}

static double by_diagonal(struct dt_point p)
{
    return p.x + p.y;
}

/* In a thousand strips, each from its bottom to its top. */
static double by_strips(struct dt_point p)
{
    return floor(p.x * 1000) + p.y;
}

static double from_centre(struct dt_point p)
{
    return hypot(p.x - 0.5, p.y - 0.5);
}

static double to_centre(struct dt_point p)
{
    return -from_centre(p);
}

/* The position along the Hilbert curve, 26 bits each way [Hilbert 1891; the loop is from Warren, Hacker's
 * Delight, ch. 16]. */
static double by_hilbert(struct dt_point p)
{
    uint32_t x = (uint32_t)(p.x * 0x1p26), y = (uint32_t)(p.y * 0x1p26);
    uint64_t at = 0;
    for (uint32_t bit = 1u << 25; bit > 0; bit >>= 1) {
        uint32_t right = (x & bit) != 0, up = (y & bit) != 0;
        at = at << 2 | ((3 * right) ^ up);
        if (up)
            continue;
        if (right) {
            x = ~x;
            y = ~y;
        }
        uint32_t swap = x;
        x = y;
        y = swap;
    }
    return (double)at;
}

static double by_hilbert_back(struct dt_point p)
{
    return -by_hilbert(p);
}

/* Long jumps between consecutive points: every 1009th point along the curve, then the next ones. */
static void fill_leaps(struct dt_point *p, size_t n, uint64_t *r)
{
    fill_by(by_hilbert, p, n, r);
    struct dt_point *all = malloc((n + 1) * sizeof *all);
    if (all == NULL)
        return;
    for (size_t i = 0; i < n; i++)
        all[i] = p[i];
    size_t k = 0;
    for (size_t from = 0; from < 1009; from++)
        for (size_t i = from; i < n; i += 1009)
            p[k++] = all[i];
    free(all);
}

#define ORDER(name)                                                                                \
    static void fill_##name(struct dt_point *p, size_t n, uint64_t *r)                             \
    {                                                                                              \
        fill_by(name, p, n, r);                                                                    \
    }
ORDER(by_x)
ORDER(by_x_down)
ORDER(by_y)
ORDER(by_diagonal)
ORDER(by_strips)
ORDER(from_centre)
ORDER(to_centre)
ORDER(by_hilbert)
ORDER(by_hilbert_back)

const struct family orders[] = {
    {"by_x", "uniform, from left to right", false, fill_by_x},
    {"by_x_down", "uniform, from right to left", false, fill_by_x_down},
    {"by_y", "uniform, upwards", false, fill_by_y},
    {"by_diagonal", "uniform, by x + y", false, fill_by_diagonal},
    {"by_strips", "uniform, a thousand strips upwards", false, fill_by_strips},
    {"from_centre", "uniform, by distance from the centre", false, fill_from_centre},
    {"to_centre", "uniform, inwards", false, fill_to_centre},
    {"by_hilbert", "uniform, along Hilbert's curve", false, fill_by_hilbert},
    {"by_hilbert_back", "uniform, the other way", false, fill_by_hilbert_back},
    {"leaps", "uniform, every 1009th along the curve", false, fill_leaps},
    {NULL, NULL, false, NULL},
};
