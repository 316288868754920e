/* delaunay_test.c - the public interface of a set: creation, edits, and when the triangulation is
 * current. */
#include <math.h>
#include <stdlib.h>

#include "core/delaunay.h"
#include "proto/number.h"
#include "tests/core/threads.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

static const struct dt_point square[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};

static struct dt *square_set(void)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(dt_add(t, square, 5, &added) == DT_OK && added.first == 0 && added.added == 5);
    return t;
}

static struct dt_summary summary_of(const struct dt *t)
{
    struct dt_summary s;
    dt_summary(t, &s);
    return s;
}

TEST(set_is_triangulated_on_request)
{
    struct dt *t = square_set();
    CHECK(!summary_of(t).triangulated && summary_of(t).triangles == 0);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    struct dt_summary s = summary_of(t);
    CHECK(s.triangulated && s.points == 5 && s.triangles == 4 && s.edges == 8 && s.hull == 4);
    dt_free(t);
}

TEST(empty_and_tiny_sets_have_a_triangulation)
{
    const uint32_t edges[] = {0, 0, 1, 3};
    for (uint32_t n = 0; n <= 3; n++) {
        struct dt *t = dt_new(0);
        struct dt_added added;
        CHECK(dt_add(t, square, n, &added) == DT_OK);
        CHECK(dt_triangulate(t, NULL) == DT_OK);
        struct dt_summary s = summary_of(t);
        CHECK(s.points == n && s.hull == n && s.edges == edges[n] && s.triangles == (n == 3));
        dt_free(t);
    }
}

TEST(a_small_living_set_takes_a_few_pages_of_memory)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    for (int i = 0; i < 5; i++)
        CHECK(dt_add(t, &square[i], 1, &added) == DT_OK);
    CHECK_MSG(summary_of(t).memory < 10000, "%zu bytes", summary_of(t).memory);
    dt_free(t);
}

TEST(edits_after_triangulate_are_seen_after_refresh)
{
    struct dt *t = square_set();
    struct dt_added added;
    uint32_t deleted, missing, four = 4;
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_delete(t, &four, 1, &deleted, &missing) == DT_OK && deleted == 1);
    CHECK(dt_refresh(t, NULL) == DT_OK && summary_of(t).triangles == 2);
    CHECK(dt_add(t, &square[4], 1, &added) == DT_OK && added.first == 5);
    CHECK(dt_refresh(t, NULL) == DT_OK && summary_of(t).triangles == 4);
    CHECK(dt_move(t, 5, (struct dt_point){9, 2}) == DT_OK);
    CHECK(dt_refresh(t, NULL) == DT_OK);
    CHECK(summary_of(t).hull == 5 && summary_of(t).triangles == 3);
    dt_free(t);
}

TEST(coordinates_beyond_the_exact_range_are_refused)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    const double bad[] = {(double)NAN, HUGE_VAL, -HUGE_VAL, 0x1.8p201,
                          -0x1p202,    0x1p-143, -0x1p-1074};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct dt_point p[] = {{1, 1}, {0, bad[i]}};
        CHECK(dt_add(t, p, 2, &added) == DT_RANGE);
    }
    CHECK(summary_of(t).points == 0);
    struct dt_point p[] = {{0x1p201, -0x1p201}, {0x1p-142, -0.0}};
    CHECK(dt_add(t, p, 2, &added) == DT_OK);
    CHECK(dt_move(t, 0, (struct dt_point){(double)NAN, 0}) == DT_RANGE);
    dt_free(t);
}

TEST(many_coordinates_are_valid_if_each_of_them_is)
{
    const double other[] = {0,
                            -0.0,
                            0x1p-142,
                            -0x1p201,
                            (double)NAN,
                            HUGE_VAL,
                            0x1.0000000000001p201,
                            -0x1p202,
                            0x1.fffffffffffffp-143,
                            -0x1p-1074};
    for (size_t n = 1; n <= 7; n++)
        for (size_t i = 0; i < n; i++)
            for (size_t k = 0; k < sizeof other / sizeof *other; k++) {
                double v[] = {1, -2, 3, -4, 5, -6, 7};
                v[i] = other[k];
                CHECK(dt_coordinates_ok(v, n) == (k < 4) && dt_coordinate_ok(v[i]) == (k < 4));
                CHECK(proto_is_coordinate(v[i]) == (k < 4)); /* for clients */
                CHECK(dt_coordinates_ok(v, i));
            }
}

/* They are checked in pieces of 65,536, by several threads. */
TEST(one_invalid_point_of_many_is_found_wherever_it_is)
{
    enum { N = 200000 };
    const size_t where[] = {0, 65535, 65536, 131072, N - 1};
    struct dt_pool pool = threads_pool(3);
    struct dt_point *p = calloc(N, sizeof *p);
    struct dt_added added;
    CHECK(p != NULL);
    for (size_t i = 0; i < sizeof where / sizeof *where; i++)
        for (int threads = 0; threads < 2; threads++) {
            struct dt_options opt = {.pool = threads ? &pool : NULL};
            struct dt *t = dt_new(0);
            p[where[i]].y = 0x1p202;
            CHECK(dt_add_many(t, p, N, &opt, &added) == DT_RANGE && summary_of(t).points == 0);
            p[where[i]].y = 0;
            dt_free(t);
        }
    free(p);
}

TEST(deleting_is_all_or_none)
{
    struct dt *t = square_set();
    uint32_t ids[] = {1, 9, 2}, deleted = 0, missing = 0;
    struct dt_point p;
    CHECK(dt_delete(t, ids, 3, &deleted, &missing) == DT_NOPOINT && missing == 9);
    CHECK(summary_of(t).points == 5);
    ids[1] = 1;
    CHECK(dt_delete(t, ids, 3, &deleted, &missing) == DT_OK && deleted == 2);
    CHECK(dt_get(t, 1, &p) == DT_NOPOINT && dt_get(t, 0, &p) == DT_OK);
    dt_free(t);
}

TEST(deleting_a_representative_and_its_aliases_at_once_leaves_the_heir)
{
    struct dt *t = dt_new(0);
    struct dt_point p[6];
    struct dt_added added;
    uint32_t ids[] = {2, 0, 1}, deleted, missing, rep;
    for (uint32_t i = 0; i < 6; i++)
        p[i] = (struct dt_point){7, 7};
    CHECK(dt_add(t, p, 6, &added) == DT_OK && added.coincident == 5);
    CHECK(dt_delete(t, ids, 3, &deleted, &missing) == DT_OK && deleted == 3);
    CHECK(dt_representative(t, 5, &rep) == DT_OK && rep == 3);
    CHECK(dt_representative(t, 3, &rep) == DT_OK && rep == 3);
    CHECK(dt_representative(t, 0, &rep) == DT_NOPOINT);
    dt_free(t);
}

TEST(clone_is_independent)
{
    struct dt *t = square_set(), *copy;
    uint32_t zero = 0, deleted, missing;
    CHECK(dt_triangulate(t, NULL) == DT_OK && dt_clone(t, &copy) == DT_OK);
    CHECK(dt_delete(t, &zero, 1, &deleted, &missing) == DT_OK && dt_refresh(t, NULL) == DT_OK);
    CHECK(summary_of(copy).triangles == 4 && summary_of(t).triangles == 2);
    CHECK(dt_check(copy, NULL, NULL) == DT_OK && dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
    CHECK(dt_move(copy, 4, (struct dt_point){1, 2}) == DT_OK && dt_refresh(copy, NULL) == DT_OK);
    CHECK(dt_check(copy, NULL, NULL) == DT_OK);
    dt_free(copy);
}

TEST(every_edit_out_of_memory_leaves_the_set_as_it_was)
{
    for (long nth = 1; nth < 40; nth++) {
        struct dt *t = square_set(), *copy = NULL;
        struct dt_added added;
        uint32_t one = 1, deleted, missing;
        test_fail_alloc(nth);
        if (dt_triangulate(t, NULL) != DT_OK)
            CHECK(!summary_of(t).triangulated);
        if (dt_add(t, square, 2, &added) != DT_OK)
            CHECK(summary_of(t).points == 5);
        if (dt_delete(t, &one, 1, &deleted, &missing) != DT_OK)
            CHECK(dt_get(t, 1, &(struct dt_point){0}) == DT_OK);
        dt_clone(t, &copy);
        test_fail_alloc(0);
        CHECK(dt_triangulate(t, NULL) == DT_OK && dt_refresh(t, NULL) == DT_OK);
        CHECK(dt_check(t, NULL, NULL) == DT_OK);
        dt_free(copy);
        dt_free(t);
    }
}

TEST(memory_of_a_triangulated_set_is_at_most_100_bytes_a_point)
{
    enum { N = 200000 };
    struct dt_point *p = malloc(N * sizeof *p);
    struct dt *t = dt_new(0);
    struct dt_added added;
    family_points(family_find("uniform"), p, N, 1);
    CHECK(dt_add(t, p, N, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    CHECK_MSG(summary_of(t).memory <= 100 * (size_t)N, "%zu bytes", summary_of(t).memory);
    dt_free(t);
    free(p);
}
