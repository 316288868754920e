/* restore_test.c - a restored set behaves as the original. */
#include "core/delaunay.h"

#include "tests/test.h"

#include <stdlib.h>

struct list {
    uint32_t *id, *representative;
    struct dt_point *p;
    size_t n;
};

static struct list list_of(const struct dt *t)
{
    struct dt_cursor c;
    struct dt_summary sum;
    size_t words, rows;
    dt_summary(t, &sum);
    struct list l = {.id = malloc((sum.points + 8) * sizeof(uint32_t)),
                     .representative = malloc((sum.points + 8) * sizeof(uint32_t)),
                     .p = malloc((sum.points + 8) * sizeof(struct dt_point))};
    CHECK(dt_table_begin(t, NULL, DT_POINTS, false, &c) == DT_OK);
    do {
        CHECK(dt_table_read(t, &c, l.id + l.n, sum.points + 8 - l.n, SIZE_MAX, &rows, &words) ==
              DT_OK);
        l.n += rows;
    } while (rows > 0);
    for (size_t i = 0; i < l.n; i++) {
        CHECK(dt_get(t, l.id[i], &l.p[i]) == DT_OK);
        CHECK(dt_representative(t, l.id[i], &l.representative[i]) == DT_OK);
    }
    return l;
}

static void free_list(struct list *l)
{
    free(l->id);
    free(l->representative);
    free(l->p);
}

static struct dt_point somewhere(void)
{
    return (struct dt_point){test_below(12), test_below(12)};
}

/* The same random edit of both. */
static void edit(struct dt *a, struct dt *b)
{
    uint32_t id = test_below(400), n, m, missing;
    struct dt_point p = somewhere();
    struct dt_added x, y;
    switch (test_below(4)) {
    case 0:
        CHECK(dt_delete(a, &id, 1, &n, &missing) == dt_delete(b, &id, 1, &m, &missing));
        break;
    case 1:
        CHECK(dt_move(a, id, p) == dt_move(b, id, p));
        break;
    default:
        CHECK(dt_add(a, &p, 1, &x) == DT_OK && dt_add(b, &p, 1, &y) == DT_OK);
        CHECK(x.first == y.first && x.coincident == y.coincident);
        break;
    }
}

static void check_equal(const struct dt *a, const struct dt *b)
{
    struct list x = list_of(a), y = list_of(b);
    CHECK(x.n == y.n && dt_next_id(a) == dt_next_id(b));
    for (size_t i = 0; i < x.n; i++)
        CHECK(x.id[i] == y.id[i] && x.representative[i] == y.representative[i] &&
              x.p[i].x == y.p[i].x && x.p[i].y == y.p[i].y);
    free_list(&x);
    free_list(&y);
}

static struct dt *restored(const struct dt *t)
{
    struct list l = list_of(t);
    struct dt *copy = dt_new(dt_tolerance(t));
    CHECK(dt_restore(copy, l.id, l.p, l.representative, l.n, dt_next_id(t), NULL) == DT_OK);
    free_list(&l);
    return copy;
}

TEST(restored_set_continues_like_the_original)
{
    const double tolerance[] = {0, 0.5, 1.5};
    for (int round = 0; round < 60; round++) {
        struct dt *a = dt_new(tolerance[round % 3]), *twin = dt_new(tolerance[round % 3]);
        for (int i = 0; i < 300; i++)
            edit(a, twin);
        dt_free(twin);
        struct dt *b = restored(a);
        check_equal(a, b);
        for (int i = 0; i < 300; i++)
            edit(a, b);
        check_equal(a, b);
        if (round % 3 == 0) {
            CHECK(dt_triangulate(b, NULL) == DT_OK && dt_check(b, NULL, NULL) == DT_OK);
        }
        dt_free(a);
        dt_free(b);
    }
}

TEST(restored_set_never_gives_an_id_again)
{
    const uint32_t ids[] = {2, 5};
    const struct dt_point p[] = {{0, 0}, {1, 1}};
    struct dt_added added;
    struct dt *t = dt_new(0);
    CHECK(dt_restore(t, ids, p, ids, 2, 1000000, NULL) == DT_OK);
    CHECK(dt_add(t, p, 1, &added) == DT_OK && added.first == 1000000 && added.coincident == 1);
    dt_free(t);
}

/* The result of dt_restore for three points with next id 9, in a new set. */
static enum dt_status restore_three(const uint32_t *ids, const struct dt_point *p,
                                    const uint32_t *representatives)
{
    struct dt *t = dt_new(0);
    enum dt_status status = dt_restore(t, ids, p, representatives, 3, 9, NULL);
    CHECK(dt_next_id(t) == (status == DT_OK ? 9 : 0));
    dt_free(t);
    return status;
}

TEST(set_whose_ids_have_run_out_accepts_no_more_points)
{
    const uint32_t id = 7;
    const struct dt_point p[] = {{0, 0}, {1, 1}, {2, 2}};
    struct dt_added added;
    for (unsigned live = 0; live < 2; live++) {
        struct dt *t = dt_new(0);
        CHECK(dt_restore(t, &id, p, &id, 1, UINT32_MAX - 2, NULL) == DT_OK);
        CHECK(!live || dt_triangulate(t, NULL) == DT_OK);
        CHECK(dt_add(t, p, 3, &added) == DT_TOOBIG && dt_next_id(t) == UINT32_MAX - 2);
        CHECK(dt_add(t, p + 1, 2, &added) == DT_OK && added.first == UINT32_MAX - 2);
        CHECK(dt_add(t, p, 1, &added) == DT_TOOBIG);
        dt_free(t);
    }
}

TEST(restore_refuses_invalid_sets)
{
    const struct dt_point apart[] = {{0, 0}, {1, 1}, {2, 2}}, same[] = {{0, 0}, {0, 0}, {0, 0}};
    const struct dt_point wild_x[] = {{0, 0}, {1e300, 1}, {2, 2}};
    const struct dt_point wild_y[] = {{0, 0}, {1, 1}, {2, -0x1p-143}};
    const uint32_t good[] = {1, 2, 8}, twice[] = {1, 2, 2}, falling[] = {2, 1, 3};
    const uint32_t next[] = {1, 2, 9}, chain[] = {1, 1, 2}, stranger[] = {1, 2, 7},
                   aliased[] = {1, 1, 1};
    CHECK(restore_three(good, apart, good) == DT_OK);
    CHECK(restore_three(good, same, aliased) == DT_OK);
    CHECK(restore_three(twice, apart, twice) == DT_CORRUPT);
    CHECK(restore_three(falling, apart, falling) == DT_CORRUPT);
    CHECK(restore_three(next, apart, next) == DT_CORRUPT);
    CHECK(restore_three(good, same, chain) == DT_CORRUPT);
    CHECK(restore_three(good, apart, stranger) == DT_CORRUPT);
    CHECK(restore_three(good, wild_x, good) == DT_RANGE);
    CHECK(restore_three(good, wild_y, good) == DT_RANGE);
    struct dt *t = dt_new(0);
    CHECK(dt_restore(t, good, apart, good, 3, 9, NULL) == DT_OK);
    CHECK(dt_restore(t, good, apart, good, 3, 9, NULL) == DT_CORRUPT);
    dt_free(t);
}

TEST(restore_refuses_two_representatives_at_one_place_however_many_others_there_are)
{
    enum { MANY = 9000 };
    static uint32_t ids[MANY];
    static struct dt_point p[MANY];
    for (unsigned round = 0; round < 16; round++) {
        uint32_t n = round % 4 < 2 ? 2 + test_below(40) : MANY - test_below(4000);
        uint32_t a = test_below(n), b = (a + 1 + test_below(n - 1)) % n;
        struct dt *t = dt_new(round % 2 == 0 ? 0 : 0.25);
        for (uint32_t i = 0; i < n; i++) {
            ids[i] = i;
            p[i] = (struct dt_point){i % 90, i / 90};
        }
        p[a] = p[b] = (struct dt_point){-7, 0};
        p[b].y = -0.0;
        CHECK_MSG(dt_restore(t, ids, p, ids, n, n, NULL) == DT_CORRUPT, "%u and %u of %u", a, b, n);
        CHECK(dt_next_id(t) == 0);
        p[a].x = -7.125; /* within the tolerance, which edits can bring about */
        CHECK(dt_restore(t, ids, p, ids, n, n, NULL) == DT_OK);
        dt_free(t);
    }
}

TEST(restore_without_a_tolerance_refuses_an_alias_elsewhere_or_below_its_representative)
{
    const uint32_t ids[] = {1, 2}, first[] = {1, 1}, second[] = {2, 2};
    const struct dt_point same[] = {{3, 4}, {3, 4}}, apart[] = {{3, 4}, {3, 4.5}};
    for (unsigned tolerant = 0; tolerant < 2; tolerant++) {
        enum dt_status want = tolerant ? DT_OK : DT_CORRUPT;
        struct dt *a = dt_new(tolerant ? 1 : 0), *b = dt_new(tolerant ? 1 : 0);
        CHECK(dt_restore(a, ids, apart, first, 2, 9, NULL) == want);
        CHECK(dt_restore(b, ids, same, second, 2, 9, NULL) == want);
        dt_free(a);
        dt_free(b);
    }
}

TEST(restore_out_of_memory_leaves_the_set_fresh)
{
    const uint32_t ids[] = {1, 5000, 70000}, aliased[] = {1, 5000, 1};
    const struct dt_point p[] = {{0, 0}, {1, 1}, {0, 0}};
    struct dt *t = dt_new(0);
    for (long n = 1;; n++) {
        test_fail_alloc(n);
        enum dt_status status = dt_restore(t, ids, p, aliased, 3, 70001, NULL);
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        if (!failed) {
            CHECK(status == DT_OK && n > 4);
            break;
        }
        CHECK(status == DT_NOMEM && dt_next_id(t) == 0);
    }
    dt_free(t);
}
