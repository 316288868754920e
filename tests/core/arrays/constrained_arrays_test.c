/* constrained_arrays_test.c - triangulations with constraints, all at once, against sets that get them one by one. */
#include <fenv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_arrays.h"
#include "tests/test.h"

enum { N = 60, PAIRS = 40 };

/* Points of a small lattice, many of them coincident, and segments between them that a set accepts one by one. */
struct drawing {
    struct dt_point p[N];
    struct dt *t; /* owns */
    uint32_t end[2 * PAIRS], pairs, refused[2];
};

static void draw(struct drawing *d)
{
    struct dt_added added;
    *d = (struct drawing){.t = dt_new(0)};
    for (unsigned i = 0; i < N; i++)
        d->p[i] = (struct dt_point){test_below(12), test_below(12)};
    CHECK(dt_add(d->t, d->p, N, &added) == DT_OK && dt_triangulate(d->t, NULL) == DT_OK);
    for (unsigned tries = 0; tries < 400 && d->pairs < PAIRS; tries++) {
        size_t new;
        uint32_t missing, a = test_below(N), b = test_below(N);
        struct dt_constraint c = {a, b, false, 0};
        enum dt_status s = dt_constrain(d->t, &c, 1, NULL, &new, &missing);
        if (s == DT_CROSSES)
            memcpy(d->refused, (uint32_t[]){a, b}, sizeof d->refused);
        if (s != DT_OK)
            continue;
        d->end[2 * (size_t)d->pairs] = a;
        d->end[2 * (size_t)d->pairs++ + 1] = b;
    }
}

static struct dt_arrays *arrays_of(const struct drawing *d, uint32_t *triangle)
{
    struct dt_arrays *a;
    uint32_t wrong[4];
    CHECK(dt_arrays_constrained(d->p, N, d->end, d->pairs, false, NULL, 2, triangle, &a, wrong) ==
          DT_OK);
    return a;
}

static void check_same(const struct drawing *d, const struct dt_arrays *a, const uint32_t *triangle)
{
    struct dt_summary sum;
    uint32_t want[6 * N];
    struct dt_ids edges = {0}, own = {0};
    dt_summary(d->t, &sum);
    CHECK(dt_flat(d->t, false, want, NULL) == DT_OK);
    CHECK(memcmp(triangle, want, 12 * (size_t)sum.triangles) == 0);
    CHECK(dt_constrained_edges(d->t, &edges) == DT_OK);
    CHECK(dt_arrays_constrained_edges(a, &own) == DT_OK && own.n == edges.n);
    CHECK(edges.n == 0 || memcmp(own.v, edges.v, edges.n * sizeof *own.v) == 0);
    free(edges.v);
    dt_arrays_release(own.v);
}

/* Whether the closed triangle has the place, all of it in whole numbers. */
static bool has(const struct dt_point *p, const uint32_t *corner, struct dt_point q)
{
    for (unsigned k = 0; k < 3; k++) {
        struct dt_point a = p[corner[k]], b = p[corner[(k + 1) % 3]];
        if ((b.x - a.x) * (q.y - a.y) - (b.y - a.y) * (q.x - a.x) < 0)
            return false;
    }
    return true;
}

static void check_places(const struct drawing *d, const struct dt_arrays *a,
                         const uint32_t *triangle)
{
    uint32_t counts[5], row, id;
    double distance, nearest = HUGE_VAL;
    struct dt_point q = {test_below(12), test_below(12)};
    dt_arrays_counts(a, counts);
    uint32_t want = 0;
    while (want < counts[2] && !has(d->p, &triangle[3 * (size_t)want], q))
        want++;
    CHECK(dt_arrays_locate(a, &q, 1, 0, 1, &row) == DT_OK);
    CHECK(row == (want == counts[2] ? DT_NONE : want));
    for (unsigned i = 0; i < N; i++)
        nearest = fmin(nearest, hypot(d->p[i].x - q.x, d->p[i].y - q.y));
    CHECK(dt_arrays_nearest(a, &q, 1, 1, 1, &id, &distance) == DT_OK && distance == nearest);
}

TEST(constraints_given_at_once_make_the_triangulation_of_constraints_one_by_one)
{
    for (int round = 0; round < 60; round++) {
        struct drawing d;
        uint32_t triangle[6 * N], wrong[4];
        draw(&d);
        struct dt_arrays *a = arrays_of(&d, triangle), *none;
        check_same(&d, a, triangle);
        for (int i = 0; i < 40; i++)
            check_places(&d, a, triangle);
        dt_arrays_free(a);
        if (d.pairs < PAIRS && d.refused[0] != d.refused[1]) {
            memcpy(&d.end[2 * (size_t)d.pairs], d.refused, sizeof d.refused);
            CHECK(dt_arrays_constrained(d.p, N, d.end, d.pairs + 1, false, NULL, 1, triangle, &none,
                                        wrong) == DT_CROSSES &&
                  none == NULL);
        }
        dt_free(d.t);
    }
}

TEST(constraints_that_cross_or_have_wrong_ends_are_named)
{
    const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    uint32_t triangle[24], wrong[4];
    struct dt_arrays *a;
    const uint32_t cross[] = {0, 1, 3, 1, 2, 0}, same[] = {2, 2}, far[] = {0, 9};
    CHECK(dt_arrays_constrained(p, 4, cross, 3, false, NULL, 1, triangle, &a, wrong) == DT_CROSSES);
    CHECK(a == NULL && wrong[0] + wrong[1] + wrong[2] + wrong[3] == 6 && wrong[0] < wrong[1] &&
          wrong[2] < wrong[3] && wrong[0] + wrong[1] != wrong[2]);
    CHECK(dt_arrays_constrained(p, 4, same, 1, false, NULL, 1, triangle, &a, wrong) == DT_NOEDGE);
    CHECK(a == NULL && wrong[0] == 2);
    CHECK(dt_arrays_constrained(p, 4, far, 1, false, NULL, 1, triangle, &a, wrong) == DT_NOPOINT);
    CHECK(a == NULL && wrong[0] == 9);
}

/* A square with a square hole. */
TEST(triangles_inside_borders_are_known_whatever_the_rounding_mode)
{
    const struct dt_point p[] = {{0, 0}, {9, 0}, {9, 9}, {0, 9}, {3, 3},
                                 {3, 6}, {6, 6}, {6, 3}, {12, 5}};
    const uint32_t end[] = {0, 1, 1, 2, 2, 3, 3, 0, 4, 5, 5, 6, 6, 7, 7, 4};
    static const int modes[] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    for (size_t i = 0; i < 4; i++) {
        struct dt_arrays *a;
        uint32_t triangle[54], wrong[4], counts[5];
        bool inside[18];
        double twice = 0;
        fesetround(modes[i]);
        CHECK(dt_arrays_constrained(p, 9, end, 8, true, NULL, 1, triangle, &a, wrong) == DT_OK);
        CHECK(dt_arrays_inside(a, triangle, inside) == DT_OK && fegetround() == modes[i]);
        fesetround(FE_TONEAREST);
        dt_arrays_counts(a, counts);
        for (uint32_t row = 0; row < counts[2]; row++) {
            const uint32_t *c = &triangle[3 * (size_t)row];
            struct dt_point o = p[c[0]], u = p[c[1]], v = p[c[2]];
            double area = (u.x - o.x) * (v.y - o.y) - (u.y - o.y) * (v.x - o.x);
            twice += inside[row] ? area : 0;
        }
        CHECK(twice == 2 * (81 - 9) && counts[2] == 14 - 3);
        dt_arrays_free(a);
    }
}
