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

/* Rectangles on a lattice, of which each has points of its own at its corners, so that sides overlap without being the same. Rectangle
 * i has the number i / 2; the last one lacks a side. */
enum { SIDE = 9, LATTICE = SIDE * SIDE, RECTANGLES = 6, CORNERS = 4 * RECTANGLES };

struct rectangles {
    struct dt_point p[LATTICE + CORNERS];
    struct dt_constraint c[CORNERS];
    size_t constraints;
    struct dt_point lo[RECTANGLES], hi[RECTANGLES];
};

static void draw_rectangles(struct rectangles *r)
{
    *r = (struct rectangles){0};
    for (unsigned i = 0; i < LATTICE; i++)
        r->p[i] = (struct dt_point){i % SIDE, i / SIDE};
    for (unsigned i = 0; i < RECTANGLES; i++) {
        double x = test_below(SIDE - 1), y = test_below(SIDE - 1);
        struct dt_point lo = {x, y}, hi = {x + 1 + test_below(SIDE - 1 - (unsigned)x),
                                           y + 1 + test_below(SIDE - 1 - (unsigned)y)};
        const struct dt_point corner[] = {lo, {hi.x, lo.y}, hi, {lo.x, hi.y}};
        uint32_t first = LATTICE + 4 * i;
        memcpy(&r->p[first], corner, sizeof corner);
        for (uint32_t k = 0; k < 4u - (i == RECTANGLES - 1); k++)
            r->c[r->constraints++] =
                (struct dt_constraint){first + k, first + (k + 1) % 4, true, i / 2};
        r->lo[i] = lo;
        r->hi[i] = hi;
    }
}

/* Whether the place, which is on no side, is inside the border of the number, which is closed. */
static bool is_inside(const struct rectangles *r, struct dt_point q, uint32_t number)
{
    bool in = false;
    for (unsigned i = 0; i < RECTANGLES - 2; i++)
        in ^= i / 2 == number && q.x > r->lo[i].x && q.x < r->hi[i].x && q.y > r->lo[i].y &&
              q.y < r->hi[i].y;
    return in;
}

static void check_row(const struct rectangles *r, const uint32_t *c, const uint32_t *number,
                      size_t numbers, bool inside)
{
    const struct dt_point *p = r->p;
    struct dt_point q = {(p[c[0]].x + p[c[1]].x + p[c[2]].x) / 3,
                         (p[c[0]].y + p[c[1]].y + p[c[2]].y) / 3};
    size_t at = 0;
    for (uint32_t k = 0; k < RECTANGLES / 2; k++) {
        bool has = at < numbers && number[at] == k;
        CHECK(has == is_inside(r, q, k));
        at += has;
    }
    CHECK(at == numbers && inside == (numbers > 0));
}

static void check_regions(const struct dt_arrays *a, size_t insides)
{
    struct dt_region *region, all;
    size_t n;
    CHECK(dt_arrays_regions(a, &region, &n, &all) == DT_OK && n == RECTANGLES / 2);
    CHECK(region[0].closed && region[1].closed && !region[2].closed && region[2].triangles == 0);
    CHECK(all.triangles == insides && all.area <= region[0].area + region[1].area);
    dt_arrays_release(region);
}

TEST(each_triangle_has_the_numbers_of_the_borders_around_it)
{
    for (int round = 0; round < 50; round++) {
        struct rectangles r;
        struct dt_arrays *a;
        static uint32_t triangle[6 * (LATTICE + CORNERS)], face[2 * (LATTICE + CORNERS)];
        static bool inside[2 * (LATTICE + CORNERS)];
        uint32_t wrong[4], counts[5];
        struct dt_ids number = {0}, end = {0};
        size_t insides = 0;
        draw_rectangles(&r);
        CHECK(dt_arrays_declared(r.p, LATTICE + CORNERS, r.c, r.constraints, NULL, 1, triangle, &a,
                                 wrong) == DT_OK);
        CHECK(dt_arrays_faces(a, face, &number, &end) == DT_OK);
        CHECK(dt_arrays_inside(a, triangle, inside) == DT_OK);
        dt_arrays_counts(a, counts);
        CHECK(counts[2] == 2 * (SIDE - 1) * (SIDE - 1) && end.v[0] == 0);
        for (uint32_t row = 0; row < counts[2]; row++) {
            uint32_t from = face[row] == 0 ? 0 : end.v[face[row] - 1];
            check_row(&r, &triangle[3 * (size_t)row], number.v + from, end.v[face[row]] - from,
                      inside[row]);
            insides += inside[row];
        }
        check_regions(a, insides);
        dt_arrays_release(number.v);
        dt_arrays_release(end.v);
        dt_arrays_free(a);
    }
}

TEST(without_borders_all_triangles_are_in_the_outer_face)
{
    const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    const struct dt_constraint line = {0, 2, false, 7};
    uint32_t triangle[24], wrong[4], face[8] = {9, 9};
    struct dt_ids number = {0}, end = {0};
    struct dt_arrays *a;
    for (size_t lines = 0; lines < 2; lines++) {
        CHECK(dt_arrays_declared(p, 4, &line, lines, NULL, 1, triangle, &a, wrong) == DT_OK);
        number.n = end.n = 0;
        CHECK(dt_arrays_faces(a, face, &number, &end) == DT_OK);
        CHECK(face[0] == 0 && face[1] == 0 && number.n == 0 && end.n == 1 && end.v[0] == 0);
        dt_arrays_free(a);
    }
    dt_arrays_release(number.v);
    dt_arrays_release(end.v);
    CHECK(dt_arrays_declared(p, 1, NULL, 0, NULL, 1, triangle, &a, wrong) == DT_OK);
    end = number = (struct dt_ids){0};
    CHECK(dt_arrays_faces(a, face, &number, &end) == DT_OK && end.n == 1);
    dt_arrays_release(end.v);
    dt_arrays_free(a);
}

TEST(constraints_that_cross_get_points_in_common_with_heights)
{
    const struct dt_point p[] = {{0, 0}, {4, 4}, {0, 4}, {4, 0}, {9, 9}};
    const double z[] = {0, 8, 4, 0, (double)NAN};
    const struct dt_constraint c[] = {{1, 0, false, 5}, {2, 3, true, 6}, {1, 4, false, 7}};
    for (int with = 0; with < 2; with++) {
        struct dt_split plan;
        struct dt_arrays *a;
        uint32_t wrong[4], triangle[36];
        struct dt_point all[6];
        CHECK(dt_arrays_split(p, with ? z : NULL, 5, c, 3, &plan, wrong) == DT_OK);
        CHECK(plan.n_points == 1 && plan.point[0].x == 2 && plan.point[0].y == 2);
        CHECK(plan.n_added == 5 && plan.n_released == 0 && plan.split == 2 && plan.deviation == 0);
        CHECK(plan.columns == (size_t)with && (!with || plan.value[0] == 3));
        memcpy(all, p, sizeof p);
        all[5] = plan.point[0];
        CHECK(dt_arrays_declared(all, 6, plan.added, plan.n_added, NULL, 1, triangle, &a, wrong) ==
              DT_OK);
        dt_arrays_free(a);
        dt_split_clear(&plan);
    }
}

TEST(what_cannot_be_split_is_named)
{
    const struct dt_point p[] = {{0, 0}, {4, 4}, {0x1p300, 4}};
    const struct dt_constraint same = {1, 1, false, 0}, far = {0, 7, false, 0};
    struct dt_split plan;
    uint32_t wrong[4];
    CHECK(dt_arrays_split(p, NULL, 2, &same, 1, &plan, wrong) == DT_NOEDGE && wrong[0] == 1);
    CHECK(dt_arrays_split(p, NULL, 2, &far, 1, &plan, wrong) == DT_NOPOINT && wrong[0] == 7);
    CHECK(dt_arrays_split(p, NULL, 3, &far, 1, &plan, wrong) == DT_RANGE);
    dt_split_clear(&plan);
    CHECK(dt_arrays_split(p, NULL, 2, NULL, 0, &plan, wrong) == DT_OK && plan.n_added == 0);
    dt_split_clear(&plan);
}
