/* surface.c - the cost of values between points, Voronoi cells and contours, compared with CGAL.
 *
 *     surface N K [PEER]    a raster of K cells, K random places, and all cells and contours of N uniform points; PEER:
 *                           the program built from cgal_surface.cpp
 *
 * Both programs draw the same points and places from the same seeds (live_plan.h). A figure is the least of ROUNDS runs. */
#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "tests/bench/measure.h"
#include "tests/bench/pool.h"
#include "tests/bench/set/live_plan.h"
#include "tests/bench/set/surface_plan.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { ROUNDS = 3 };

static const char *const name[SURFACE_KINDS] = {
    [SURFACE_LINEAR] = "raster, linear, per cell",
    [SURFACE_LINEAR_TWO_THREADS] = "the same on two threads, elapsed",
    [SURFACE_NATURAL] = "raster, natural (Sibson), per cell",
    [SURFACE_LAPLACE] = "raster, Laplace, per cell",
    [SURFACE_LINEAR_ANYWHERE] = "random places, linear",
    [SURFACE_NATURAL_ANYWHERE] = "random places, natural (Sibson)",
    [SURFACE_CELLS] = "Voronoi cells, clipped, per cell",
    [SURFACE_CELLS_FRESH] = "the same in memory that the process has not used before",
    [SURFACE_AREAS] = "areas of the cells, per cell",
    [SURFACE_CONTOURS] = "contours of 20 levels, per point of the set",
    [SURFACE_BANDS] = "bands between 20 levels, per point of the set",
    [SURFACE_VOLUME] = "the volume above a level, per point of the set",
    [SURFACE_VOLUME_BOX] = "the same in a box of a quarter of them",
    [SURFACE_VOLUME_INSIDE] = "the same inside a border around a quarter of them",
    [SURFACE_ANGLES] = "counts of triangles by their least angle, per point of the set",
    [SURFACE_PROFILE] = "a profile from side to side, each",
};

struct surface {
    struct dt_pages *pages;
    struct dt *set;
    struct live_plan plan;
    struct dt_raster raster;
    struct dt_surface surface;
    struct pool *pool;
    double *value; /* k */
    double ns[SURFACE_KINDS];
};

static void must(bool ok)
{
    if (ok)
        return;
    fprintf(stderr, "surface: out of memory\n");
    exit(1);
}

static double elapsed(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fill(struct surface *s, enum surface_kind kind)
{
    struct dt_pool pool = pool_face(s->pool);
    bool two = kind == SURFACE_LINEAR_TWO_THREADS;
    struct dt_options opt = {.pool = two ? &pool : NULL};
    bool raster = kind < SURFACE_LINEAR_ANYWHERE;
    size_t done, k = raster ? (size_t)s->raster.columns * s->raster.rows : s->plan.k;
    double start = two ? elapsed() : measure_cpu();
    if (raster)
        must(dt_raster_values(s->set, &s->surface, &s->raster, 0, k, &opt, s->value, &done) ==
             DT_OK);
    else
        must(dt_values(s->set, &s->surface, s->plan.query, k, &opt, s->value, &done) == DT_OK);
    s->ns[kind] = two ? (elapsed() - start) * 1e9 / (double)k : live_ns(start, k);
}

static void values(struct surface *s, enum surface_kind kind, enum dt_interpolation how)
{
    s->surface.how = how;
    fill(s, kind);
}

/* Makes all cells, or their areas. */
static void make_cells(struct surface *s, bool areas, struct dt_cells *c,
                       struct dt_cells_made **made)
{
    struct dt_bounds b = {0};
    struct dt_point lo, hi;
    *made = NULL;
    for (bool done = false; !done;)
        must(dt_bounds_read(s->set, NULL, &b, 1 << 16, &done) == DT_OK);
    dt_bounds_grow(&b, &lo, &hi);
    must(dt_cells_begin(s->set, NULL, lo, hi, c) == DT_OK);
    must((areas ? dt_areas_make_begin : dt_cells_make_begin)(s->set, c, made) == DT_OK);
    for (bool done = *made == NULL; !done;)
        must(dt_cells_make(s->set, *made, NULL, 1 << 12, &done) == DT_OK);
    c->made = *made;
}

static void cells(struct surface *s, enum surface_kind kind)
{
    enum { SOME = 1024, CORNERS = 1 << 14 };
    static struct dt_cell cell[SOME];
    static struct dt_point corner[CORNERS];
    struct dt_cells c;
    struct dt_cells_made *made;
    size_t n, corners, all = 0;
    double start = measure_cpu();
    make_cells(s, false, &c, &made);
    do {
        must(dt_cells_read(s->set, &c, cell, SOME, corner, CORNERS, &n, &corners) == DT_OK);
        all += n;
    } while (n > 0);
    dt_cells_made_free(made);
    s->ns[kind] = live_ns(start, all);
}

static void areas(struct surface *s)
{
    enum { SOME = 1024 };
    static uint32_t id[SOME];
    static double area[SOME];
    struct dt_cells c;
    struct dt_cells_made *made;
    size_t n, all = 0;
    double sum = 0, start = measure_cpu();
    make_cells(s, true, &c, &made);
    must(made != NULL);
    while ((n = dt_areas_read(&c, id, area, SOME)) > 0) {
        for (size_t i = 0; i < n; i++)
            sum += area[i];
        all += n;
    }
    dt_cells_made_free(made);
    s->ns[SURFACE_AREAS] = live_ns(start, all);
    must(fabs(sum / ((c.hi.x - c.lo.x) * (c.hi.y - c.lo.y)) - 1) < 1e-12);
}

/* With fresh memory first: then it is used. */
static void all_cells(struct surface *s)
{
    (void)dt_pages_trim(s->pages, SIZE_MAX);
    cells(s, SURFACE_CELLS_FRESH);
    cells(s, SURFACE_CELLS);
    areas(s);
}

static void contours(struct surface *s)
{
    double level[SURFACE_LEVELS], start = measure_cpu();
    struct dt_contour *c;
    const struct dt_contour_line *line;
    size_t lines;
    for (int i = 0; i < SURFACE_LEVELS; i++)
        level[i] = 2 * (i + 0.5) / SURFACE_LEVELS - 1;
    must(dt_contour_begin(s->set, NULL, dt_field_find(s->set, "z", 1), level, SURFACE_LEVELS,
                          HUGE_VAL, &c) == DT_OK);
    for (bool done = false; !done;)
        must(dt_contour_read(s->set, c, &done) == DT_OK);
    must(dt_contour_end(c, NULL, &line, &lines) == DT_OK);
    dt_contour_free(c);
    s->ns[SURFACE_CONTOURS] = live_ns(start, s->plan.n);
}

static void bands(struct surface *s)
{
    double level[SURFACE_LEVELS], start = measure_cpu();
    struct dt_bands *b;
    const struct dt_band_ring *ring;
    size_t rings;
    for (int i = 0; i < SURFACE_LEVELS; i++)
        level[i] = 2 * (i + 0.5) / SURFACE_LEVELS - 1;
    must(dt_bands_begin(s->set, NULL, dt_field_find(s->set, "z", 1), level, SURFACE_LEVELS,
                        HUGE_VAL, &b) == DT_OK);
    for (bool done = false; !done;)
        must(dt_bands_read(s->set, b, &done) == DT_OK);
    must(dt_bands_end(b, NULL, &ring, &rings) == DT_OK && rings > 0);
    dt_bands_free(b);
    s->ns[SURFACE_BANDS] = live_ns(start, s->plan.n);
}

static const struct dt_point quarter_lo = {0.25, 0.25}, quarter_hi = {0.75, 0.75};

static void volume(struct surface *s, int kind)
{
    double start = measure_cpu();
    struct dt_volume *v;
    struct dt_volumes sums;
    must(dt_volume_begin(s->set, NULL, dt_field_find(s->set, "z", 1), NULL, 0.25, &v) == DT_OK);
    if (kind == SURFACE_VOLUME_BOX)
        dt_volume_clip(v, quarter_lo, quarter_hi);
    if (kind == SURFACE_VOLUME_INSIDE)
        must(dt_volume_inside(v, s->set, DT_NONE) == DT_OK);
    for (bool done = false; !done;)
        must(dt_volume_read(s->set, v, &done) == DT_OK);
    dt_volume_end(v, &sums);
    dt_volume_free(v);
    must(sums.area > 0.2 && sums.area < (kind == SURFACE_VOLUME ? 1 : 0.3));
    s->ns[kind] = live_ns(start, s->plan.n);
}

/* The border is declared for this measurement alone. */
static void volume_inside(struct surface *s)
{
    const struct dt_point corner[] = {
        quarter_lo, {quarter_hi.x, quarter_lo.y}, quarter_hi, {quarter_lo.x, quarter_hi.y}};
    struct dt_constraint c[4];
    struct dt_ids found = {0};
    size_t n, gone;
    uint32_t missing;
    for (int k = 0; k < 4; k++)
        must(dt_nearest(s->set, corner[k], 1, &found) == DT_OK && found.n == (size_t)k + 1);
    for (int k = 0; k < 4; k++)
        c[k] = (struct dt_constraint){found.v[k], found.v[(k + 1) % 4], true, 0};
    must(dt_constrain(s->set, c, 4, NULL, &n, &missing) == DT_OK);
    must(dt_survey(s->set, NULL) == DT_OK);
    volume(s, SURFACE_VOLUME_INSIDE);
    must(dt_release(s->set, c, 4, NULL, &n, &gone) == DT_OK && n == 4);
    free(found.v);
}

static void angles(struct surface *s)
{
    double start = measure_cpu();
    struct dt_measure *m;
    struct dt_shapes shapes;
    must(dt_measure_begin(s->set, NULL, &m) == DT_OK);
    for (bool done = false; !done;)
        must(dt_measure_read(s->set, m, &done) == DT_OK);
    dt_measure_end(m, &shapes);
    dt_measure_free(m);
    must(shapes.least < shapes.largest && shapes.area < 1);
    s->ns[SURFACE_ANGLES] = live_ns(start, s->plan.n);
}

static void profiles(struct surface *s)
{
    enum { SOME = 1024 };
    static struct dt_profile_row row[SOME];
    double start = measure_cpu(), length = 0;
    s->surface.how = DT_LINEAR;
    for (int i = 0; i < SURFACE_PROFILES; i++) {
        struct dt_point way[] = {{0, surface_begin(i)}, {1, 1 - surface_begin(i)}};
        struct dt_profile *p;
        size_t n;
        must(dt_profile_begin(s->set, &s->surface, way, 2, NULL, &p) == DT_OK);
        do {
            must(dt_profile_read(p, row, SOME, &n) == DT_OK);
            length = n > 0 ? row[n - 1].distance : length;
        } while (n > 0);
        dt_profile_free(p);
        must(length >= 1);
    }
    s->ns[SURFACE_PROFILE] = live_ns(start, SURFACE_PROFILES);
}

static void begin(struct surface *s)
{
    struct dt_added added;
    uint32_t missing, side = (uint32_t)sqrt((double)s->plan.k);
    double *z = malloc(s->plan.n * sizeof *z);
    s->value = malloc((s->plan.k + 1) * sizeof *s->value);
    s->pages = dt_pages_new(SIZE_MAX);
    s->set = dt_new_in(0, s->pages);
    s->pool = pool_new(2);
    must(z != NULL && s->pages != NULL && s->value != NULL && s->set != NULL && s->pool != NULL);
    must(dt_add(s->set, s->plan.start, s->plan.n, &added) == DT_OK);
    for (size_t i = 0; i < s->plan.n; i++)
        z[i] = surface_height(s->plan.start[i].x, s->plan.start[i].y);
    must(dt_field_set_run(s->set, "z", 1, added.first, z, s->plan.n, NULL, &missing) == DT_OK);
    must(dt_triangulate(s->set, NULL) == DT_OK && dt_prepare(s->set, NULL) == DT_OK);
    must(dt_surface_begin(&s->surface, dt_field_find(s->set, "z", 1), NULL) == DT_OK);
    s->surface.max_edge = HUGE_VAL;
    s->raster = (struct dt_raster){{0, 0}, {1, 1}, side, side};
    free(z);
}

static void end(struct surface *s)
{
    dt_surface_end(&s->surface);
    dt_free(s->set);
    dt_pages_free(s->pages);
    pool_free(s->pool);
    free(s->value);
    live_plan_free(&s->plan);
}

static void measure(struct surface *s)
{
    values(s, SURFACE_LINEAR, DT_LINEAR);
    values(s, SURFACE_LINEAR_TWO_THREADS, DT_LINEAR);
    values(s, SURFACE_NATURAL, DT_NATURAL);
    values(s, SURFACE_LAPLACE, DT_LAPLACE);
    values(s, SURFACE_LINEAR_ANYWHERE, DT_LINEAR);
    values(s, SURFACE_NATURAL_ANYWHERE, DT_NATURAL);
    all_cells(s);
    contours(s);
    bands(s);
    volume(s, SURFACE_VOLUME);
    volume(s, SURFACE_VOLUME_BOX);
    angles(s);
    profiles(s);
}

/* The peer prints one number for each kind, 0 for what it does not measure. */
static void measure_peer(const char *peer, const struct live_plan *plan, double *ns)
{
    char command[512];
    FILE *f = NULL;
    if (peer != NULL) {
        snprintf(command, sizeof command, "%s %zu %zu", peer, plan->n, plan->k);
        f = popen(command, "r");
    }
    for (unsigned i = 0; i < SURFACE_KINDS; i++)
        if (f == NULL || fscanf(f, "%lf", &ns[i]) != 1)
            ns[i] = 0;
    if (f != NULL)
        pclose(f);
}

static void keep_least(double *least, const double *ns)
{
    for (unsigned i = 0; i < SURFACE_KINDS; i++)
        least[i] = least[i] == 0 || ns[i] < least[i] ? ns[i] : least[i];
}

int main(int argc, char **argv)
{
    if (argc < 3)
        return 2;
    struct surface s = {.plan =
                            live_plan_new(strtoul(argv[1], NULL, 10), strtoul(argv[2], NULL, 10))};
    double ours[SURFACE_KINDS] = {0}, least[SURFACE_KINDS] = {0}, peer[SURFACE_KINDS];
    begin(&s);
    for (int round = 0; round < ROUNDS; round++) {
        measure(&s);
        keep_least(ours, s.ns);
        measure_peer(argc > 3 ? argv[3] : NULL, &s.plan, peer);
        keep_least(least, peer);
    }
    for (int round = 0; round < ROUNDS; round++) { /* last: after an edit heights are read by id */
        volume_inside(&s);
        keep_least(ours, s.ns);
    }
    printf("Surfaces, %zu uniform points, %zu cells or places, ns each, one thread.\n\n", s.plan.n,
           s.plan.k);
    printf("| what | delaunayd | CGAL | ratio |\n|---|---|---|---|\n");
    for (unsigned i = 0; i < SURFACE_KINDS; i++) {
        printf("| %s | %.0f |", name[i], ours[i]);
        if (least[i] > 0)
            printf(" %.0f | %.3f |\n", least[i], ours[i] / least[i]);
        else
            printf(" - | - |\n");
    }
    printf("\n");
    end(&s);
    return 0;
}
