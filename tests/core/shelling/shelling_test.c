/* shelling_test.c - the paper's engine: against the definition, and on every family. */
#include "core/shelling/shelling.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/exact/predicates.h"
#include "core/mesh/hull.h"
#include "tests/core/polls.h"
#include "tests/oracle/definition.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

/* A set and the engine's result. */
struct built {
    struct dt_point *in, *p;
    uint32_t *from, n;
    struct dt_mesh mesh;
};

static struct built set_of(uint32_t n)
{
    return (struct built){.in = calloc(n + 1, sizeof(struct dt_point)),
                          .p = calloc(n + 1, sizeof(struct dt_point)),
                          .from = calloc(n + 1, sizeof(uint32_t)),
                          .n = n};
}

static struct built set_of_family(const char *family, uint32_t n, uint64_t seed)
{
    struct built b = set_of(n);
    family_points(family_find(family), b.in, n, seed);
    b.n = keep_distinct(b.in, n);
    return b;
}

static void built_free(struct built *b)
{
    free(b->in);
    free(b->p);
    free(b->from);
    dt_mesh_clear(&b->mesh);
}

static void build(struct built *b)
{
    CHECK(dt_shelling(b->in, b->n, b->p, b->from, &b->mesh, NULL) == DT_OK);
    const char *fault = mesh_fault(&b->mesh, b->p, b->n);
    CHECK_MSG(fault == NULL, "%s", fault);
    for (uint32_t v = 0; v < b->n; v++)
        CHECK(dt_compare_xy(b->p[v], b->in[b->from[v]]) == 0);
}

static void check_against_definition(struct built *b)
{
    build(b);
    struct triangle *got = malloc((2 * b->n + 1) * sizeof *got);
    struct triangle *want = malloc((2 * b->n + 1) * sizeof *want);
    uint32_t n = mesh_triangles(&b->mesh, b->from, got);
    CHECK(n == defined_triangles(b->in, b->n, want));
    CHECK(memcmp(got, want, n * sizeof *got) == 0);
    free(got);
    free(want);
}

TEST(shelling_makes_the_triangles_of_the_definition)
{
    for (const struct family *f = families; f->name != NULL; f++)
        for (uint32_t n = 0; n <= 24; n += n < 9 ? 1 : 5) {
            struct built b = set_of_family(f->name, n, test_random());
            check_against_definition(&b);
            built_free(&b);
        }
}

TEST(shelling_breaks_the_ties_of_random_lattices_by_the_rule)
{
    for (unsigned round = 0; round < 400; round++) {
        struct built b = set_of(4 + test_below(24));
        uint32_t side = 2 + test_below(5);
        for (uint32_t i = 0; i < b.n; i++)
            b.in[i] = (struct dt_point){test_below(side), test_below(side)};
        b.n = keep_distinct(b.in, b.n);
        check_against_definition(&b);
        built_free(&b);
    }
}

TEST_TIMEOUT(shelling_is_right_on_every_family, 60)
{
    for (const struct family *f = families; f->name != NULL; f++) {
        struct built b = set_of_family(f->name, f->hostile ? 300 : 5000, test_random());
        build(&b);
        built_free(&b);
    }
}

TEST(points_on_a_line_are_chained_in_order)
{
    for (unsigned round = 0; round < 50; round++) {
        struct built b = set_of(2 + test_below(30));
        for (uint32_t i = 0; i < b.n; i++)
            b.in[i] = (struct dt_point){3 * (double)i, -2 * (double)i};
        keep_distinct(b.in, b.n);
        build(&b);
        CHECK(dt_mesh_is_line(&b.mesh) && dt_mesh_edges(&b.mesh) == b.n - 1);
        uint32_t g = dt_hull_first(&b.mesh, b.from, false), last = dt_hull_vertex(&b.mesh, g);
        double step = 0; /* from one end to the other */
        for (uint32_t i = 1; i < b.n; i++, last = dt_hull_vertex(&b.mesh, g)) {
            g = dt_hull_step(&b.mesh, g, false);
            step = i == 1 ? b.p[dt_hull_vertex(&b.mesh, g)].x - b.p[last].x : step;
            CHECK(fabs(step) == 3 && b.p[dt_hull_vertex(&b.mesh, g)].x == b.p[last].x + step);
        }
        built_free(&b);
    }
}

TEST(two_points_make_one_edge_and_one_point_none)
{
    struct built b = set_of(2);
    b.in[0] = (struct dt_point){1, 1};
    build(&b);
    CHECK(b.mesh.tri_end == 2 && dt_twin(&b.mesh, 0) == 8 && dt_mesh_triangles(&b.mesh) == 0);
    b.n = 1;
    build(&b);
    CHECK(b.mesh.tri_end == 0 && b.mesh.leaving[0] == DT_NONE && b.mesh.vertices == 1);
    b.n = 0;
    build(&b);
    CHECK(b.mesh.vertices == 0);
    built_free(&b);
}

/* The paper's two ways to the hull. The boundary edges, in the order they were found, hook up to one polygon. The
 * points that remain in the grid are its corners, with pointers along it. */
static void check_hull_both_ways(const char *family, uint32_t n)
{
    struct built b = set_of_family(family, n, test_random());
    struct dt_shell s = {.mesh = NULL};
    bool line;
    CHECK(dt_mesh_reserve(&b.mesh, b.n, 2 * b.n) == DT_OK);
    CHECK(dt_shell_grow(&s, b.in, b.n, b.p, b.from, &b.mesh, NULL, &line) == DT_OK);
    uint32_t remaining = 0, edges = 0, *after = malloc(b.n * sizeof *after);
    memset(after, 0xff, b.n * sizeof *after);
    for (uint32_t h = 0; h < 8 * b.mesh.tri_end; h += 8)
        if (dt_is_ghost(&b.mesh, h)) {
            CHECK(after[b.mesh.half[h]] == DT_NONE);
            after[b.mesh.half[h]] = b.mesh.half[h + 1];
            edges++;
        }
    for (uint32_t v = 0; v < b.n; v++) {
        bool remains = !dt_grid_removed(&s.grid, v);
        remaining += remains;
        CHECK((after[v] != DT_NONE) == remains);
        CHECK(after[v] == s.front.node[v].next);
        CHECK(!remains || s.front.node[s.front.node[v].next].previous == v);
    }
    CHECK(line || edges >= 3);
    CHECK(remaining == edges && edges == b.mesh.ghosts);
    uint32_t start = 0, walked = 0, v;
    while (dt_grid_removed(&s.grid, start))
        start++;
    v = start;
    do
        v = after[v];
    while (++walked < b.n && v != start);
    CHECK(walked == edges);
    free(after);
    dt_shell_clear(&s);
    built_free(&b);
}

TEST(boundary_edges_and_points_left_in_the_grid_are_the_same_hull)
{
    check_hull_both_ways("uniform", 3000);
    check_hull_both_ways("gaussian", 500);
    check_hull_both_ways("lattice", 400);
    check_hull_both_ways("circle_exact", 100);
    check_hull_both_ways("cross", 200);
    check_hull_both_ways("nested", 300);
    check_hull_both_ways("uniform", 3);
}

TEST(shelling_reuses_the_room_of_a_mesh)
{
    struct built b = set_of_family("uniform", 500, 7);
    build(&b);
    uint32_t *half = b.mesh.half;
    b.n = 400;
    build(&b);
    CHECK(b.mesh.half == half);
    built_free(&b);
}

TEST(shelling_fails_cleanly_when_memory_runs_out)
{
    static const char *const names[] = {"clusters", "uniform", "line_diagonal"};
    for (unsigned i = 0; i < 3; i++)
        for (long nth = 1;; nth++) {
            struct built b = set_of_family(names[i], 2000, 5);
            test_fail_alloc(nth);
            enum dt_status status = dt_shelling(b.in, b.n, b.p, b.from, &b.mesh, NULL);
            bool failed = test_alloc_failed();
            test_fail_alloc(0);
            CHECK(status == DT_OK || (failed && status == DT_NOMEM));
            if (status == DT_OK)
                CHECK(mesh_fault(&b.mesh, b.p, b.n) == NULL);
            else
                CHECK(b.mesh.half == NULL && b.mesh.leaving == NULL && b.mesh.vertices == 0);
            built_free(&b);
            if (!failed)
                break;
        }
}

TEST(shelling_stops_when_cancelled_and_reports_progress)
{
    atomic_bool cancel = true;
    atomic_uint progress = 1000;
    struct dt_options opt = {.cancel = &cancel, .progress = &progress};
    struct built b = set_of_family("uniform", 3000, 5);
    CHECK(dt_shelling(b.in, b.n, b.p, b.from, &b.mesh, &opt) == DT_CANCELLED);
    CHECK(b.mesh.half == NULL && progress == 0);
    cancel = false;
    CHECK(dt_shelling(b.in, b.n, b.p, b.from, &b.mesh, &opt) == DT_OK);
    CHECK(progress > 95 && progress <= 100);
    built_free(&b);
}

/* Points on all scales that coordinates may have, near the axes and far out. */
static struct built set_of_scales(uint32_t n, bool mirrored)
{
    struct built b = set_of(n);
    for (uint32_t i = 0; i < n; i++) {
        b.in[i] =
            (struct dt_point){exp2(280 * test_uniform() - 140), exp2(280 * test_uniform() - 140)};
        if (mirrored && i % 4 != 0)
            b.in[i] = (struct dt_point){i % 4 == 1 ? -b.in[i - i % 4].x : b.in[i - i % 4].x,
                                        i % 4 == 2 ? -b.in[i - i % 4].y : b.in[i - i % 4].y};
        if (mirrored && i % 4 == 3)
            b.in[i] = (struct dt_point){-b.in[i - 3].x, -b.in[i - 3].y};
    }
    b.n = keep_distinct(b.in, n);
    return b;
}

/* Sets that defeat the grid, each in its own way; false: there are no more of them. */
static bool hostile_set(int which, uint32_t n, struct built *b)
{
    static const char *const family[] = {"near_collinear", "circle_exact", "thin_line",
                                         "tall",           "exponents",    "two_lines"};
    if (which < 2)
        *b = set_of_scales(n, which == 1);
    else if (which < 8)
        *b = set_of_family(family[which - 2], n, test_random());
    return which < 8;
}

/* A poll at the end of each 2^19 steps. */
TEST_TIMEOUT(shelling_of_any_set_stops_when_its_budget_is_spent, 60)
{
    enum { N = 5000, STEPS = (1 << 25) + 8192 * N, PER_POLL = 1 << 19, PASSES = 1000 };
    struct built b;
    int given_up = 0;
    for (int which = 0; hostile_set(which, N, &b); which++) {
        polls_begin();
        enum dt_status status = dt_shelling(b.in, b.n, b.p, b.from, &b.mesh, NULL);
        polls_end();
        CHECK(status == DT_OK || status == DT_TOOBIG);
        CHECK((b.mesh.half == NULL) == (status == DT_TOOBIG));
        CHECK_MSG(polls_count() < STEPS / PER_POLL + PASSES, "set %d: %d polls", which,
                  (int)polls_count());
        CHECK_MSG(polls_longest_ms() < 500, "set %d: %.1f ms without a poll", which,
                  polls_longest_ms());
        CHECK(status == DT_OK || polls_count() > STEPS / PER_POLL / 2);
        given_up += status == DT_TOOBIG;
        built_free(&b);
    }
    CHECK(given_up >= 4);
}

/* One search alone looks at all points here. */
TEST_TIMEOUT(shelling_stops_at_any_poll_on_every_kind_of_set, 60)
{
    struct built b;
    for (int which = 0; hostile_set(which, 1500, &b); which++) {
        enum dt_status status = DT_CANCELLED;
        for (uint64_t nth = 1; status == DT_CANCELLED; nth += 1 + nth / 4) {
            polls_begin();
            polls_cancel_at(nth);
            status = dt_shelling(b.in, b.n, b.p, b.from, &b.mesh, NULL);
            CHECK_MSG(status != DT_CANCELLED || polls_count() < nth + 100, "set %d", which);
            CHECK((b.mesh.half == NULL) == (status != DT_OK));
        }
        built_free(&b);
    }
    polls_begin();
}

TEST(shelling_of_points_on_a_line_stops_at_any_poll)
{
    enum { N = 70000 };
    struct built b = set_of(N);
    enum dt_status status = DT_CANCELLED;
    for (uint32_t i = 0; i < N; i++)
        b.in[i] = (struct dt_point){(i * 7919u) % N, 2.0 * ((i * 7919u) % N)};
    for (uint64_t nth = 1; status == DT_CANCELLED; nth += 1 + nth) {
        polls_begin();
        polls_cancel_at(nth);
        status = dt_shelling(b.in, N, b.p, b.from, &b.mesh, NULL);
    }
    CHECK(status == DT_OK && dt_mesh_is_line(&b.mesh) && mesh_fault(&b.mesh, b.p, N) == NULL);
    polls_begin();
    built_free(&b);
}
