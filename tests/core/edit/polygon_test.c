/* polygon_test.c - the triangles of polygons, against sets that get the sides one by one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_arrays.h"
#include "core/delaunay_constraints.h"
#include "tests/test.h"

enum { MOST = 40, RINGS = 3, SIDE = 12 };

struct rings {
    struct dt_point p[MOST * RINGS];
    uint32_t end[RINGS], n;
    size_t rings;
};

static void draw(struct rings *r)
{
    *r = (struct rings){.rings = 1 + test_below(RINGS)};
    unsigned most = 3 + test_below(MOST - 3), size = 3 + test_below(SIDE);
    double unit = ldexp(1, (int)test_below(3) * 130 - 130); /* exact */
    for (size_t i = 0; i < r->rings; i++) {
        uint32_t first = r->n, corners = test_below(most);
        for (uint32_t k = 0; k < corners; k++)
            r->p[r->n++] = (struct dt_point){unit * test_below(size), unit * test_below(size)};
        if (corners > 0 && test_below(2) == 0)
            r->p[r->n - 1] = r->p[first]; /* a ring that is closed */
        r->end[i] = r->n;
    }
}

/* The twofold area of three points with coordinates three times as large, which is exact. */
static double turn(struct dt_point a, struct dt_point b, struct dt_point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static struct dt_point thrice(struct dt_point p)
{
    return (struct dt_point){3 * p.x, 3 * p.y};
}

/* Whether the place, times three, is enclosed an odd number of times; *on: it is on a side. */
static bool is_enclosed(const struct rings *r, struct dt_point q, bool *on)
{
    bool odd = false;
    for (size_t i = 0; i < r->rings; i++) {
        uint32_t first = i == 0 ? 0 : r->end[i - 1];
        for (uint32_t k = first; k < r->end[i] && r->end[i] - first > 2; k++) {
            struct dt_point a = thrice(r->p[k]),
                            b = thrice(r->p[k + 1 < r->end[i] ? k + 1 : first]);
            double side = turn(a, b, q);
            bool spans = (a.y > q.y) != (b.y > q.y);
            *on |= side == 0 && (a.x - q.x) * (b.x - q.x) + (a.y - q.y) * (b.y - q.y) <= 0;
            odd ^= spans && (side > 0) == (b.y > a.y);
        }
    }
    return odd;
}

/* A set with the sides that cross none before. */
static struct dt *constrained(const struct rings *r, size_t *left_out)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    *left_out = 0;
    CHECK(dt_add(t, r->p, r->n, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    for (size_t i = 0; i < r->rings; i++) {
        uint32_t first = i == 0 ? 0 : r->end[i - 1];
        for (uint32_t k = first; k < r->end[i] && r->end[i] - first > 2; k++) {
            uint32_t missing, b = k + 1 < r->end[i] ? k + 1 : first;
            size_t declared;
            enum dt_status s = dt_constrain(t, &(struct dt_constraint){k, b, true, 0}, 1, NULL,
                                            &declared, &missing);
            CHECK(s == DT_OK || s == DT_CROSSES);
            *left_out += s == DT_CROSSES;
        }
    }
    return t;
}

static int compare(const void *a, const void *b)
{
    const uint32_t *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k])
            return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* Of all triangles of the set, those whose centroids are enclosed; false: one is on a side. */
static bool choose(const struct rings *r, const struct dt *t, uint32_t *row, size_t *n)
{
    static uint32_t all[6 * MOST * RINGS];
    struct dt_summary sum;
    bool on = false;
    dt_summary(t, &sum);
    CHECK(dt_flat(t, false, all, NULL) == DT_OK);
    *n = 0;
    for (uint32_t i = 0; i < sum.triangles; i++) {
        struct dt_point a = r->p[all[3 * i]], b = r->p[all[3 * i + 1]], c = r->p[all[3 * i + 2]];
        if (is_enclosed(r, (struct dt_point){a.x + b.x + c.x, a.y + b.y + c.y}, &on))
            memcpy(row + 3 * (*n)++, all + 3 * i, 3 * sizeof *row);
    }
    return !on;
}

static bool check_polygon(const struct rings *r, size_t *left_out)
{
    static uint32_t want[6 * MOST * RINGS];
    struct dt_ids got = {0};
    size_t refused, n;
    struct dt *t = constrained(r, &refused);
    CHECK(dt_polygon(r->p, r->n, r->end, r->rings, NULL, &got, left_out) == DT_OK);
    CHECK(*left_out == refused);
    bool known = choose(r, t, want, &n);
    if (known) {
        CHECK(got.n == 3 * n);
        if (n > 0)
            qsort(got.v, n, 3 * sizeof *got.v, compare);
        CHECK(n == 0 || memcmp(got.v, want, got.n * sizeof *want) == 0);
    }
    free(got.v);
    dt_free(t);
    return known;
}

TEST(triangles_of_random_polygons_are_those_whose_centroids_are_enclosed)
{
    int known = 0, crossing = 0, simple = 0;
    for (int round = 0; round < 3000; round++) {
        struct rings r;
        size_t left_out;
        draw(&r);
        if (!check_polygon(&r, &left_out))
            continue;
        known++;
        crossing += left_out > 0;
        simple += left_out == 0 && r.n > 4;
    }
    CHECK(known > 800 && crossing > 300 && simple > 100);
}

TEST(a_polygon_without_area_has_no_triangles)
{
    const struct dt_point p[] = {{0, 0}, {1, 1}, {2, 2}, {0, 0}, {5, 5}};
    for (uint32_t n = 0; n <= 5; n++) {
        struct dt_ids out = {0};
        size_t left_out = 9;
        CHECK(dt_polygon(p, n, &n, 1, NULL, &out, &left_out) == DT_OK && out.n == 0 &&
              left_out == 0);
        free(out.v);
    }
    struct dt_ids none = {0};
    size_t left_out;
    CHECK(dt_polygon(NULL, 0, NULL, 0, NULL, &none, &left_out) == DT_OK && none.n == 0);
}

TEST(a_polygon_with_an_invalid_coordinate_is_refused)
{
    const struct dt_point p[] = {{0, 0}, {0x1p300, 1}, {0, 1}};
    const uint32_t end = 3;
    struct dt_ids out = {0};
    size_t left_out;
    CHECK(dt_polygon(p, 3, &end, 1, NULL, &out, &left_out) == DT_RANGE && out.n == 0);
}
