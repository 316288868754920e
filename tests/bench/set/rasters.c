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
    double *value; /* owns k, for each of two fields */
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
    r->value = malloc(2 * r->k * sizeof *r->value);
    r->bits = malloc(r->k / 8 + 1);
    must(z != NULL && r->set != NULL && r->value != NULL && r->bits != NULL);
    must(dt_add(r->set, plan.start, r->n, &added) == DT_OK);
    for (size_t i = 0; i < r->n; i++)
        z[i] = surface_height(plan.start[i].x, plan.start[i].y);
    must(dt_field_set_run(r->set, "z", 1, added.first, z, r->n, NULL, &missing) == DT_OK);
    must(dt_field_set_run(r->set, "s", 1, added.first, z, r->n, NULL, &missing) == DT_OK);
    must(dt_triangulate(r->set, NULL) == DT_OK && dt_prepare(r->set, NULL) == DT_OK);
    free(z);
    live_plan_free(&plan);
}

/* The set without every tenth point, as MISSING skip has it; prints what that takes, beside a triangulation of the set. */
static struct dt *skip_tenth(const struct rasters *r)
{
    uint32_t *id = malloc((r->n / 10 + 1) * sizeof *id), n = 0, deleted, missing;
    struct dt *t, *all;
    must(id != NULL && dt_clone_points(r->set, NULL, &all) == DT_OK);
    for (size_t i = 0; i < r->n; i += 10)
        id[n++] = (uint32_t)i;
    double start = measure_cpu();
    must(dt_clone_points(r->set, NULL, &t) == DT_OK);
    must(dt_delete_many(t, id, n, NULL, &deleted, &missing) == DT_OK);
    must(dt_triangulate(t, NULL) == DT_OK && dt_refresh(t, NULL) == DT_OK &&
         dt_prepare(t, NULL) == DT_OK);
    double built = measure_cpu() - start;
    start = measure_cpu();
    must(dt_refresh(all, NULL) == DT_OK && dt_prepare(all, NULL) == DT_OK);
    printf("The points with values take %.0f ms, all points %.0f ms.\n\n", 1e3 * built,
           1e3 * (measure_cpu() - start));
    dt_free(all);
    free(id);
    return t;
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
static double fill(struct rasters *r, const struct dt *set, const struct dt_surface *s,
                   const struct dt_raster *cells, const struct dt *other)
{
    size_t k = (size_t)cells->columns * cells->rows, done;
    double start = measure_cpu();
    must(dt_raster_values(set, s, cells, 0, k, NULL, r->value, &done) == DT_OK);
    if (other != NULL)
        clip(r, other, cells);
    return live_ns(start, k);
}

/* The same for as many random places. */
static double find_anywhere(struct rasters *r, const struct dt *set, const struct dt_surface *s,
                            const struct dt_raster *cells)
{
    size_t k = (size_t)cells->columns * cells->rows, done;
    struct live_plan plan = live_plan_new(k, 2);
    double start = measure_cpu();
    must(dt_values(set, s, plan.start, k, NULL, r->value, &done) == DT_OK);
    double ns = live_ns(start, k);
    live_plan_free(&plan);
    return ns;
}

/* What is beside a plain raster. */
struct beside {
    const struct dt_surface *options;
    const struct dt *other; /* clips; NULL: nothing does */
    const struct dt *set;   /* NULL: the same */
    bool two;               /* two fields */
    bool anywhere;          /* random places of the unit square, also without the options */
};

/* Nanoseconds for a cell. */
static double fill_fields(struct rasters *r, const struct dt_raster *cells, const struct beside *b,
                          bool anywhere)
{
    const struct dt *set = b != NULL && b->set != NULL ? b->set : r->set;
    struct dt_surface s = {.max_edge = HUGE_VAL}, second;
    if (b != NULL)
        s = *b->options;
    second = s;
    if (b != NULL && b->two)
        s.next = &second;
    must(dt_surface_begin(&s, dt_field_find(set, "z", 1), NULL) == DT_OK);
    must(dt_surface_begin(&second, dt_field_find(set, "s", 1), NULL) == DT_OK);
    double ns = anywhere ? find_anywhere(r, set, &s, cells)
                         : fill(r, set, &s, cells, b != NULL ? b->other : NULL);
    dt_surface_end(&second);
    dt_surface_end(&s);
    return ns;
}

static void compare(struct rasters *r, const char *what, double margin, const struct beside *b)
{
    uint32_t side = 1;
    while ((size_t)(side + 1) * (side + 1) <= r->k)
        side++;
    struct dt_raster cells = {{-margin, -margin}, {1 + margin, 1 + margin}, side, side};
    double least[2] = {HUGE_VAL, HUGE_VAL};
    for (int round = 0; round < ROUNDS; round++)
        for (int with = 0; with < 2; with++)
            least[with] = fmin(least[with], fill_fields(r, &cells, with ? b : NULL, b->anywhere));
    printf("| %s | %.1f | %.1f | %.2f |\n", what, least[1], least[0], least[1] / least[0]);
}

int main(int argc, char **argv)
{
    if (argc < 3)
        return 2;
    struct rasters r = {.n = strtoul(argv[1], NULL, 10), .k = strtoul(argv[2], NULL, 10)};
    struct dt_surface beyond = {.max_edge = HUGE_VAL, .beyond = true};
    begin(&r);
    struct dt *others = skip_tenth(&r);
    printf("Rasters of %zu cells over %zu points, ns for a cell, one thread.\n\n", r.k, r.n);
    printf("| what | with | plain | ratio |\n|---|---|---|---|\n");
    compare(&r, "OUTSIDE nearest, the box of the points", 0, &(struct beside){.options = &beyond});
    compare(&r, "OUTSIDE nearest, with a margin of a tenth", 0.1,
            &(struct beside){.options = &beyond});
    compare(&r, "OUTSIDE nearest, three times as wide and high", 1,
            &(struct beside){.options = &beyond});
    struct dt_surface plain = {.max_edge = HUGE_VAL};
    struct dt *star = ring(1000, 0), *large = ring(1000, r.n);
    compare(&r, "CLIP by a star of 1000 corners", 0,
            &(struct beside){.options = &plain, .other = star});
    compare(&r, "CLIP by the same, three times as wide and high", 1,
            &(struct beside){.options = &plain, .other = star});
    compare(&r, "CLIP by the same, in a set of as many points", 0,
            &(struct beside){.options = &plain, .other = large});
    struct dt_surface smooth = {.max_edge = HUGE_VAL, .how = DT_SMOOTH};
    compare(&r, "METHOD smooth", 0, &(struct beside){.options = &smooth});
    compare(&r, "MISSING skip, of a tenth of the points, after the build", 0,
            &(struct beside){.options = &plain, .set = others});
    compare(&r, "two fields", 0, &(struct beside){.options = &plain, .two = true});
    compare(&r, "two fields at random places", 0,
            &(struct beside){.options = &plain, .two = true, .anywhere = true});
    compare(&r, "two fields, METHOD smooth", 0, &(struct beside){.options = &smooth, .two = true});
    printf("\n");
    dt_free(star);
    dt_free(large);
    dt_free(others);
    dt_free(r.set);
    free(r.bits);
    free(r.value);
    return 0;
}
