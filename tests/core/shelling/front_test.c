/* front_test.c - the circular edge list: each touch case by hand, then random shellings of a
 * polygon's fan. */
#include "core/shelling/front.h"

#include "tests/test.h"

enum { POINTS = 40 };

/* Both circles are sound: the awake edges are a part of the front, in its order. Returns the length
 * of the front through a. */
static uint32_t check_front(const struct dt_front *f, uint32_t a)
{
    uint32_t length = 0, awake = 0, v = a, last_awake = DT_NONE;
    do {
        CHECK(f->node[f->node[v].next].previous == v);
        if (f->node[v].awake_next != DT_NONE) {
            CHECK(f->node[f->node[v].awake_next].awake_previous == v);
            CHECK(last_awake == DT_NONE || f->node[last_awake].awake_next == v);
            last_awake = v;
            awake++;
        }
        v = f->node[v].next;
        CHECK(++length <= POINTS);
    } while (v != a);
    CHECK((f->current == DT_NONE) == (awake == 0));
    if (awake > 0) {
        v = f->current;
        for (uint32_t k = 0; k < awake; k++)
            v = f->node[v].awake_next;
        CHECK(v == f->current);
    }
    return length;
}

static struct dt_front triangle(void)
{
    struct dt_front f = {.node = NULL};
    CHECK(dt_front_init(&f, POINTS, NULL) == DT_OK);
    dt_front_open(&f, 0, 1, 2, 0);
    return f;
}

static void grow(struct dt_front *f, uint32_t a, uint32_t c, uint32_t h)
{
    f->node[a].apex = c;
    CHECK(dt_front_touch(f, a) == DT_NEW_POINT);
    dt_front_new_point(f, a, h);
}

TEST(the_front_of_a_triangle_runs_clockwise_around_it)
{
    struct dt_front f = triangle();
    CHECK(check_front(&f, 0) == 3);
    CHECK(f.node[0].next == 2 && f.node[2].next == 1 && f.node[1].next == 0);
    CHECK(f.node[1].outer == 0 && f.node[2].outer == 1 && f.node[0].outer == 2);
    CHECK(f.node[0].apex == DT_UNSEARCHED);
    dt_front_clear(&f);
}

TEST(a_new_point_makes_two_edges_of_one)
{
    struct dt_front f = triangle();
    grow(&f, 0, 3, 8);
    CHECK(check_front(&f, 0) == 4);
    CHECK(f.node[0].next == 3 && f.node[3].next == 2);
    CHECK(f.node[0].outer == 10 && f.node[3].outer == 9);
    CHECK(f.current == 3 && f.node[3].apex == DT_UNSEARCHED && f.node[0].apex == DT_UNSEARCHED);
    dt_front_clear(&f);
}

TEST(a_right_touch_encloses_the_end_of_the_edge)
{
    struct dt_front f = triangle();
    grow(&f, 0, 3, 8); /* 0 3 2 1 */
    f.node[3].apex = 1;
    CHECK(dt_front_touch(&f, 3) == DT_RIGHT_TOUCH);
    dt_front_right_touch(&f, 3, 16);
    CHECK(check_front(&f, 0) == 3 && f.node[3].next == 1 && f.node[2].next == DT_NONE);
    CHECK(f.node[3].outer == 18 && f.current == 3 && f.node[3].apex == DT_UNSEARCHED);
    dt_front_clear(&f);
}

TEST(a_left_touch_encloses_the_start_of_the_edge)
{
    struct dt_front f = triangle();
    grow(&f, 0, 3, 8); /* 0 3 2 1 */
    f.node[2].apex = 3;
    CHECK(dt_front_touch(&f, 2) == DT_LEFT_TOUCH);
    dt_front_left_touch(&f, 2, 16);
    CHECK(check_front(&f, 0) == 3 && f.node[3].next == 1 && f.node[2].next == DT_NONE);
    CHECK(f.node[3].outer == 17 && f.current == 3);
    dt_front_clear(&f);
}

TEST(an_edge_sleeps_over_a_cave_until_its_neighbour_changes)
{
    struct dt_front f = triangle();
    grow(&f, 0, 3, 8);
    grow(&f, 3, 4, 16); /* 0 3 4 2 1 */
    f.node[0].apex = 2;
    CHECK(dt_front_touch(&f, 0) == DT_NO_TOUCH);
    dt_front_sleep(&f, 0);
    CHECK(check_front(&f, 0) == 5 && f.node[0].awake_next == DT_NONE);
    f.node[3].apex = 2;
    CHECK(dt_front_touch(&f, 3) == DT_RIGHT_TOUCH); /* closes the cave, all but 0 3 2 */
    dt_front_right_touch(&f, 3, 24);
    CHECK(check_front(&f, 0) == 4 && f.node[0].awake_next != DT_NONE);
    CHECK(dt_front_touch(&f, 0) == DT_RIGHT_TOUCH && f.node[0].apex == 2);
    dt_front_clear(&f);
}

TEST(a_sleeping_edge_also_wakes_for_a_left_touch)
{
    struct dt_front f = triangle();
    grow(&f, 0, 3, 8);
    grow(&f, 3, 4, 16); /* 0 3 4 2 1 */
    f.node[2].apex = 3;
    CHECK(dt_front_touch(&f, 2) == DT_NO_TOUCH);
    dt_front_sleep(&f, 2);
    f.node[4].apex = 3;
    f.node[3].apex = 2; /* closed from the other side, by edge 3 */
    dt_front_right_touch(&f, 3, 24);
    CHECK(check_front(&f, 0) == 4 && f.node[2].awake_next != DT_NONE);
    CHECK(dt_front_touch(&f, 2) == DT_LEFT_TOUCH);
    dt_front_clear(&f);
}

TEST(boundary_edges_sleep_until_none_is_awake)
{
    struct dt_front f = triangle();
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t a = f.current;
        CHECK(a != DT_NONE);
        f.node[a].apex = DT_NONE;
        CHECK(dt_front_touch(&f, a) == DT_BOUNDARY);
        dt_front_sleep(&f, a);
        check_front(&f, 0);
    }
    CHECK(f.current == DT_NONE);
    dt_front_clear(&f);
}

/* Any sequence of cases keeps both circles sound. */
TEST(random_growth_keeps_both_lists_sound)
{
    for (unsigned round = 0; round < 300; round++) {
        struct dt_front f = triangle();
        uint32_t used = 3, h = 8;
        for (unsigned turn = 0; turn < 120 && f.current != DT_NONE; turn++, h += 8) {
            uint32_t a = f.current, b = f.node[a].next, length = check_front(&f, a);
            struct dt_front_node *n = &f.node[a];
            if (n->apex == DT_UNSEARCHED) {
                uint32_t any = a;
                for (uint32_t k = test_below(length); k > 0; k--)
                    any = f.node[any].next;
                n->apex = test_below(3) == 0 && used < POINTS ? used++
                          : any == a || any == b              ? DT_NONE
                                                              : any;
            }
            switch (dt_front_touch(&f, a)) {
            case DT_NEW_POINT:
                dt_front_new_point(&f, a, h);
                CHECK(check_front(&f, f.current) == length + 1);
                break;
            case DT_RIGHT_TOUCH:
                if (length > 3)
                    dt_front_right_touch(&f, a, h);
                else
                    dt_front_sleep(&f, a);
                break;
            case DT_LEFT_TOUCH:
                if (length > 3)
                    dt_front_left_touch(&f, a, h);
                else
                    dt_front_sleep(&f, a);
                break;
            default:
                dt_front_sleep(&f, a);
            }
        }
        dt_front_clear(&f);
    }
}
