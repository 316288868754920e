/* paper.c - Fang & Piegl 1993, Table 1: CPU seconds on an IBM PS/2 486/25, five sets of each size
 * averaged. Ours: the same sizes with the same algorithm (METHOD shelling), averaged over a
 * million points of each size. */
#include "tests/bench/paper.h"

#include "core/shelling/shelling.h"
#include "tests/bench/measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { STEP = 500, SIZES = 10, LAST = SIZES - 1 };

static const struct {
    double grid_s, triangulation_s;
} published[SIZES] = {{0.274725, 1.351648}, {0.494505, 2.681319},  {0.714286, 3.989011},
                      {0.879121, 5.085714}, {1.043956, 6.670330},  {1.318681, 7.989011},
                      {1.483516, 9.329670}, {1.648352, 10.670329}, {1.868132, 11.956044},
                      {2.087912, 13.230769}};

struct costs {
    double grid_ns, triangulation_ns; /* per point */
};

/* The arrays that a caller of the engine provides: input, and the points in the order of the grid. */
struct arrays {
    struct dt_point *in, *xy;
    uint32_t *from;
};

/* Adds the seconds that one set takes; the grid is part of the whole. */
static bool time_one(const struct arrays *a, uint32_t n, double *grid_s, double *whole_s)
{
    struct dt_grid g = {0};
    struct dt_mesh m = {0};
    double start = measure_cpu();
    bool ok = dt_grid_build(&g, a->in, n, a->xy, a->from) == DT_OK;
    *grid_s += measure_cpu() - start;
    dt_grid_clear(&g);
    start = measure_cpu();
    ok = ok && dt_shelling(a->in, n, a->xy, a->from, &m, NULL) == DT_OK;
    *whole_s += measure_cpu() - start;
    dt_mesh_clear(&m);
    return ok;
}

static struct costs average(uint32_t n)
{
    size_t sets = measure_sets(n);
    double grid_s = 0, whole_s = 0;
    struct arrays a = {malloc(n * sizeof *a.in), malloc(n * sizeof *a.xy),
                       malloc(n * sizeof *a.from)};
    bool ok = a.in != NULL && a.xy != NULL && a.from != NULL;
    for (size_t i = 0; ok && i < sets; i++) {
        family_points(family_find("uniform"), a.in, n, 2 + i);
        ok = time_one(&a, n, &grid_s, &whole_s);
    }
    free(a.in);
    free(a.xy);
    free(a.from);
    double per_point = ok ? 1e9 / (double)(sets * n) : 0;
    return (struct costs){grid_s * per_point, (whole_s - grid_s) * per_point};
}

void paper_table(void)
{
    double grid[SIZES] = {0}, triangulation[SIZES] = {0};
    printf("The paper's Table 1 (METHOD shelling, one thread): ns per point; the paper's figures "
           "are microseconds.\n\n"
           "| n | grid | triangulation | the paper's grid, us | the paper's triangulation, us "
           "|\n|---|---|---|---|---|\n");
    for (int i = 0; i < SIZES; i++) {
        uint32_t n = (uint32_t)(i + 1) * STEP;
        grid[i] = triangulation[i] = HUGE_VAL;
        for (int k = 0; k < 3; k++) {
            struct costs c = average(n);
            grid[i] = fmin(grid[i], c.grid_ns);
            triangulation[i] = fmin(triangulation[i], c.triangulation_ns);
        }
        printf("| %u | %.1f | %.1f | %.0f | %.0f |\n", n, grid[i], triangulation[i],
               1e6 * published[i].grid_s / (double)n,
               1e6 * published[i].triangulation_s / (double)n);
    }
    /* The cost per point of 5,000 points divided by that of 500: 1 is linear. */
    printf("| 5000 / 500 | %.2f | %.2f | %.2f | %.2f |\n\n", grid[LAST] / grid[0],
           triangulation[LAST] / triangulation[0],
           published[LAST].grid_s / published[0].grid_s / SIZES,
           published[LAST].triangulation_s / published[0].triangulation_s / SIZES);
}
