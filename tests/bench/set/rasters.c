/* rasters.c - the cost of options of rasters, in comparison with a plain raster of the same cells.
 *
 *     rasters N K     rasters of K cells, each of a surface over N uniform points of the unit square
 *
 * A figure is the least of ROUNDS runs; plain rasters and others alternate. */
#include "core/delaunay_constraints.h"
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
    uint8_t *bits; /* owns k */
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
    r->bits = malloc(r->k / 8 + 1);
    must(z != NULL && r->set != NULL && r->value != NULL && r->bits != NULL);
    must(dt_add(r->set, plan.start, r->n, &added) == DT_OK);
    for (size_t i = 0; i < r->n; i++)
        z[i] = surface_height(plan.start[i].x, plan.start[i].y);
    must(dt_field_set_run(r->set, "z", 1, added.first, z, r->n, NULL, &missing) == DT_OK);
    must(dt_triangulate(r->set, NULL) == DT_OK && dt_prepare(r->set, NULL) == DT_OK);
    free(z);
    live_plan_free(&plan);
}

/* A set of a ring of n corners around the middle, each farther or nearer, in `others` random points. */
static struct dt *ring(size_t n, size_t others)
{
    struct live_plan plan = live_plan_new(others, 1);
    struct dt_point *p = malloc(n * sizeof *p);
    struct dt_constraint *c = malloc(n * sizeof *c);
    struct dt *t = dt_new(0);
    struct dt_added added;
    uint32_t missing;
    size_t declared;
    must(p != NULL && c != NULL && t != NULL);
    for (size_t i = 0; i < n; i++) {
        double at = 6.283185307179586 * (double)i / (double)n, far = i % 2 == 0 ? 0.45 : 0.3;
        p[i] = (struct dt_point){0.5 + far * cos(at), 0.5 + far * sin(at)};
        c[i] = (struct dt_constraint){(uint32_t)i, (uint32_t)((i + 1) % n), true, 0};
    }
    must(dt_add(t, p, n, &added) == DT_OK && dt_add(t, plan.start, others, &added) == DT_OK);
    must(dt_constrain(t, c, n, NULL, &declared, &missing) == DT_OK);
    must(dt_triangulate(t, NULL) == DT_OK && dt_prepare(t, NULL) == DT_OK);
    must(dt_survey(t, NULL) == DT_OK);
    free(p);
    free(c);
    live_plan_free(&plan);
    return t;
}

/* Clears the cells that are not inside the borders of the other set. */
static void clip(struct rasters *r, const struct dt *other, const struct dt_raster *cells)
{
    size_t k = (size_t)cells->columns * cells->rows;
    must(dt_raster_inside(other, DT_NONE, cells, NULL, r->bits) == DT_OK);
    for (size_t i = 0; i < k; i++)
        if ((r->bits[i / 8] >> i % 8 & 1) == 0)
            r->value[i] = (double)NAN;
}

/* Nanoseconds for a cell. */
static double fill(struct rasters *r, const struct dt_surface *s, const struct dt_raster *cells,
                   const struct dt *other)
{
    size_t k = (size_t)cells->columns * cells->rows, done;
    double start = measure_cpu();
    must(dt_raster_values(r->set, s, cells, 0, k, NULL, r->value, &done) == DT_OK);
    if (other != NULL)
        clip(r, other, cells);
    return live_ns(start, k);
}

static void compare(struct rasters *r, const char *what, double margin,
                    const struct dt_surface *options, const struct dt *other)
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
            least[with] = fmin(least[with], fill(r, &s, &cells, with ? other : NULL));
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
    compare(&r, "OUTSIDE nearest, the box of the points", 0, &beyond, NULL);
    compare(&r, "OUTSIDE nearest, with a margin of a tenth", 0.1, &beyond, NULL);
    compare(&r, "OUTSIDE nearest, three times as wide and high", 1, &beyond, NULL);
    struct dt_surface plain = {.max_edge = HUGE_VAL};
    struct dt *star = ring(1000, 0), *large = ring(1000, r.n);
    compare(&r, "CLIP by a star of 1000 corners", 0, &plain, star);
    compare(&r, "CLIP by the same, three times as wide and high", 1, &plain, star);
    compare(&r, "CLIP by the same, in a set of as many points", 0, &plain, large);
    struct dt_surface smooth = {.max_edge = HUGE_VAL, .how = DT_SMOOTH};
    compare(&r, "METHOD smooth", 0, &smooth, NULL);
    printf("\n");
    dt_free(star);
    dt_free(large);
    dt_free(r.set);
    free(r.bits);
    free(r.value);
    return 0;
}
