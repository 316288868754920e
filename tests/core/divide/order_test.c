/* order_test.c - the grids that points are sorted by. */
#include "core/divide/order.h"

#include <math.h>
#include <stdlib.h>

#include "tests/oracle/families.h"
#include "tests/test.h"

enum { N = 4096, CELLS = N / 2 };

static struct dt_order plan(struct dt_arena *arena, const struct dt_point *p, uint32_t n)
{
    struct dt_order o = {0};
    dt_order_plan(&o, dt_box_of(p, n), n / 2.0, p, n);
    CHECK(dt_order_tables(&o, arena) == DT_OK);
    CHECK((size_t)o.columns * o.rows == (size_t)1 << o.bits);
    return o;
}

static bool is_cut_in_strips(const char *family)
{
    static struct dt_point p[N];
    struct dt_arena arena = {0};
    family_points(family_find(family), p, N, 7);
    struct dt_order o = plan(&arena, p, N);
    dt_arena_clear(&arena);
    return o.columns == 1 || o.rows == 1;
}

TEST(points_along_a_line_are_cut_into_strips)
{
    static const char *const lines[] = {"near_collinear", "thin_line", "line_diagonal"};
    static const char *const others[] = {"uniform", "gaussian",         "clusters", "kuzmin",
                                         "lattice", "lattice_shuffled", "circle",   "tenths"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        CHECK_MSG(is_cut_in_strips(lines[i]), "%s", lines[i]);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        CHECK_MSG(!is_cut_in_strips(others[i]), "%s", others[i]);
}

/* Points in a rotated band of the given thickness, 1 long. */
static struct dt_order plan_band(struct dt_arena *arena, double thickness)
{
    static struct dt_point p[N];
    for (int i = 0; i < N; i++) {
        double a = test_below(1u << 30) * 0x1p-30, b = thickness * test_below(1u << 30) * 0x1p-30;
        p[i] = (struct dt_point){0.8 * a - 0.6 * b, 0.6 * a + 0.8 * b};
    }
    return plan(arena, p, N);
}

TEST(strips_are_not_much_narrower_than_a_band_is_thick)
{
    struct dt_arena arena = {0};
    struct dt_order o = plan_band(&arena, 1e-9);
    CHECK(o.columns == CELLS && o.rows == 1);
    o = plan_band(&arena, 1.0 / 256);
    CHECK(o.rows == 1 && o.columns >= 128 && o.columns <= 1024);
    o = plan_band(&arena, 0.1);
    CHECK(o.columns > 1 && o.rows > 1);
    dt_arena_clear(&arena);
}

TEST(an_arc_is_cut_into_strips_along_its_longer_side)
{
    static struct dt_point p[N];
    struct dt_arena arena = {0};
    for (int i = 0; i < N; i++) {
        double a = 0.2 * i / N;
        p[i] = (struct dt_point){cos(a), sin(a)};
    }
    struct dt_order o = plan(&arena, p, N);
    CHECK(o.columns == 1 && o.rows >= CELLS / 4);
    dt_arena_clear(&arena);
}

TEST(keys_are_monotone_in_either_coordinate_of_every_family)
{
    static struct dt_point p[N];
    for (size_t f = 0; families[f].name != NULL; f++) {
        struct dt_arena arena = {0};
        family_points(&families[f], p, N, 3);
        struct dt_order o = plan(&arena, p, N);
        uint32_t of_x = 0, wrong = 0;
        for (uint32_t s = 0; s < o.bits; s++)
            of_x |= (uint32_t)(o.axis[s] == 0) << s;
        for (int i = 0; i < 20000; i++) {
            struct dt_point a = p[test_below(N)], b = p[test_below(N)];
            uint32_t ka = dt_order_key(&o, a), kb = dt_order_key(&o, b);
            wrong += ka >> o.bits != 0;
            wrong += a.x <= b.x && (ka & of_x) > (kb & of_x);
            wrong += a.y <= b.y && (ka & ~of_x) > (kb & ~of_x);
        }
        CHECK_MSG(wrong == 0, "%s: %u wrong", families[f].name, wrong);
        dt_arena_clear(&arena);
    }
}
