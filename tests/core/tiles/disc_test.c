/* disc_test.c - discs and half planes against boxes, in exact signs: what is reported as apart is apart, also of flat triangles, needles
 * and exponents far apart. */
#include "core/tiles/disc.h"

#include <math.h>

#include "core/exact/predicates.h"
#include "tests/test.h"

static double coordinate(int spread)
{
    double v = ldexp(test_uniform() - 0.5, (int)test_below(2 * (unsigned)spread + 1) - spread);
    return dt_coordinate_ok(v) ? v : 0;
}

/* Three corners, counterclockwise: anywhere; far from the origin; nearly on a line; two of them close to each other. */
static bool random_triangle(struct dt_point p[3])
{
    int spread = (int[]){0, 3, 40, 140}[test_below(4)];
    double from = test_below(2) == 0 ? 0 : ldexp(1, (int)test_below(40));
    for (unsigned k = 0; k < 3; k++)
        p[k] = (struct dt_point){from + coordinate(spread), from + coordinate(spread)};
    double t = test_uniform();
    if (test_below(3) == 0)
        p[2] = (struct dt_point){p[0].x + t * (p[1].x - p[0].x), p[0].y + t * (p[1].y - p[0].y)};
    else if (test_below(3) == 0)
        p[2] = (struct dt_point){p[1].x + ldexp(t, -40), p[1].y};
    for (unsigned k = 0; k < 3; k++)
        if (!dt_coordinate_ok(p[k].x) || !dt_coordinate_ok(p[k].y))
            return false;
    int turn = dt_orient2d(p[0], p[1], p[2]);
    if (turn < 0) {
        struct dt_point kept = p[1];
        p[1] = p[2];
        p[2] = kept;
    }
    return turn != 0;
}

/* A place close to the circle, inside or outside, or a corner; some places are far along it. */
static bool place_near(const struct dt_point p[3], struct dt_point *q)
{
    struct dt_point c = dt_centre(p[0], p[1], p[2]);
    double r = hypot(p[0].x - c.x, p[0].y - c.y), angle = 6.3 * test_uniform();
    double off = test_below(2) == 0 ? 0 : ldexp(test_uniform() - 0.5, -(int)test_below(60));
    if (test_below(3) == 0) /* near a corner: what rounding loses in a large circle */
        angle =
            atan2(p[0].y - c.y, p[0].x - c.x) + ldexp(test_uniform() - 0.5, -(int)test_below(50));
    *q = (struct dt_point){c.x + r * (1 + off) * cos(angle), c.y + r * (1 + off) * sin(angle)};
    if (test_below(8) == 0)
        *q = p[test_below(3)];
    return dt_coordinate_ok(q->x) && dt_coordinate_ok(q->y);
}

TEST(a_disc_meets_every_box_that_has_a_point_of_it)
{
    unsigned in = 0, flat = 0;
    for (unsigned i = 0; i < 200000; i++) {
        struct dt_point p[3], q;
        struct dt_disc d;
        if (!random_triangle(p) || !place_near(p, &q))
            continue;
        bool sure = dt_disc_of(p[0], p[1], p[2], &d);
        struct dt_reach r = dt_reach_of(&d, sure, p[0], p[1], p[2]);
        flat += !sure;
        if (dt_incircle(p[0], p[1], p[2], q) < 0)
            continue;
        in++;
        double w = fabs(coordinate(3)), h = fabs(coordinate(3));
        CHECK(dt_reach_meets(&r, &(struct dt_box){q, q}));
        CHECK(dt_reach_meets(&r, &(struct dt_box){{q.x - w, q.y}, {q.x, q.y + h}}));
        CHECK(dt_reach_meets(&r, &(struct dt_box){{q.x, q.y - h}, {q.x + w, q.y}}));
    }
    CHECK(in > 25000 && flat > 5000);
}

/* The disc of p has no point next to a side of the box, outside. */
static void check_inside(const struct dt_point p[3], struct dt_point c, const struct dt_box *box)
{
    const struct dt_point beyond[4] = {{nextafter(box->lo.x, -HUGE_VAL), c.y},
                                       {nextafter(box->hi.x, HUGE_VAL), c.y},
                                       {c.x, nextafter(box->lo.y, -HUGE_VAL)},
                                       {c.x, nextafter(box->hi.y, HUGE_VAL)}};
    for (unsigned k = 0; k < 4; k++)
        if (dt_coordinate_ok(beyond[k].x) && dt_coordinate_ok(beyond[k].y))
            CHECK(dt_incircle(p[0], p[1], p[2], beyond[k]) < 0);
    for (unsigned k = 0; k < 3; k++)
        CHECK(dt_box_contains(box, p[k]));
}

/* The sides of the box are near the circle. */
TEST(a_disc_inside_a_box_has_no_point_beyond_its_sides)
{
    unsigned inside = 0, close = 0;
    for (unsigned i = 0; i < 200000; i++) {
        struct dt_point p[3];
        struct dt_disc d;
        if (!random_triangle(p) || !dt_disc_of(p[0], p[1], p[2], &d))
            continue;
        struct dt_point c = dt_centre(p[0], p[1], p[2]);
        double r = hypot(p[0].x - c.x, p[0].y - c.y) *
                   (1 + ldexp(test_uniform() - 0.4, -(int)test_below(50)));
        struct dt_box box = {{c.x - r, c.y - r}, {c.x + r, c.y + r}};
        if (!dt_disc_inside(&d, &box))
            continue;
        inside++;
        close += r < 1.001 * hypot(p[0].x - c.x, p[0].y - c.y);
        check_inside(p, c, &box);
    }
    CHECK(inside > 5000 && close > 500);
}

/* The box is about as far from a corner as the diameter of the circle, which another corner may be near. */
TEST(a_disc_deep_inside_a_box_is_within_its_sides)
{
    unsigned deep = 0, close = 0;
    for (unsigned i = 0; i < 200000; i++) {
        struct dt_point p[3];
        if (!random_triangle(p))
            continue;
        struct dt_point c = dt_centre(p[0], p[1], p[2]), a = p[0];
        double r = hypot(a.x - c.x, a.y - c.y);
        double d = 2 * r * (1 + ldexp(test_uniform() - 0.4, -(int)test_below(30)));
        struct dt_box box = {{a.x - d, a.y - d}, {a.x + d, a.y + d}};
        if (!dt_disc_deep(p[0], p[1], p[2], &box))
            continue;
        deep++;
        close += d < 2.001 * r;
        double blur = 0x1p-50 * (fabs(c.x) + fabs(c.y) + fabs(a.x) + fabs(a.y)); /* of r and box */
        CHECK(d + blur > 2 * r);
        check_inside(p, c, &box);
    }
    CHECK(deep > 10000 && close > 1000);
}

/* Tests that always report a meeting would be safe, and useless. */
TEST(boxes_that_are_apart_from_a_disc_are_seen_to_be)
{
    for (unsigned i = 0; i < 100000; i++) {
        struct dt_point p[3] = {{5 + test_uniform(), 7 + test_uniform()},
                                {6 + test_uniform(), 7 + test_uniform()},
                                {6 + test_uniform(), 8.5 + test_uniform()}};
        struct dt_disc d;
        if (dt_orient2d(p[0], p[1], p[2]) <= 0)
            continue;
        bool sure = dt_disc_of(p[0], p[1], p[2], &d);
        struct dt_reach reach = dt_reach_of(&d, sure, p[0], p[1], p[2]);
        struct dt_point c = dt_centre(p[0], p[1], p[2]);
        double r = hypot(p[0].x - c.x, p[0].y - c.y), angle = 6.3 * test_uniform();
        struct dt_point q = {c.x + r * 1.0001 * cos(angle), c.y + r * 1.0001 * sin(angle)};
        CHECK(!dt_reach_meets(&reach, &(struct dt_box){q, q}));
        if (sure)
            CHECK(dt_disc_inside(&d, &(struct dt_box){{c.x - 1.0001 * r, c.y - 1.0001 * r},
                                                      {c.x + 1.0001 * r, c.y + 1.0001 * r}}));
    }
}

/* A box meets the outside of an edge if one of its corners is strictly beyond it: exact. */
TEST(a_box_is_beyond_an_edge_as_its_corners_are)
{
    for (unsigned i = 0; i < 200000; i++) {
        double v[8];
        for (unsigned k = 0; k < 8; k++)
            v[k] = test_below(2) == 0 ? (double)test_below(8) : coordinate(4);
        struct dt_point a = {v[0], v[1]}, b = {v[2], v[3]};
        struct dt_box box = {{fmin(v[4], v[5]), fmin(v[6], v[7])},
                             {fmax(v[4], v[5]), fmax(v[6], v[7])}};
        struct dt_beyond e = {a, b, dt_box_of((struct dt_point[]){a, b}, 2)};
        bool beyond = false;
        for (unsigned k = 0; k < 4; k++) {
            struct dt_point corner = {k & 1 ? box.lo.x : box.hi.x, k & 2 ? box.lo.y : box.hi.y};
            beyond |= dt_orient2d(a, b, corner) > 0;
        }
        CHECK(dt_beyond_meets(&e, &box) == (beyond || dt_box_overlaps(&e.edge, &box)));
    }
}
