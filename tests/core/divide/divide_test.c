/* divide_test.c - the divide engine: every family, every size, any number of threads. */
#include <stdlib.h>
#include <string.h>

#include "core/divide/divide.h"
#include "core/divide/divide_level.h"
#include "core/exact/predicates.h"
#include "tests/core/mesh_check.h"
#include "tests/core/threads.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

struct built {
    struct dt_point *in, *p;
    uint32_t *from, n;
    struct dt_mesh mesh;
};

static int compare_points(const void *a, const void *b)
{
    return dt_compare_xy(*(const struct dt_point *)a, *(const struct dt_point *)b);
}

/* The distinct points among n of a family, shuffled. */
static struct built distinct_points(const char *family, uint32_t n, uint64_t seed)
{
    struct built b = {.in = malloc((n + 1) * sizeof *b.in),
                      .p = malloc((n + 1) * sizeof *b.p),
                      .from = malloc((n + 1) * 4)};
    family_points(family_find(family), b.in, n, seed);
    qsort(b.in, n, sizeof *b.in, compare_points);
    for (uint32_t i = 0; i < n; i++)
        if (b.n == 0 || compare_points(&b.in[i], &b.in[b.n - 1]) != 0)
            b.in[b.n++] = b.in[i];
    for (uint32_t i = b.n; i > 1; i--) {
        uint32_t j = test_below(i);
        struct dt_point t = b.in[i - 1];
        b.in[i - 1] = b.in[j];
        b.in[j] = t;
    }
    return b;
}

static void built_free(struct built *b)
{
    free(b->in);
    free(b->p);
    free(b->from);
    dt_mesh_clear(&b->mesh);
}

/* The mesh is right, and its vertices are the points. */
static void check_built(const struct built *b)
{
    const struct dt_mesh *m = &b->mesh;
    CHECK(m->vertices == b->n && m->tri_end == (b->n < 2 ? 0 : 2 * b->n - 2) && m->dead == 0);
    mesh_check(m, b->p);
    for (uint32_t v = 0; v < b->n; v++)
        CHECK(compare_points(&b->p[v], &b->in[b->from[v]]) == 0);
}

static void build_and_check(const char *family, uint32_t n, uint64_t seed,
                            const struct dt_options *opt)
{
    struct built b = distinct_points(family, n, seed);
    CHECK(dt_divide(b.in, NULL, b.n, b.p, b.from, &b.mesh, opt) == DT_OK);
    check_built(&b);
    built_free(&b);
}

TEST(divide_triangulates_every_family_of_up_to_forty_points)
{
    for (const struct family *f = families; f->name != NULL; f++)
        for (uint32_t n = 0; n <= 40; n++)
            build_and_check(f->name, n, test_random(), NULL);
}

TEST_TIMEOUT(divide_triangulates_every_family_of_thousands, 60)
{
    for (const struct family *f = families; f->name != NULL; f++) {
        build_and_check(f->name, 700, test_random(), NULL);
        build_and_check(f->name, 20000, test_random(), NULL);
    }
}

TEST(divide_triangulates_dense_integer_lattices_in_any_order)
{
    for (unsigned round = 0; round < 300; round++) {
        struct built b = distinct_points("uniform", 60, 1);
        uint32_t side = 2 + test_below(7), n = 0;
        for (uint32_t i = 0; i < 60; i++)
            b.in[i] = (struct dt_point){test_below(side), test_below(side)};
        qsort(b.in, 60, sizeof *b.in, compare_points);
        for (uint32_t i = 0; i < 60; i++)
            if (n == 0 || compare_points(&b.in[i], &b.in[n - 1]) != 0)
                b.in[n++] = b.in[i];
        b.n = n;
        CHECK(dt_divide(b.in, NULL, b.n, b.p, b.from, &b.mesh, NULL) == DT_OK);
        check_built(&b);
        built_free(&b);
    }
}

TEST_TIMEOUT(divide_gives_the_same_mesh_on_any_number_of_threads, 60)
{
    for (const struct family *f = families; f->name != NULL; f++) {
        for (unsigned threads = 2; threads <= 5; threads += 3) {
            struct dt_pool pool = threads_pool(threads);
            struct dt_options opt = {.pool = &pool};
            build_and_check(f->name, DT_PARALLEL + test_below(9000), test_random(), &opt);
        }
    }
}

static void one_after_the_other(void *ctx, unsigned n, void (*job)(void *arg, unsigned i),
                                void *arg)
{
    (void)ctx;
    for (unsigned i = 0; i < n; i++)
        job(arg, i);
}

TEST(divide_gives_the_same_mesh_where_the_most_threads_would_share_it)
{
    static const char *const family[] = {"nested", "kuzmin", "near_collinear", "one_cell"};
    struct dt_pool pool = {.threads = DT_MAX_THREADS, .run = one_after_the_other};
    struct dt_options opt = {.pool = &pool};
    for (size_t i = 0; i < sizeof family / sizeof *family; i++)
        build_and_check(family[i], 20000, test_random(), &opt);
}

/* The bytes a point that a build takes at its peak besides its result, for arrays of 3 MiB or
 * more. */
static double scratch_of(const struct built *b, unsigned threads)
{
    struct dt_pages *pages = dt_pages_new(SIZE_MAX);
    struct dt_mesh mesh = {.pages = pages};
    struct dt_pool pool = {.threads = threads, .run = one_after_the_other};
    struct dt_pages_summary f;
    CHECK(dt_divide(b->in, NULL, b->n, b->p, b->from, &mesh, &(struct dt_options){.pool = &pool}) ==
          DT_OK);
    dt_pages_summary(pages, &f); /* nothing has been given back to the system */
    dt_mesh_clear(&mesh);
    dt_pages_free(pages);
    return (double)f.held / b->n - 68;
}

TEST_TIMEOUT(scratch_memory_does_not_grow_with_the_number_of_threads, 120)
{
    if (test_is_sanitized())
        SKIP("a sanitizer adds memory of its own");
    static const char *const family[] = {"kuzmin", "exponents"};
    enum { N = 1000000, ONE = 18, MOST = 24 }; /* bytes a point */
    for (size_t i = 0; i < sizeof family / sizeof *family; i++) {
        struct built b = {.in = malloc(N * sizeof *b.in),
                          .p = malloc(N * sizeof *b.p),
                          .from = malloc(N * sizeof *b.from),
                          .n = N};
        family_points(family_find(family[i]), b.in, N, 1); /* no two of these are the same */
        double one = scratch_of(&b, 1), many = scratch_of(&b, DT_MAX_THREADS);
        CHECK_MSG(one < ONE && many < MOST, "%s: %.1f and %.1f bytes a point", family[i], one,
                  many);
        built_free(&b);
    }
}

TEST_TIMEOUT(divide_sorts_large_sets_into_tiles, 60)
{
    struct dt_pool pool = threads_pool(2);
    struct dt_options opt = {.pool = &pool};
    build_and_check("uniform", DT_TILED + 5, 1, NULL);
    build_and_check("clusters", DT_TILED + 5, 2, &opt);
    build_and_check("kuzmin", DT_TILED + 5, 3, &opt);
}

/* Fails each allocation, one after the other. */
static void fail_cleanly(uint32_t n, const struct dt_options *opt)
{
    for (long nth = 1;; nth++) {
        struct built b = distinct_points("nested", n, 5);
        test_fail_alloc(nth);
        enum dt_status status = dt_divide(b.in, NULL, b.n, b.p, b.from, &b.mesh, opt);
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        if (failed)
            CHECK(status == DT_NOMEM && b.mesh.half == NULL && b.mesh.tri_end == 0);
        else
            check_built(&b);
        built_free(&b);
        if (!failed)
            return;
    }
}

TEST_TIMEOUT(divide_finds_single_points_in_neighbouring_tiles, 60)
{
    static const struct dt_point lonely[] = {{0, 0}, {0.2, 0.01}, {0.01, 0.3}, {0.3, 0.3}, {0, 1}};
    struct built b = distinct_points("uniform", DT_TILED + 100, 1);
    for (uint32_t i = 0; i < b.n; i++)
        b.in[i].x = 0.5 + b.in[i].x / 2;
    memcpy(b.in, lonely, sizeof lonely);
    CHECK(dt_divide(b.in, NULL, b.n, b.p, b.from, &b.mesh, NULL) == DT_OK);
    check_built(&b);
    built_free(&b);
}

TEST(divide_fails_cleanly_when_memory_runs_out)
{
    fail_cleanly(3000, NULL);
}

TEST(divide_fails_cleanly_when_memory_for_tasks_runs_out)
{
    struct dt_pool pool = {.threads = 3, .run = one_after_the_other};
    fail_cleanly(DT_PARALLEL + 100, &(struct dt_options){.pool = &pool});
}

TEST(divide_stops_when_cancelled)
{
    atomic_bool cancel = true;
    struct dt_options opt = {.cancel = &cancel};
    struct built b = distinct_points("uniform", 1000, 5);
    CHECK(dt_divide(b.in, NULL, b.n, b.p, b.from, &b.mesh, &opt) == DT_CANCELLED);
    CHECK(b.mesh.half == NULL);
    built_free(&b);
}

TEST(divide_settles_large_hulls_the_same_way_on_several_threads)
{
    static const char *const family[] = {"circle", "parabola", "near_collinear", "line_diagonal"};
    struct dt_pool pool = threads_pool(3);
    for (size_t i = 0; i < sizeof family / sizeof *family; i++) {
        struct built a = distinct_points(family[i], 20000, i),
                     b = distinct_points(family[i], 20000, i);
        CHECK(dt_divide(a.in, NULL, a.n, a.p, a.from, &a.mesh, NULL) == DT_OK);
        CHECK(dt_divide(b.in, NULL, b.n, b.p, b.from, &b.mesh,
                        &(struct dt_options){.pool = &pool}) == DT_OK);
        CHECK(a.mesh.hull == b.mesh.hull && a.mesh.ghosts == b.mesh.ghosts);
        CHECK(memcmp(a.mesh.leaving, b.mesh.leaving, a.n * sizeof *a.mesh.leaving) == 0);
        built_free(&a);
        built_free(&b);
    }
}

/* Cancels a build before one of the passes that threads share. */
struct canceller {
    atomic_bool cancel;
    unsigned passes, last;
};

static void run_and_cancel(void *ctx, unsigned n, void (*job)(void *arg, unsigned i), void *arg)
{
    struct canceller *c = ctx;
    if (++c->passes == c->last)
        atomic_store(&c->cancel, true);
    one_after_the_other(NULL, n, job, arg);
}

TEST(divide_stops_when_cancelled_before_any_pass)
{
    enum dt_status status = DT_CANCELLED;
    struct canceller c = {.last = 1};
    for (; status == DT_CANCELLED; c.last++) {
        struct dt_pool pool = {.threads = 2, .run = run_and_cancel, .ctx = &c};
        struct dt_options opt = {.pool = &pool, .cancel = &c.cancel};
        struct built b = distinct_points("nested", DT_PARALLEL + 100, 5);
        atomic_store(&c.cancel, false);
        c.passes = 0;
        status = dt_divide(b.in, NULL, b.n, b.p, b.from, &b.mesh, &opt);
        CHECK(status == (c.passes < c.last ? DT_OK : DT_CANCELLED));
        CHECK((b.mesh.half == NULL) == (status == DT_CANCELLED));
        built_free(&b);
    }
    CHECK(c.last > 8);
}

TEST(points_beyond_a_grid_belong_to_its_outermost_cells)
{
    struct dt_arena arena = {0};
    struct dt_order o;
    struct dt_point middle = {4, 4};
    struct dt_box box = {{0, 0}, {8, 8}};
    dt_order_plan(&o, box, 64, &middle, 1);
    CHECK(dt_order_tables(&o, &arena) == DT_OK);
    CHECK(dt_order_key(&o, (struct dt_point){-0x1p201, 3.5}) ==
          dt_order_key(&o, (struct dt_point){0.5, 3.5}));
    CHECK(dt_order_key(&o, (struct dt_point){0x1p201, 3.5}) ==
          dt_order_key(&o, (struct dt_point){7.5, 3.5}));
    CHECK(dt_order_key(&o, (struct dt_point){2.5, -0x1p-142}) ==
          dt_order_key(&o, (struct dt_point){2.5, 0}));
    CHECK(dt_order_key(&o, (struct dt_point){2.5, 8}) ==
          dt_order_key(&o, (struct dt_point){2.5, 7.5}));
    dt_arena_clear(&arena);
}
