/* fields_test.c - values of points: reads now, through views and in copies must equal a table that is written
 * beside. */
#include "core/delaunay_constraints.h"
#include "core/delaunay_fields.h"

#include "tests/test.h"

#include <math.h>
#include <string.h>

enum { MOST = 4096, NAMES = 3 };

static const char *const names[NAMES] = {"a", "ab", "z"};

/* The values that a set should answer: one for each id and name, nan if it is missing. */
struct table {
    bool there[NAMES];
    double value[NAMES][MOST];
};

static bool same(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

static bool is_live(const struct dt *t, uint32_t id)
{
    struct dt_point p;
    return dt_get(t, id, &p) == DT_OK;
}

static void check_summary(const struct dt_field *f, const double *want)
{
    struct dt_field_summary sum;
    uint32_t n = 0;
    double least = (double)INFINITY, most = (double)-INFINITY;
    for (uint32_t id = 0; id < MOST; id++) {
        n += isnan(want[id]) ? 0 : 1;
        least = want[id] < least ? want[id] : least;
        most = want[id] > most ? want[id] : most;
    }
    dt_field_summary(f, &sum);
    CHECK_MSG(sum.values == n, "%s has %u values instead of %u", sum.name, sum.values, n);
    CHECK(n > 0 ? sum.least == least && sum.most == most : isnan(sum.least) && isnan(sum.most));
}

/* Compares the values, read now or through the view, with the table. */
static void check(const struct dt *t, const struct dt_view *v, const struct table *want)
{
    static uint32_t id[MOST];
    static double got[MOST];
    const struct dt_field *f = NULL;
    for (uint32_t i = 0; i < MOST; i++)
        id[i] = i;
    for (unsigned k = 0; k < NAMES; k++) {
        if (!want->there[k])
            continue;
        f = dt_field_next(t, v, f);
        CHECK(f != NULL);
        dt_field_values(f, v, id, MOST, got);
        for (uint32_t i = 0; i < MOST; i++)
            CHECK_MSG(same(got[i], want->value[k][i]), "%s of %u is %g instead of %g", names[k], i,
                      got[i], want->value[k][i]);
        if (v == NULL) {
            check_summary(f, want->value[k]);
            CHECK(dt_field_find(t, names[k], strlen(names[k])) == f);
        }
    }
    CHECK(dt_field_next(t, v, f) == NULL);
}

/* ---- edits of a set and of the table beside it ---- */

static struct table empty(void)
{
    struct table w = {0};
    for (unsigned k = 0; k < NAMES; k++)
        for (uint32_t i = 0; i < MOST; i++)
            w.value[k][i] = (double)NAN;
    return w;
}

static void add(struct dt *t, uint32_t n)
{
    static struct dt_point p[MOST];
    struct dt_added added;
    for (uint32_t i = 0; i < n; i++)
        p[i] = (struct dt_point){test_below(60), test_below(60)};
    if (dt_next_id(t) + n <= MOST)
        CHECK(dt_add(t, p, n, &added) == DT_OK);
}

static double some_value(void)
{
    return test_below(4) == 0 ? (double)NAN : (double)test_below(1000) - 500;
}

static void set_some(struct dt *t, struct table *w, unsigned k)
{
    uint32_t id[40], n = test_below(40), missing;
    double v[40];
    bool all = true;
    for (uint32_t i = 0; i < n; i++) {
        id[i] = test_below(dt_next_id(t));
        v[i] = some_value();
        all = all && is_live(t, id[i]);
    }
    enum dt_status status = dt_field_set(t, names[k], strlen(names[k]), id, v, n, NULL, &missing);
    CHECK(status == (all ? DT_OK : DT_NOPOINT) && (all || !is_live(t, missing)));
    w->there[k] |= all;
    for (uint32_t i = 0; all && i < n; i++)
        w->value[k][id[i]] = v[i];
}

static void add_values(struct dt *t, struct table *w, uint32_t n)
{
    static struct dt_point p[MOST];
    static double v[NAMES][MOST];
    struct dt_values_of column[NAMES];
    struct dt_added added;
    size_t columns = test_below(NAMES + 1), from = test_below(NAMES);
    bool good = dt_next_id(t) + n <= MOST;
    for (uint32_t i = 0; i < n; i++)
        p[i] = (struct dt_point){test_below(60), test_below(60)};
    for (size_t i = 0; i < columns; i++) {
        size_t k = (from + i) % NAMES;
        column[i] = (struct dt_values_of){names[k], strlen(names[k]), v[k]};
        for (uint32_t j = 0; j < n; j++)
            v[k][j] = some_value();
    }
    if (test_below(4) == 0) { /* a point that is refused, at last */
        p[n - 1].x = 1e300;
        CHECK(dt_add_values(t, p, n, column, columns, NULL, &added) == DT_RANGE);
        return;
    }
    if (!good)
        return;
    CHECK(dt_add_values(t, p, n, column, columns, NULL, &added) == DT_OK && added.added == n);
    for (size_t i = 0; i < columns; i++) {
        size_t k = (from + i) % NAMES;
        w->there[k] = true;
        memcpy(w->value[k] + added.first, v[k], n * sizeof v[k][0]);
    }
}

static void set_run(struct dt *t, struct table *w, unsigned k)
{
    static double v[MOST];
    uint32_t first = test_below(dt_next_id(t)), n = test_below(dt_next_id(t) - first), missing;
    for (uint32_t i = 0; i < n; i++)
        v[i] = is_live(t, first + i) ? some_value() : (double)NAN;
    CHECK(dt_field_set_run(t, names[k], strlen(names[k]), first, v, n, NULL, &missing) == DT_OK);
    w->there[k] = true;
    if (n > 0)
        memcpy(w->value[k] + first, v, n * sizeof *v);
}

static void drop(struct dt *t, struct table *w, unsigned k)
{
    enum dt_status status = dt_field_drop(t, names[k], strlen(names[k]));
    CHECK(status == (w->there[k] ? DT_OK : DT_NOFIELD));
    w->there[k] = false;
    for (uint32_t i = 0; i < MOST; i++)
        w->value[k][i] = (double)NAN;
}

static void delete_some(struct dt *t, struct table *w, uint32_t n)
{
    uint32_t id[64], deleted, missing, first = test_below(dt_next_id(t)), k = 0;
    for (uint32_t i = first; i < dt_next_id(t) && k < n; i++)
        if (is_live(t, i))
            id[k++] = i;
    CHECK(dt_delete(t, id, k, &deleted, &missing) == DT_OK && deleted == k);
    for (uint32_t i = 0; i < k; i++)
        for (unsigned f = 0; f < NAMES; f++)
            w->value[f][id[i]] = (double)NAN;
}

static void edit(struct dt *t, struct table *w)
{
    unsigned kind = test_below(100), k = test_below(NAMES);
    if (kind < 5)
        add_values(t, w, 1 + test_below(100));
    else if (kind < 45)
        set_some(t, w, k);
    else if (kind < 60)
        set_run(t, w, k);
    else if (kind < 65)
        drop(t, w, k);
    else if (kind < 75)
        delete_some(t, w, 1);
    else if (kind < 80)
        delete_some(t, w, 64);
    else if (kind < 99)
        dt_move(t, test_below(dt_next_id(t)), (struct dt_point){test_below(60), test_below(60)});
    else
        CHECK(dt_triangulate(t, NULL) == DT_OK);
}

/* ---- tests ---- */

TEST(values_are_those_that_were_set_through_moves_and_deletions)
{
    static struct table w;
    for (unsigned round = 0; round < 12; round++) {
        struct dt *t = dt_new(round % 3);
        w = empty();
        add(t, 600);
        for (unsigned i = 0; i < 100; i++) {
            edit(t, &w);
            check(t, NULL, &w);
        }
        CHECK(dt_triangulate(t, NULL) == DT_OK && dt_check(t, NULL, NULL) == DT_OK);
        dt_free(t);
    }
}

TEST(view_has_the_values_of_its_moment_after_any_edits)
{
    enum { VIEWS = 4 };
    static struct table w, then[VIEWS];
    for (unsigned round = 0; round < 12; round++) {
        struct dt *t = dt_new(0);
        struct dt_view *v[VIEWS] = {NULL};
        w = empty();
        add(t, 1200);
        for (unsigned i = 0; i < 150; i++) {
            unsigned k = test_below(VIEWS);
            for (unsigned edits = test_below(6); edits > 0; edits--)
                edit(t, &w);
            if (v[k] == NULL) {
                v[k] = dt_view_begin(t, false);
                then[k] = w;
                continue;
            }
            check(t, v[k], &then[k]);
            if (test_below(2) == 0) {
                dt_view_end(v[k]);
                v[k] = NULL;
            }
        }
        check(t, NULL, &w);
        for (unsigned k = 0; k < VIEWS; k++)
            dt_view_end(v[k]);
        while (dt_view_tidy(t))
            ;
        dt_free(t);
    }
}

TEST(copies_share_values_until_one_of_them_changes)
{
    static struct table w, of_copy;
    for (unsigned round = 0; round < 12; round++) {
        struct dt *t = dt_new(0), *copy;
        w = empty();
        add(t, 1200);
        for (unsigned i = 0; i < 20; i++)
            edit(t, &w);
        CHECK((round % 2 ? dt_clone(t, &copy) : dt_clone_points(t, NULL, &copy)) == DT_OK);
        of_copy = w;
        for (unsigned i = 0; i < 20; i++) {
            edit(t, &w);
            edit(copy, &of_copy);
        }
        check(t, NULL, &w);
        check(copy, NULL, &of_copy);
        dt_free(round % 4 < 2 ? t : copy);
        t = round % 4 < 2 ? copy : t;
        edit(t, round % 4 < 2 ? &of_copy : &w);
        check(t, NULL, round % 4 < 2 ? &of_copy : &w);
        dt_free(t);
    }
}

static size_t memory_of(const struct dt *t)
{
    struct dt_summary sum;
    dt_summary(t, &sum);
    return sum.memory;
}

static struct dt *line(uint32_t n)
{
    struct dt *t = dt_new(0);
    struct dt_point *p = malloc(n * sizeof *p);
    struct dt_added added;
    for (uint32_t i = 0; i < n; i++)
        p[i] = (struct dt_point){i, 0};
    CHECK(dt_add(t, p, n, &added) == DT_OK);
    free(p);
    return t;
}

static struct dt *from_places(void)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {2, 3}, {2, 1}};
    struct dt_added added;
    struct dt *t = dt_new(0);
    CHECK(t != NULL && dt_add(t, p, 4, &added) == DT_OK);
    return t;
}

/* Edits of points and constraints, and edits of a field, are counted apart; copies go on counting. */
TEST(edits_that_change_a_set_and_those_of_a_field_are_counted)
{
    struct dt *t = from_places(), *copy;
    static const double one = 1;
    static const uint32_t id = 1;
    const struct dt_constraint c = {.a = 0, .b = 3};
    uint32_t missing, deleted;
    size_t added;
    CHECK(dt_field_set(t, "z", 1, &id, &one, 1, NULL, &missing) == DT_OK);
    CHECK(dt_field_set(t, "y", 1, &id, &one, 1, NULL, &missing) == DT_OK);
    const struct dt_field *z = dt_field_find(t, "z", 1);
    uint64_t edits = dt_edits(t), values = dt_field_edits(z);
    CHECK(dt_field_count(z) == 1);
    CHECK(dt_triangulate(t, NULL) == DT_OK && dt_field_drop(t, "y", 1) == DT_OK);
    CHECK(dt_edits(t) == edits && dt_field_edits(z) == values);
    CHECK(dt_field_set(t, "z", 1, &id, &one, 1, NULL, &missing) == DT_OK);
    CHECK(dt_edits(t) == edits && dt_field_edits(z) > values);
    CHECK(dt_clone(t, &copy) == DT_OK && dt_edits(copy) == edits);
    CHECK(dt_field_edits(dt_field_find(copy, "z", 1)) == dt_field_edits(z));
    dt_free(copy);
    CHECK(dt_constrain(t, &c, 1, NULL, &added, &missing) == DT_OK && dt_edits(t) > edits);
    edits = dt_edits(t);
    CHECK(dt_move(t, 1, (struct dt_point){5, 0}) == DT_OK && dt_edits(t) > edits);
    edits = dt_edits(t);
    values = dt_field_edits(z);
    CHECK(dt_delete(t, &id, 1, &deleted, &missing) == DT_OK && dt_edits(t) > edits);
    CHECK(dt_field_edits(z) > values && dt_field_count(z) == 0);
    dt_free(t);
}

TEST(memory_follows_the_ids_that_have_values)
{
    enum { N = 100000 };
    struct dt *t = line(N);
    static uint32_t id[N];
    uint32_t missing, deleted, far[] = {0, 40000, 99999};
    double v[] = {1, 2, 3};
    size_t without = memory_of(t);
    CHECK(dt_field_set(t, "z", 1, far, v, 3, NULL, &missing) == DT_OK);
    size_t with = memory_of(t);
    CHECK(with - without < 3 * (DT_FIELD_PAGE * sizeof(double) + 8192));
    const struct dt_field *f = dt_field_find(t, "z", 1);
    uint64_t from = 0;
    for (unsigned i = 0; i < 3; i++, from += DT_FIELD_PAGE) {
        const double *page = dt_field_page(f, NULL, &from);
        CHECK(page != NULL && from == far[i] - far[i] % DT_FIELD_PAGE);
        CHECK(page[far[i] % DT_FIELD_PAGE] == v[i]);
    }
    CHECK(dt_field_page(f, NULL, &from) == NULL);
    struct dt_view *view = dt_view_begin(t, false);
    for (uint32_t i = 0; i < N; i++)
        id[i] = i;
    CHECK(dt_delete(t, id, N, &deleted, &missing) == DT_OK);
    double then[3];
    dt_field_values(f, view, far, 3, then);
    CHECK(memcmp(then, v, sizeof v) == 0);
    dt_view_end(view);
    while (dt_view_tidy(t))
        ;
    from = 0;
    CHECK(dt_field_page(f, NULL, &from) == NULL && memory_of(t) < with);
    size_t of_none = memory_of(t);
    CHECK(dt_field_drop(t, "z", 1) == DT_OK && memory_of(t) < of_none);
    dt_free(t);
}

TEST(page_is_put_aside_once_for_a_view)
{
    struct dt *t = line(DT_FIELD_PAGE);
    uint32_t missing;
    double v[DT_FIELD_PAGE] = {0};
    CHECK(dt_field_set_run(t, "z", 1, 0, v, DT_FIELD_PAGE, NULL, &missing) == DT_OK);
    struct dt_view *view = dt_view_begin(t, false);
    size_t before = memory_of(t), most = sizeof v + 256;
    for (uint32_t i = 0; i < DT_FIELD_PAGE; i++) {
        v[0] = i;
        CHECK(dt_field_set(t, "z", 1, &i, v, 1, NULL, &missing) == DT_OK);
    }
    CHECK(memory_of(t) - before < most);
    dt_view_end(view);
    while (dt_view_tidy(t))
        ;
    CHECK(memory_of(t) == before);
    dt_free(t);
}

TEST(values_are_finite_and_there_is_one_nan_and_no_negative_zero)
{
    struct dt *t = line(4);
    uint32_t id[] = {0, 1, 2, 3}, missing;
    double v[] = {-0.0, -(double)NAN, 5, 6}, bad[] = {1, (double)INFINITY, 3, 4}, got[4];
    uint64_t bits[4];
    CHECK(dt_field_set(t, "z", 1, id, v, 4, NULL, &missing) == DT_OK);
    CHECK(dt_field_set(t, "z", 1, id, bad, 4, NULL, &missing) == DT_RANGE);
    CHECK(dt_field_set_run(t, "z", 1, 0, bad, 4, NULL, &missing) == DT_RANGE);
    CHECK(dt_field_set(t, "new", 3, id, bad, 4, NULL, &missing) == DT_RANGE);
    CHECK(dt_field_find(t, "new", 3) == NULL);
    dt_field_values(dt_field_find(t, "z", 1), NULL, id, 4, got);
    memcpy(bits, got, sizeof bits);
    CHECK(bits[0] == 0 && bits[1] == 0x7ff8000000000000u && got[2] == 5 && got[3] == 6);
    CHECK(dt_field_set_run(t, "z", 1, 0, v, 4, NULL, &missing) == DT_OK);
    dt_field_values(dt_field_find(t, "z", 1), NULL, id, 4, got);
    memcpy(bits, got, sizeof bits);
    CHECK(bits[0] == 0 && bits[1] == 0x7ff8000000000000u);
    dt_free(t);
}

TEST(run_may_pass_over_ids_without_a_point_with_nan_only)
{
    struct dt *t = line(4);
    uint32_t id = 1, deleted, missing;
    double v[] = {1, (double)NAN, 3, 4, (double)NAN}, bad[] = {1, 2, 3, 4};
    CHECK(dt_delete(t, &id, 1, &deleted, &missing) == DT_OK);
    CHECK(dt_field_set_run(t, "z", 1, 0, bad, 4, NULL, &missing) == DT_NOPOINT && missing == 1);
    CHECK(dt_field_find(t, "z", 1) == NULL);
    CHECK(dt_field_set_run(t, "z", 1, 0, v, 5, NULL, &missing) == DT_OK);
    CHECK(dt_field_set(t, "z", 1, &id, v + 1, 1, NULL, &missing) == DT_NOPOINT && missing == 1);
    CHECK(dt_field_set_run(t, "z", 1, UINT32_MAX - 3, v, 5, NULL, &missing) == DT_NOPOINT);
    dt_free(t);
}

TEST(set_has_64_fields_by_name)
{
    struct dt *t = line(1);
    uint32_t id = 0, missing;
    double v = 1;
    char name[DT_FIELD_NAME + 1], before[DT_FIELD_NAME + 1] = "";
    for (unsigned i = 0; i < DT_MAX_FIELDS; i++) {
        size_t len = (size_t)snprintf(name, sizeof name, "f%u", i * 37 % DT_MAX_FIELDS);
        CHECK(dt_field_set(t, name, len, &id, &v, 1, NULL, &missing) == DT_OK);
    }
    CHECK(dt_field_set(t, "one more", 8, &id, &v, 1, NULL, &missing) == DT_TOOBIG);
    CHECK(dt_field_set(t, "f1", 2, &id, &v, 1, NULL, &missing) == DT_OK);
    unsigned n = 0;
    for (const struct dt_field *f = dt_field_next(t, NULL, NULL); f != NULL;
         f = dt_field_next(t, NULL, f), n++) {
        struct dt_field_summary sum;
        dt_field_summary(f, &sum);
        CHECK(strcmp(before, sum.name) < 0);
        strcpy(before, sum.name);
    }
    CHECK(n == DT_MAX_FIELDS);
    memset(name, 'x', sizeof name);
    CHECK(dt_field_drop(t, "f1", 2) == DT_OK && dt_field_drop(t, "f1", 2) == DT_NOFIELD);
    CHECK(dt_field_set(t, name, DT_FIELD_NAME, &id, &v, 1, NULL, &missing) == DT_OK);
    CHECK(dt_field_set(t, name, sizeof name, &id, &v, 1, NULL, &missing) == DT_NOFIELD);
    CHECK(dt_field_set(t, "", 0, &id, &v, 1, NULL, &missing) == DT_NOFIELD);
    dt_free(t);
}

/* Each allocation fails, one after the other, with a view open and pages shared with a copy. */
TEST(edit_of_values_that_lacks_memory_changes_nothing)
{
    static struct table w;
    for (unsigned kind = 0; kind < 6; kind++) {
        bool failed = true;
        for (long n = 1; failed; n++) {
            struct dt *t = line(1200), *copy;
            uint32_t id[] = {3, 700, 1100}, missing, deleted;
            double v[] = {7, 8, 9};
            w = empty();
            set_run(t, &w, 0);
            set_some(t, &w, 0);
            CHECK(dt_clone(t, &copy) == DT_OK);
            struct dt_point p[] = {{1, 1}, {2, 1}, {3, 1}};
            struct dt_values_of both[] = {{names[0], 1, v}, {names[2], 1, v}};
            struct dt_added added;
            struct dt_view *view = kind != 4 ? dt_view_begin(t, false) : NULL;
            enum dt_status status;
            test_fail_alloc(n);
            if (kind == 0)
                status = dt_field_set(t, names[0], 1, id, v, 3, NULL, &missing);
            else if (kind == 1)
                status = dt_field_set_run(t, names[2], 1, 510, v, 3, NULL, &missing);
            else if (kind == 2)
                status = dt_delete(t, id, 3, &deleted, &missing);
            else if (kind == 3)
                status = dt_field_drop(t, names[0], 1);
            else if (kind == 4)
                status = dt_field_set_run(t, names[0], 1, 510, v, 3, NULL, &missing);
            else
                status = dt_add_values(t, p, 3, both, 2, NULL, &added);
            failed = test_alloc_failed();
            test_fail_alloc(0);
            CHECK(status == DT_OK || (failed && status == DT_NOMEM));
            if (status != DT_OK)
                check(t, NULL, &w);
            if (view != NULL)
                check(t, view, &w);
            check(copy, NULL, &w);
            dt_view_end(view);
            dt_free(t);
            dt_free(copy);
        }
    }
}

TEST(edit_of_values_ends_at_its_limit_of_steps_and_when_cancelled)
{
    struct dt *t = line(5000);
    static double v[5000];
    uint32_t missing;
    dt_atomic_bool cancel = true;
    struct dt_options few = {.steps = 1000}, never = {.cancel = &cancel};
    CHECK(dt_field_set_run(t, "z", 1, 0, v, 5000, &few, &missing) == DT_TOOLONG);
    CHECK(dt_field_set_run(t, "z", 1, 0, v, 5000, &never, &missing) == DT_CANCELLED);
    CHECK(dt_field_find(t, "z", 1) == NULL);
    CHECK(dt_field_set_run(t, "z", 1, 0, v, 100, &few, &missing) == DT_OK);
    dt_free(t);
}

/* One id after the other, so that every least and every greatest value is overwritten at some time. */
TEST(least_and_greatest_value_follow_each_value_that_is_overwritten)
{
    static struct table w;
    struct dt *t = line(8);
    uint32_t missing;
    w = empty();
    w.there[0] = true;
    for (unsigned i = 0; i < 500; i++) {
        uint32_t id = test_below(8);
        w.value[0][id] = some_value();
        CHECK(dt_field_set(t, names[0], 1, &id, &w.value[0][id], 1, NULL, &missing) == DT_OK);
        check(t, NULL, &w);
    }
    dt_free(t);
}
