/* flip_test.c - vertices that move within their stars: after every move the mesh is the canonical
 * triangulation, and an abandoned move changes nothing. */
#include "core/edit/flip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/set/set.h"
#include "tests/core/mesh_check.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

static struct dt *set_of(const struct dt_point *p, uint32_t n)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(dt_add(t, p, n, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    return t;
}

/* Moves vertex v if its star allows that. Returns how many edges were flipped, -1 if it does
 * not. */
static int shift(struct dt *t, uint32_t v, struct dt_point to, struct dt_flips *f)
{
    bool allowed;
    CHECK(dt_star_allows(&t->mesh, t->points.xy, v, to, false, NULL, f, &allowed) == DT_OK);
    if (!allowed)
        return -1;
    struct dt_point from = t->points.xy[v];
    t->points.xy[v] = to;
    if (dt_flip_all(&t->mesh, t->points.xy, f, &t->scratch) == DT_OK)
        return (int)f->flipped;
    t->points.xy[v] = from;
    return -1;
}

/* From v towards another vertex, by any part of the way down to the last bit. */
static struct dt_point towards(const struct dt *t, uint32_t v, uint32_t u)
{
    struct dt_point p = t->points.xy[v], q = t->points.xy[u];
    double part = ldexp(1, -(int)test_below(60)) * (test_below(2) ? 1 : test_uniform());
    struct dt_point to = {p.x + (q.x - p.x) * part, p.y + (q.y - p.y) * part};
    return dt_coordinate_ok(to.x) && dt_coordinate_ok(to.y) ? to : p;
}

/* A neighbour of v, or the neighbour of one. */
static uint32_t near(const struct dt_mesh *m, uint32_t v)
{
    uint32_t h = m->leaving[v];
    for (uint32_t turns = test_below(12); turns > 0; turns--)
        h = dt_turn_ccw(m, h);
    uint32_t u = test_below(3) > 0 ? dt_dest(m, h) : dt_apex_of(m, dt_twin(m, dt_next(h)));
    return u == DT_NONE ? v : u;
}

TEST_TIMEOUT(moves_within_a_star_keep_the_mesh_canonical_on_every_family, 60)
{
    enum { N = 150, MOVES = 1200 };
    static struct dt_point p[N];
    static struct dt_flips f;
    uint64_t moves = 0, flips = 0;
    for (const struct family *family = families; family->name != NULL; family++) {
        family_points(family, p, N, test_random());
        struct dt *t = set_of(p, N);
        for (unsigned i = 0; i < MOVES && t->mesh.vertices > 3; i++) {
            uint32_t v = test_below(t->mesh.vertices);
            int n = shift(t, v, towards(t, v, near(&t->mesh, v)), &f);
            moves += n >= 0;
            flips += n > 0 ? (unsigned)n : 0;
            if (n >= 0)
                mesh_check(&t->mesh, t->points.xy);
        }
        dt_free(t);
    }
    CHECK_MSG(moves > 10000 && flips > 1000, "%lu moves, %lu flips", (unsigned long)moves,
              (unsigned long)flips);
}

TEST(nearly_every_vertex_can_move_by_a_tenth_of_the_point_distance_within_its_star)
{
    enum { N = 3000 };
    static struct dt_point p[N];
    static struct dt_flips f;
    unsigned moved = 0;
    family_points(family_find("uniform"), p, N, 3);
    struct dt *t = set_of(p, N);
    for (uint32_t v = 0; v < N; v++) {
        double angle = 6.283185307179586 * test_uniform(), step = 0.1 / sqrt(N);
        struct dt_point at = t->points.xy[v];
        struct dt_point to = {at.x + step * cos(angle), at.y + step * sin(angle)};
        moved += shift(t, v, to, &f) >= 0;
    }
    CHECK_MSG(moved > N * 19 / 20, "%u", moved);
    mesh_check(&t->mesh, t->points.xy);
    dt_free(t);
}

/* Two hubs within a circle: where one of them goes round the other, many spokes change hands. */
static struct dt *two_hubs(uint32_t n)
{
    struct dt_point *p = malloc((n + 2) * sizeof *p);
    p[0] = (struct dt_point){-0.001, 0};
    p[1] = (struct dt_point){0.001, 0};
    for (uint32_t i = 0; i < n; i++) {
        double a = 6.283185307179586 * (i + 0.3) / n;
        p[2 + i] = (struct dt_point){cos(a), sin(a)};
    }
    struct dt *t = set_of(p, n + 2);
    free(p);
    return t;
}

static const struct dt_point beside = {-0.0009, 0.0005};

TEST(a_move_that_needs_very_many_flips_is_left_to_others)
{
    static struct dt_flips f;
    for (uint32_t n = 40; n < 5000; n *= 5) {
        struct dt *t = two_hubs(n);
        uint32_t hub = dt_points_vertex(&t->points, 1);
        int flips = shift(t, hub, beside, &f);
        CHECK_MSG(n < 500 ? flips > (int)n / 10 && flips < (int)n : flips < 0, "%d of %u", flips,
                  n);
        mesh_check(&t->mesh, t->points.xy);
        CHECK(dt_move(t, 1, beside) == DT_OK);
        mesh_check(&t->mesh, t->points.xy);
        CHECK(t->points.xy[hub].x == beside.x);
        dt_free(t);
    }
}

TEST(flips_are_taken_back_wherever_work_ends)
{
    enum { N = 200 };
    static struct dt_flips f;
    struct dt *t = two_hubs(N);
    uint32_t hub = dt_points_vertex(&t->points, 1);
    size_t size = 8 * sizeof *t->mesh.half * t->mesh.tri_end;
    uint32_t *before = malloc(size);
    struct dt_point from = t->points.xy[hub];
    enum dt_status status = DT_TOOLONG;
    unsigned tries = 0;
    memcpy(before, t->mesh.half, size);
    for (uint64_t steps = 0; status == DT_TOOLONG; steps++, tries++) {
        struct dt_stop work = {.left = steps};
        bool allowed;
        CHECK(dt_star_allows(&t->mesh, t->points.xy, hub, beside, false, NULL, &f, &allowed) ==
              DT_OK);
        CHECK(allowed);
        t->scratch.work = &work;
        t->points.xy[hub] = beside;
        status = dt_flip_all(&t->mesh, t->points.xy, &f, &t->scratch);
        CHECK(status == DT_OK || status == DT_TOOLONG);
        if (status == DT_TOOLONG) {
            t->points.xy[hub] = from;
            CHECK(memcmp(t->mesh.half, before, size) == 0);
        }
        mesh_check(&t->mesh, t->points.xy);
    }
    CHECK_MSG(tries > N / 10, "%u", tries);
    t->scratch.work = NULL;
    free(before);
    dt_free(t);
}
