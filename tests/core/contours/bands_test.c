/* bands_test.c - bands: simple rings, holes in their outer rings, and the area of the surface between the levels. */
#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "tests/core/polls.h"
#include "tests/core/sets.h"
#include "tests/core/surface/values.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct rings {
    struct dt_bands *b;
    const struct dt_band_ring *ring;
    size_t n;
};

static enum dt_status try_rings(const struct dt *t, const struct dt_view *v, const double *level,
                                uint32_t levels, double max_edge, struct rings *r)
{
    bool done = false;
    *r = (struct rings){NULL, NULL, 0};
    enum dt_status s =
        dt_bands_begin(t, v, dt_field_find(t, "z", 1), level, levels, max_edge, &r->b);
    while (s == DT_OK && !done)
        s = dt_bands_read(t, r->b, &done);
    return s == DT_OK ? dt_bands_end(r->b, NULL, &r->ring, &r->n) : s;
}

static struct rings rings_of(const struct dt *t, const double *level, uint32_t levels,
                             double max_edge)
{
    struct rings r;
    CHECK(try_rings(t, NULL, level, levels, max_edge, &r) == DT_OK);
    return r;
}

static void check_ring(const struct dt_band_ring *ring, uint32_t number, bool hole,
                       const struct dt_point *p, size_t n)
{
    CHECK_MSG(ring->number == number && ring->hole == hole && ring->n == n, "ring %u %d %zu",
              ring->number, ring->hole, ring->n);
    for (size_t i = 0; i < n; i++)
        CHECK_MSG(ring->p[i].x == p[i].x && ring->p[i].y == p[i].y, "place %zu is %.17g %.17g", i,
                  ring->p[i].x, ring->p[i].y);
}

static void check_equal(const struct rings *a, const struct rings *b)
{
    CHECK_MSG(a->n == b->n, "%zu rings, not %zu", a->n, b->n);
    for (size_t i = 0; i < a->n; i++) {
        CHECK(a->ring[i].low == b->ring[i].low && a->ring[i].high == b->ring[i].high);
        check_ring(&a->ring[i], b->ring[i].number, b->ring[i].hole, b->ring[i].p, b->ring[i].n);
    }
}

/* ---- what holds for all rings: places are exact, or nearly ---- */

static double side(struct dt_point a, struct dt_point b, struct dt_point c)
{
    double d = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    return fabs(d) < 1e-9 ? 0 : d;
}

static bool cross(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d)
{
    return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

static void check_simple(const struct dt_band_ring *r)
{
    CHECK(r->n >= 3);
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < i; k++)
            CHECK_MSG(r->p[i].x != r->p[k].x || r->p[i].y != r->p[k].y, "%g %g is there twice",
                      r->p[i].x, r->p[i].y);
}

static void check_apart(const struct dt_band_ring *r, const struct dt_band_ring *s)
{
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < s->n; k++)
            CHECK(!cross(r->p[i], r->p[(i + 1) % r->n], s->p[k], s->p[(k + 1) % s->n]));
}

/* 1: inside, 0: on the ring, -1: outside. */
static int where(const struct dt_band_ring *r, struct dt_point q)
{
    bool inside = false;
    for (size_t i = 0; i < r->n; i++) {
        struct dt_point a = r->p[i], b = r->p[(i + 1) % r->n];
        bool between = fmin(a.x, b.x) - 1e-9 <= q.x && q.x <= fmax(a.x, b.x) + 1e-9 &&
                       fmin(a.y, b.y) - 1e-9 <= q.y && q.y <= fmax(a.y, b.y) + 1e-9;
        if (between && side(a, b, q) == 0)
            return 0;
        if ((a.y > q.y) != (b.y > q.y) && q.x < a.x + (b.x - a.x) * (q.y - a.y) / (b.y - a.y))
            inside = !inside;
    }
    return inside ? 1 : -1;
}

static void check_polygons(const struct rings *r)
{
    const struct dt_band_ring *outer = NULL;
    for (size_t i = 0; i < r->n; i++) {
        const struct dt_band_ring *k = &r->ring[i];
        double area = dt_polygon_area(k->p, k->n);
        check_simple(k);
        CHECK(k->hole ? area < 0 : area > 0);
        CHECK(k->hole ? k->number == outer->number
                      : k->number == (outer == NULL ? 0 : outer->number + 1));
        CHECK(outer == NULL || k->low >= outer->low);
        outer = k->hole ? outer : k;
        for (size_t c = 0; k->hole && c < k->n; c++)
            CHECK(where(outer, k->p[c]) >= 0);
        for (size_t c = 0; c <= i && k->n * r->ring[c].n < 10000; c++)
            check_apart(k, &r->ring[c]);
    }
}

struct corner {
    struct dt_point p;
    double z;
};

/* The area of what is below the level in a triangle; at the level is above it. */
static double area_below(const struct corner v[3], double level)
{
    struct dt_point kept[6];
    size_t n = 0;
    for (int i = 0; i < 3; i++) {
        const struct corner *a = &v[i], *b = &v[(i + 1) % 3];
        if (a->z < level)
            kept[n++] = a->p;
        if ((a->z < level) != (b->z < level)) {
            double share = (level - a->z) / (b->z - a->z);
            kept[n++] = (struct dt_point){a->p.x + share * (b->p.x - a->p.x),
                                          a->p.y + share * (b->p.y - a->p.y)};
        }
    }
    return n < 3 ? 0 : dt_polygon_area(kept, n);
}

/* Of each band of the surface, the area that the triangles have, those inside if a number is given. */
static void check_areas(const struct dt *t, const double *level, uint32_t levels, double max_edge,
                        const struct rings *r)
{
    struct dt_cursor c;
    uint32_t row[3];
    size_t rows, words;
    double want[16] = {0}, got[16] = {0};
    const struct dt_field *f = dt_field_find(t, "z", 1);
    CHECK(dt_table_begin(t, NULL, DT_TRIANGLES, false, &c) == DT_OK);
    while (dt_table_read(t, &c, row, 3, 1, &rows, &words) == DT_OK && rows > 0) {
        struct corner v[3];
        bool has = true;
        for (int k = 0; k < 3; k++) {
            CHECK(dt_get(t, row[k], &v[k].p) == DT_OK);
            dt_field_values(f, NULL, &row[k], 1, &v[k].z);
            has &= !isnan(v[k].z);
        }
        for (int k = 0; k < 3; k++)
            has &= hypot(v[k].p.x - v[(k + 1) % 3].p.x, v[k].p.y - v[(k + 1) % 3].p.y) <= max_edge;
        for (uint32_t i = 0; has && i + 1 < levels; i++)
            want[i] += area_below(v, level[i + 1]) - area_below(v, level[i]);
    }
    for (size_t i = 0; i < r->n; i++)
        for (uint32_t k = 0; k + 1 < levels; k++)
            if (r->ring[i].low == level[k])
                got[k] += dt_polygon_area(r->ring[i].p, r->ring[i].n);
    for (uint32_t k = 0; k + 1 < levels; k++)
        CHECK_MSG(fabs(got[k] - want[k]) < 1e-9, "band %u has %.17g, not %.17g", k, got[k],
                  want[k]);
}

static void check_all(const struct dt *t, const double *level, uint32_t levels, double max_edge)
{
    struct rings r = rings_of(t, level, levels, max_edge);
    check_polygons(&r);
    check_areas(t, level, levels, max_edge, &r);
    dt_bands_free(r.b);
}

/* ---- single bands ---- */

TEST(band_around_a_peak_is_a_ring_with_a_hole)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    static const double z[] = {0, 0, 0, 0, 1}, level[] = {0.25, 0.5, 2};
    static const struct dt_point outer[] = {{0.5, 0.5}, {3.5, 0.5}, {3.5, 3.5}, {0.5, 3.5}},
                                 hole[] = {{1, 1}, {1, 3}, {3, 3}, {3, 1}},
                                 top[] = {{1, 1}, {3, 1}, {3, 3}, {1, 3}};
    struct dt *t = set_with(p, z, 5);
    struct rings r = rings_of(t, level, 3, HUGE_VAL);
    CHECK(r.n == 3 && r.ring[0].low == 0.25 && r.ring[0].high == 0.5 && r.ring[2].high == 2);
    check_ring(&r.ring[0], 0, false, outer, 4);
    check_ring(&r.ring[1], 0, true, hole, 4);
    check_ring(&r.ring[2], 1, false, top, 4);
    dt_bands_free(r.b);
    dt_free(t);
}

TEST(bands_of_infinite_levels_tile_the_surface)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {0, 4}};
    static const double z[] = {0, 0, 4}, level[] = {-HUGE_VAL, 1, HUGE_VAL};
    static const struct dt_point low[] = {{0, 0}, {4, 0}, {3, 1}, {0, 1}},
                                 high[] = {{0, 1}, {3, 1}, {0, 4}};
    struct dt *t = set_with(p, z, 3);
    struct rings r = rings_of(t, level, 3, HUGE_VAL);
    CHECK(r.n == 2 && r.ring[0].low == -HUGE_VAL && r.ring[1].high == HUGE_VAL);
    check_ring(&r.ring[0], 0, false, low, 4);
    check_ring(&r.ring[1], 1, false, high, 3);
    dt_bands_free(r.b);
    r = rings_of(t, level + 1, 1, HUGE_VAL);
    CHECK(r.n == 0);
    dt_bands_free(r.b);
    r = rings_of(t, level, 0, HUGE_VAL);
    CHECK(r.n == 0);
    dt_bands_free(r.b);
    dt_free(t);
}

TEST(a_plateau_at_a_level_is_in_the_band_above)
{
    static const struct dt_point p[] = {{0, 0}, {6, 0}, {6, 6}, {0, 6}, {2, 2}, {4, 2}, {3, 4}};
    static const double z[] = {0, 0, 0, 0, 1, 1, 1}, level[] = {0, 1, 2};
    static const struct dt_point outer[] = {{0, 0}, {6, 0}, {6, 6}, {0, 6}},
                                 hole[] = {{2, 2}, {3, 4}, {4, 2}},
                                 plateau[] = {{2, 2}, {4, 2}, {3, 4}};
    struct dt *t = set_with(p, z, 7);
    struct rings r = rings_of(t, level, 3, HUGE_VAL);
    CHECK(r.n == 3);
    check_ring(&r.ring[0], 0, false, outer, 4);
    check_ring(&r.ring[1], 0, true, hole, 3);
    check_ring(&r.ring[2], 1, false, plateau, 3);
    dt_bands_free(r.b);
    dt_free(t);
}

TEST(a_ridge_and_a_peak_at_a_level_have_no_band)
{
    static const struct dt_point p[] = {{0, 0}, {8, 0}, {8, 8}, {0, 8}, {2, 4}, {4, 4}, {6, 6}};
    static const double z[] = {0, 0, 0, 0, 1, 1, 1}, level[] = {0, 1, 2};
    static const struct dt_point outer[] = {{0, 0}, {8, 0}, {8, 8}, {0, 8}};
    struct dt *t = set_with(p, z, 7);
    struct rings r = rings_of(t, level, 3, HUGE_VAL);
    CHECK(r.n == 1);
    check_ring(&r.ring[0], 0, false, outer, 4);
    dt_bands_free(r.b);
    dt_free(t);
}

/* Two hills that touch at a saddle whose value is the level. */
TEST(parts_that_touch_at_a_saddle_are_two_polygons)
{
    static const struct dt_point p[] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1}};
    static const double z[] = {2, 0, 2, 0, 1}, level[] = {0, 1, 3};
    static const struct dt_point first[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
                                 second[] = {{1, 1}, {2, 1}, {2, 2}, {1, 2}};
    struct dt *t = set_with(p, z, 5);
    struct rings r = rings_of(t, level, 3, HUGE_VAL);
    CHECK(r.n == 4);
    check_ring(&r.ring[2], 2, false, first, 4);
    check_ring(&r.ring[3], 3, false, second, 4);
    dt_bands_free(r.b);
    dt_free(t);
}

TEST(bands_leave_out_triangles_without_a_value_or_with_a_long_edge)
{
    enum { SIDE = 6 };
    struct dt_point p[SIDE * SIDE];
    double z[SIDE * SIDE];
    static const double level[] = {-1, 1};
    for (int i = 0; i < SIDE * SIDE; i++) {
        p[i] = (struct dt_point){i % SIDE, i / SIDE};
        z[i] = i == 14 ? (double)NAN : 0;
    }
    struct dt *t = set_with(p, z, SIDE * SIDE);
    struct rings r = rings_of(t, level, 2, HUGE_VAL);
    CHECK(r.n == 2 && r.ring[1].hole);
    check_polygons(&r);
    dt_bands_free(r.b);
    check_all(t, level, 2, HUGE_VAL);
    r = rings_of(t, level, 2, 1);
    CHECK(r.n == 0);
    dt_bands_free(r.b);
    dt_free(t);
}

TEST(bands_of_sets_without_triangles)
{
    static const struct dt_point p[] = {{0, 0}, {2, 2}, {4, 4}};
    static const double z[] = {0, 1, 2}, level[] = {-1, 1.5, 3};
    for (uint32_t n = 0; n <= 3; n++) {
        struct dt *t = set_with(p, z, n);
        if (n == 0) {
            dt_free(t);
            continue;
        }
        struct dt_view *v = dt_view_begin(t, true);
        struct rings r = rings_of(t, level, 3, HUGE_VAL);
        CHECK(r.n == 0);
        dt_bands_free(r.b);
        CHECK(dt_move(t, 0, (struct dt_point){7, 5}) == DT_OK && dt_refresh(t, NULL) == DT_OK);
        CHECK(try_rings(t, v, level, 3, HUGE_VAL, &r) == DT_OK && r.n == 0);
        dt_bands_free(r.b);
        dt_view_end(v);
        dt_free(t);
    }
}

TEST(bands_of_more_levels_than_a_piece_has_crossings)
{
    enum { LEVELS = 30000 };
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {0, 4}};
    static const double z[] = {0, 0, LEVELS};
    static double level[LEVELS];
    double area = 0;
    for (int i = 0; i < LEVELS; i++)
        level[i] = i + 1;
    struct dt *t = set_with(p, z, 3);
    struct rings r = rings_of(t, level, LEVELS, HUGE_VAL);
    CHECK(r.n == LEVELS - 1);
    for (size_t i = 0; i < r.n; i++) {
        CHECK(r.ring[i].low == level[i] && r.ring[i].n == (i + 1 < r.n ? 4 : 3));
        area += dt_polygon_area(r.ring[i].p, r.ring[i].n);
    }
    CHECK(fabs(area - 8. * (LEVELS - 1) / LEVELS * (LEVELS - 1) / LEVELS) < 1e-9);
    dt_bands_free(r.b);
    dt_free(t);
}

/* ---- all bands ---- */

static const double steps[] = {-HUGE_VAL, 0, 0.5, 1, 1.5, 2, 3, 4};

/* Values of a few powers of 2 on a lattice: plateaus, ridges and saddles; some are missing, or edges are too long. */
TEST_TIMEOUT(bands_of_plateaus_and_saddles_tile_the_surface, 60)
{
    enum { N = 49 };
    static const double heights[] = {0, 1, 2, 4};
    for (int round = 0; round < 400; round++) {
        struct dt_point p[N];
        double z[N];
        for (int i = 0; i < N; i++) {
            p[i] = (struct dt_point){i % 7, i / 7};
            z[i] = heights[test_below(2 + (uint32_t)round % 3)];
            if (round % 4 == 1 && test_below(4) == 0)
                z[i] = (double)NAN;
        }
        struct dt *t = set_with(p, z, N);
        uint32_t from = test_below(3), missing, n, id = test_below(N);
        if (round % 8 > 4)
            CHECK(dt_delete(t, &id, 1, &n, &missing) == DT_OK && dt_refresh(t, NULL) == DT_OK);
        check_all(t, steps + from, 8 - from, round % 5 == 4 ? 1.5 : HUGE_VAL);
        dt_free(t);
    }
}

static void check_family(const struct pair *pair)
{
    enum { MOST = 64 };
    double z[MOST];
    uint32_t n = dt_next_id(pair->t), missing;
    struct rings r;
    if (n == 0)
        return;
    for (uint32_t i = 0; i < n; i++) {
        struct dt_point p;
        z[i] = dt_get(pair->t, i, &p) == DT_OK && test_below(9) > 0 ? (double)test_below(5)
                                                                    : (double)NAN;
    }
    CHECK(dt_field_set_run(pair->t, "z", 1, 0, z, n, NULL, &missing) == DT_OK);
    CHECK(try_rings(pair->t, NULL, steps, 8, HUGE_VAL, &r) == DT_OK);
    for (size_t i = 0; i < r.n; i++)
        CHECK(r.ring[i].n >= 3 &&
              (r.ring[i].hole || i == 0 || r.ring[i].number == r.ring[i - 1].number + 1));
    dt_bands_free(r.b);
}

TEST_TIMEOUT(bands_of_every_family_are_found, 60)
{
    for_each_pair(check_family);
}

/* ---- one moment, any history ---- */

static void random_surface(struct dt_point *p, double *z, int n)
{
    for (int i = 0; i < n; i++) {
        p[i] = (struct dt_point){test_below(30), test_below(30)};
        z[i] = test_below(20) == 0 ? (double)NAN : test_below(6);
    }
}

TEST(bands_have_the_same_bytes_after_other_histories)
{
    enum { N = 300 };
    struct dt_point p[N];
    double z[N];
    uint32_t missing;
    random_surface(p, z, N);
    struct dt *at_once = set_with(p, z, N), *one_by_one = set_of_each(p, N);
    CHECK(dt_field_set_run(one_by_one, "z", 1, 0, z, N, NULL, &missing) == DT_OK);
    struct rings a = rings_of(at_once, steps, 8, HUGE_VAL),
                 b = rings_of(one_by_one, steps, 8, HUGE_VAL);
    CHECK(a.n > 4);
    check_polygons(&a);
    check_equal(&a, &b);
    dt_bands_free(a.b);
    dt_bands_free(b.b);
    dt_free(at_once);
    dt_free(one_by_one);
}

TEST(bands_of_a_view_are_those_of_its_moment)
{
    enum { N = 200 };
    for (int round = 0; round < 20; round++) {
        struct dt_point p[N];
        double z[N], max_edge = round % 2 == 0 ? HUGE_VAL : 4;
        struct rings r;
        uint32_t n, missing;
        random_surface(p, z, N);
        struct dt *t = set_with(p, z, N);
        struct rings before = rings_of(t, steps, 8, max_edge);
        struct dt_view *v = dt_view_begin(t, true);
        for (uint32_t i = 0; i < 40; i++) {
            uint32_t id = 40 + i, other = 80 + i;
            CHECK(dt_move(t, i, (struct dt_point){test_uniform(), test_uniform()}) == DT_OK);
            CHECK(dt_field_set(t, "z", 1, &id, &z[i], 1, NULL, &missing) == DT_OK);
            CHECK(dt_delete(t, &other, 1, &n, &missing) == DT_OK);
        }
        CHECK(dt_refresh(t, NULL) == DT_OK);
        CHECK(try_rings(t, v, steps, 8, max_edge, &r) == DT_OK);
        check_equal(&r, &before);
        dt_bands_free(r.b);
        dt_bands_free(before.b);
        dt_view_end(v);
        dt_free(t);
    }
}

TEST(bands_that_an_edit_interrupts_are_those_of_the_moment_of_their_view)
{
    enum { N = 30000 };
    static const double level[] = {-0.5, 0, 0.25, HUGE_VAL};
    struct dt_point *p = malloc(N * sizeof *p);
    double *z = malloc(N * sizeof *z);
    CHECK(p != NULL && z != NULL);
    for (int i = 0; i < N; i++) {
        p[i] = (struct dt_point){test_uniform(), test_uniform()};
        z[i] = i % 1000 == 7 ? (double)NAN : sin(7 * p[i].x) * cos(5 * p[i].y);
    }
    struct dt *t = set_with(p, z, N);
    struct rings before = rings_of(t, level, 4, HUGE_VAL);
    CHECK(before.n > 20);
    for (uint32_t pieces = 0, all = 30; pieces < all; pieces++) {
        struct rings r = {NULL, NULL, 0};
        struct dt_view *v = dt_view_begin(t, true);
        struct dt_point there, to = {test_uniform(), test_uniform()};
        bool done = false;
        CHECK(dt_bands_begin(t, v, dt_field_find(t, "z", 1), level, 4, HUGE_VAL, &r.b) == DT_OK);
        for (uint32_t i = 0; i < pieces && !done; i++)
            CHECK(dt_bands_read(t, r.b, &done) == DT_OK);
        all = done ? 0 : all;
        CHECK(dt_get(t, pieces, &there) == DT_OK);
        CHECK(dt_move(t, pieces, to) == DT_OK && dt_refresh(t, NULL) == DT_OK);
        while (!done)
            CHECK(dt_bands_read(t, r.b, &done) == DT_OK);
        CHECK(dt_bands_end(r.b, NULL, &r.ring, &r.n) == DT_OK);
        check_equal(&r, &before);
        CHECK(dt_move(t, pieces, there) == DT_OK && dt_refresh(t, NULL) == DT_OK);
        dt_bands_free(r.b);
        dt_view_end(v);
    }
    dt_bands_free(before.b);
    dt_free(t);
    free(p);
    free(z);
}

TEST(bands_survive_without_memory)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    static const double z[] = {0, 0, 0, 0, 1}, level[] = {0.25, 0.5, 2};
    struct dt *t = set_with(p, z, 5);
    enum dt_status s = DT_NOMEM;
    for (long n = 1; s == DT_NOMEM; n++) {
        struct rings r;
        test_fail_alloc(n);
        s = try_rings(t, NULL, level, 3, HUGE_VAL, &r);
        CHECK(test_alloc_failed() == (s == DT_NOMEM));
        dt_bands_free(r.b);
    }
    test_fail_alloc(0);
    CHECK(s == DT_OK);
    dt_free(t);
}

TEST(bands_end_when_they_are_cancelled)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {0, 4}};
    static const double z[] = {0, 0, 4}, level[] = {1, 2};
    atomic_bool cancel = true;
    struct dt_options opt = {.cancel = &cancel};
    struct dt *t = set_with(p, z, 3);
    struct rings r = {0};
    bool done = false;
    CHECK(dt_bands_begin(t, NULL, dt_field_find(t, "z", 1), level, 2, HUGE_VAL, &r.b) == DT_OK);
    while (!done)
        CHECK(dt_bands_read(t, r.b, &done) == DT_OK);
    CHECK(dt_bands_memory(r.b) > 0);
    CHECK(dt_bands_end(r.b, &opt, &r.ring, &r.n) == DT_CANCELLED && r.n == 0);
    dt_bands_free(r.b);
    dt_free(t);
}

/* A lattice of peaks: one polygon with a hole for each of them, and a polygon within each hole. */
TEST(bands_with_many_holes_poll_while_they_are_sorted)
{
    enum { PEAKS = 150, SIDE = 2 * PEAKS + 1 };
    static struct dt_point p[SIDE * SIDE];
    static double z[SIDE * SIDE];
    static const double level[] = {-1, 0.5, 2};
    atomic_bool cancel = false;
    struct dt_options opt = {.cancel = &cancel};
    enum dt_status s = DT_OK;
    for (int i = 0; i < SIDE * SIDE; i++) {
        p[i] = (struct dt_point){i % SIDE, i / SIDE};
        z[i] = i % SIDE % 2 == 1 && i / SIDE % 2 == 1;
    }
    struct dt *t = set_with(p, z, SIDE * SIDE);
    uint64_t polls = 0;
    for (uint64_t n = 0; n <= polls; n += n == 0 ? 1 : polls / 9 + 1) {
        struct rings r = {0};
        bool done = false;
        CHECK(dt_bands_begin(t, NULL, dt_field_find(t, "z", 1), level, 3, HUGE_VAL, &r.b) == DT_OK);
        while (!done)
            CHECK(dt_bands_read(t, r.b, &done) == DT_OK);
        polls_begin();
        polls_cancel_at(n);
        s = dt_bands_end(r.b, &opt, &r.ring, &r.n);
        polls_end();
        CHECK(s == (n == 0 ? DT_OK : DT_CANCELLED));
        if (n == 0) {
            polls = polls_count();
            CHECK_MSG(polls_longest_ms() < 20, "%g ms", polls_longest_ms());
            CHECK(r.n == 1 + 2 * PEAKS * PEAKS);
        }
        dt_bands_free(r.b);
    }
    polls_cancel_at(0);
    dt_free(t);
}
