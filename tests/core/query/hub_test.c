/* hub_test.c - searches beside vertices with very many neighbours: they are correct, and do not
 * visit all of them. */
#include <math.h>
#include <stdlib.h>

#include "core/exact/predicates.h"
#include "core/set/set.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

static const double turn = 6.283185307179586;

enum shape { WHEEL, ROUGH, OFF_CENTRE, FAN, SPIRAL, TWO_HUBS, EXACT, SHAPES };

/* n points around one or two hubs, which come first. */
static void fill(enum shape shape, struct dt_point *p, uint32_t n)
{
    if (shape == EXACT) {
        family_points(family_find("wheel"), p, n, 3);
        return;
    }
    p[0] = (struct dt_point){shape == OFF_CENTRE ? 0.8 : 0, shape == FAN ? -1 : 0};
    for (uint32_t i = 1; i < n; i++) {
        double a = turn * i / n, r = 1;
        if (shape == ROUGH)
            r += 1e-6 * test_uniform();
        if (shape == SPIRAL)
            r += 1.0 * i / n;
        if (shape == FAN)
            a = 1 + 1.2 * i / n;
        p[i] = (struct dt_point){r * cos(a), r * sin(a)};
    }
    if (shape == TWO_HUBS) {
        p[0].x = -0.3;
        p[1] = (struct dt_point){0.3, 0.01};
    }
}

static struct dt *set_of_shape(enum shape shape, uint32_t n, struct dt_point *p)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    fill(shape, p, n);
    CHECK(dt_add(t, p, n, &added) == DT_OK && added.coincident == 0);
    CHECK(dt_triangulate(t, NULL) == DT_OK && dt_prepare(t, NULL) == DT_OK);
    return t;
}

/* A place near a hub, near another point, in the middle between two, or anywhere. */
static struct dt_point some_place(const struct dt_point *p, uint32_t n)
{
    struct dt_point a = p[test_below(2)], b = p[test_below(n)];
    double far = pow(10, -12 * test_uniform()), angle = turn * test_uniform();
    switch (test_below(6)) {
    case 0:
        return (struct dt_point){a.x + far * cos(angle), a.y + far * sin(angle)};
    case 1:
        return (struct dt_point){b.x + far * cos(angle), b.y + far * sin(angle)};
    case 2:
        return (struct dt_point){a.x + (b.x - a.x) / 2, a.y + (b.y - a.y) / 2};
    case 3:
        return a;
    case 4:
        return (struct dt_point){a.x + (b.x - a.x) * test_uniform(),
                                 a.y + (b.y - a.y) * test_uniform()};
    default:
        return (struct dt_point){4 * test_uniform() - 2, 4 * test_uniform() - 2};
    }
}

/* Whether point a comes before b among those nearest to q. */
static bool before(const struct dt_point *p, struct dt_point q, uint32_t a, uint32_t b)
{
    int sign = dt_compare_distance(q, p[a], p[b]);
    return sign != 0 ? sign < 0 : a < b;
}

/* That got[k] are the nearest of p[n], in order: each comes after the one before, and no other
 * before the last. */
static void check_nearest(const struct dt_point *p, uint32_t n, struct dt_point q,
                          const struct dt_ids *got, uint32_t k)
{
    CHECK(got->n == k);
    for (uint32_t i = 0; i + 1 < k; i++)
        CHECK(before(p, q, got->v[i], got->v[i + 1]));
    uint32_t nearer = 0;
    for (uint32_t i = 0; i < n; i++)
        nearer += before(p, q, i, got->v[k - 1]);
    CHECK_MSG(nearer == k - 1, "%u points are nearer than the one found as number %u", nearer, k);
}

TEST_TIMEOUT(nearest_points_beside_hubs_are_right, 60)
{
    enum { N = 3000 };
    static struct dt_point p[N];
    for (enum shape shape = WHEEL; shape < SHAPES; shape++) {
        for (unsigned round = 0; round < 6; round++) {
            uint32_t n = round % 2 == 0 ? N : 40 + test_below(200);
            struct dt *t = set_of_shape(shape, n, p);
            for (unsigned i = 0; i < 300; i++) {
                struct dt_point q = some_place(p, n);
                uint32_t k = i % 4 == 0 ? 1 + test_below(100) % n : 1 + i % 4;
                struct dt_ids got = {0};
                CHECK(dt_nearest(t, q, k, &got) == DT_OK);
                check_nearest(p, n, q, &got, k);
                free(got.v);
            }
            dt_free(t);
        }
    }
}

/* The root of the number of triangles is 632. */
TEST(the_nearest_point_next_to_a_hub_needs_few_steps)
{
    enum { N = 200000, STEPS = 8000 };
    struct dt_point *p = malloc(N * sizeof *p);
    const struct dt_options opt = {.steps = STEPS};
    for (enum shape shape = WHEEL; shape < EXACT; shape++) {
        struct dt *t = set_of_shape(shape, N, p);
        for (unsigned i = 0; i < 200; i++) {
            struct dt_ids got = {0};
            struct dt_place q = {some_place(p, N), DT_NONE};
            CHECK_MSG(dt_nearest_place(t, &q, 1, &opt, &got) == DT_OK,
                      "shape %d: more than %d steps at %.17g %.17g", (int)shape, STEPS, q.at.x,
                      q.at.y);
            free(got.v);
        }
        dt_free(t);
    }
    free(p);
}
