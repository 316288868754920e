/* paper.c - Fang & Piegl 1993, Table 1: CPU seconds on an IBM PS/2 486/25, five sets of each size
 * averaged. Ours: the same sizes with the same algorithm (METHOD shelling), a million points of
 * each size averaged. */
#include "tests/bench/paper.h"

#include "core/grid.h"
#include "tests/bench/measure.h"

#include <stdio.h>
#include <stdlib.h>

enum { STEP = 500, SIZES = 10, LAST = SIZES - 1 };

static const struct {
    double grid_s, triangulation_s;
} published[SIZES] = {{0.274725, 1.351648}, {0.494505, 2.681319},  {0.714286, 3.989011},
                      {0.879121, 5.085714}, {1.043956, 6.670330},  {1.318681, 7.989011},
                      {1.483516, 9.329670}, {1.648352, 10.670329}, {1.868132, 11.956044},
                      {2.087912, 13.230769}};

/* ns per point of building the grid alone; 0 if it cannot be measured. */
static double grid_ns(size_t n)
{
    size_t sets = measure_sets(n);
    double seconds = 0;
    struct dt_point *p = malloc(n * sizeof *p);
    for (size_t i = 0; p != NULL && i < sets; i++) {
        struct dt_grid g = {0};
        family_points(family_find("uniform"), p, n, 2 + i);
        double start = measure_now();
        if (dt_grid_build(&g, p, (uint32_t)n) != DT_OK)
            break;
        seconds += measure_now() - start;
        dt_grid_clear(&g);
    }
    free(p);
    return 1e9 * seconds / (double)(sets * n);
}

void paper_table(void)
{
    double grid[SIZES], triangulation[SIZES];
    printf("The paper's Table 1 (METHOD shelling, one thread): ns per point; the paper's figures "
           "are microseconds.\n\n"
           "| n | grid | triangulation | the paper's grid, us | the paper's triangulation, us "
           "|\n|---|---|---|---|---|\n");
    for (int i = 0; i < SIZES; i++) {
        size_t n = (size_t)(i + 1) * STEP;
        struct build b = {family_find("uniform"), n, DT_SHELLING, 1, true};
        struct cost c = {0};
        measure(&b, &c);
        grid[i] = grid_ns(n);
        triangulation[i] = c.build_ns - grid[i];
        printf("| %zu | %.1f | %.1f | %.0f | %.0f |\n", n, grid[i], triangulation[i],
               1e6 * published[i].grid_s / (double)n,
               1e6 * published[i].triangulation_s / (double)n);
    }
    /* The cost of a point among 5,000 in relation to one among 500: 1 is linear. */
    printf("| 5000 / 500 | %.2f | %.2f | %.2f | %.2f |\n\n", grid[LAST] / grid[0],
           triangulation[LAST] / triangulation[0],
           published[LAST].grid_s / published[0].grid_s / SIZES,
           published[LAST].triangulation_s / published[0].triangulation_s / SIZES);
}
