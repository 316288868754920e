/* labels_test.c - texts beside points do not cover one another, and lie within the frame. */
#include "clients/pictures/labels.h"

#include <string.h>

#include "tests/test.h"

static bool overlap(const struct label_box *a, const struct label_box *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

TEST(labels_of_crowded_points_do_not_overlap)
{
    enum { POINTS = 2000 };
    static struct label_box box[POINTS];
    struct labels l;
    size_t n = 0;
    CHECK(labels_init(&l, 1000, 500, 30, POINTS));
    for (int i = 0; i < POINTS; i++) {
        double wide = 5 + 25 * test_uniform(), high = 2 + 8 * test_uniform();
        if (labels_place(&l, 1000 * test_uniform(), 500 * test_uniform(), 3, wide, high, &box[n]))
            n++;
    }
    CHECK(n > 500 && n < POINTS);
    for (size_t i = 0; i < n; i++) {
        CHECK(box[i].x0 >= 0 && box[i].y0 >= 0 && box[i].x1 <= 1000 && box[i].y1 <= 500);
        for (size_t k = 0; k < i; k++)
            CHECK(!overlap(&box[i], &box[k]));
    }
    labels_free(&l);
}

TEST(a_label_is_on_the_upper_right_unless_that_is_taken_or_outside)
{
    struct labels l;
    struct label_box a, b, c;
    CHECK(labels_init(&l, 100, 100, 30, 3));
    CHECK(labels_place(&l, 50, 50, 2, 20, 8, &a) && a.x0 > 50 && a.y1 < 50);
    CHECK(labels_place(&l, 50, 50, 2, 20, 8, &b) && b.x1 < 50 && b.y1 < 50);
    CHECK(labels_place(&l, 95, 2, 2, 20, 8, &c) && c.x1 < 95 && c.y0 > 2);
    CHECK(!labels_place(&l, 50, 50, 2, 120, 8, &c));
    labels_free(&l);
}
