/* rasters.c - the cost of options of rasters, in comparison with a plain raster of the same cells.
 *
 *     rasters N K     rasters of K cells, each of a surface over N uniform points of the unit square
 *
 * A figure is the least of ROUNDS runs; plain rasters and others alternate. */
#include "core/delaunay_surface.h"
#include "tests/bench/measure.h"
#include "tests/bench/set/live_plan.h"
#include "tests/bench/set/surface_plan.h"

#include <stdio.h>
#include <stdlib.h>

enum { ROUNDS = 5 };

struct rasters {
    struct dt *set;
    size_t n, k;
    double *value; /* owns k */
};

static void must(bool ok)
{
    if (ok)
        return;
    fprintf(stderr, "rasters: out of memory\n");
    exit(1);
}

static void begin(struct rasters *r)
{
    struct live_plan plan = live_plan_new(r->n, 1);
    struct dt_added added;
    uint32_t missing;
    double *z = malloc(r->n * sizeof *z);
    r->set = dt_new(0);
    r->value = malloc(r->k * sizeof *r->value);
    must(z != NULL && r->set != NULL && r->value != NULL);
    must(dt_add(r->set, plan.start, r->n, &added) == DT_OK);
    for (size_t i = 0; i < r->n; i++)
        z[i] = surface_height(plan.start[i].x, plan.start[i].y);
    must(dt_field_set_run(r->set, "z", 1, added.first, z, r->n, NULL, &missing) == DT_OK);
    must(dt_triangulate(r->set, NULL) == DT_OK && dt_prepare(r->set, NULL) == DT_OK);
    free(z);
    live_plan_free(&plan);
}

/* Nanoseconds for a cell. */
static double fill(struct rasters *r, const struct dt_surface *s, const struct dt_raster *cells)
{
    size_t k = (size_t)cells->columns * cells->rows, done;
    double start = measure_cpu();
    must(dt_raster_values(r->set, s, cells, 0, k, NULL, r->value, &done) == DT_OK);
    return live_ns(start, k);
}

static void compare(struct rasters *r, const char *what, double margin,
                    const struct dt_surface *options)
{
    uint32_t side = 1;
    while ((size_t)(side + 1) * (side + 1) <= r->k)
        side++;
    struct dt_raster cells = {{-margin, -margin}, {1 + margin, 1 + margin}, side, side};
    double least[2] = {HUGE_VAL, HUGE_VAL};
    for (int round = 0; round < ROUNDS; round++)
        for (int with = 0; with < 2; with++) {
            struct dt_surface s = {.max_edge = HUGE_VAL};
            if (with)
                s = *options;
            must(dt_surface_begin(&s, dt_field_find(r->set, "z", 1), NULL) == DT_OK);
            least[with] = fmin(least[with], fill(r, &s, &cells));
            dt_surface_end(&s);
        }
    printf("| %s | %.1f | %.1f | %.2f |\n", what, least[1], least[0], least[1] / least[0]);
}

int main(int argc, char **argv)
{
    if (argc < 3)
        return 2;
    struct rasters r = {.n = strtoul(argv[1], NULL, 10), .k = strtoul(argv[2], NULL, 10)};
    struct dt_surface beyond = {.max_edge = HUGE_VAL, .beyond = true};
    begin(&r);
    printf("Rasters of %zu cells over %zu points, ns for a cell, one thread.\n\n", r.k, r.n);
    printf("| what | with | plain | ratio |\n|---|---|---|---|\n");
    compare(&r, "OUTSIDE nearest, the box of the points", 0, &beyond);
    compare(&r, "OUTSIDE nearest, with a margin of a tenth", 0.1, &beyond);
    compare(&r, "OUTSIDE nearest, three times as wide and high", 1, &beyond);
    printf("\n");
    dt_free(r.set);
    free(r.value);
    return 0;
}
