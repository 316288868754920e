/* table_test.c - whole-set tables against brute force, with buffers of all sizes. */
#include <math.h>
#include <stdlib.h>

#include "tests/core/sets.h"
#include "tests/test.h"

#define TAU 6.283185307179586

static const enum dt_table tables[] = {DT_POINTS,    DT_COINCIDENT, DT_LISTS,
                                       DT_TRIANGLES, DT_EDGES,      DT_HULL};

/* Reads the cursor to its end through a buffer of cap words, at most max_rows rows at a time; a row
 * that does not fit gets the buffer it asks for. Returns how many there were. */
static size_t read_cursor(const struct dt *t, struct dt_cursor *c, size_t cap, size_t max_rows,
                          struct dt_ids *out)
{
    size_t rows, words, total = 0;
    for (;;) {
        uint32_t *buffer = malloc((cap + 1) * sizeof *buffer);
        buffer[cap] = 0xC0FFEE;
        enum dt_status s = dt_table_read(t, c, buffer, cap, max_rows, &rows, &words);
        CHECK(buffer[cap] == 0xC0FFEE);
        if (s == DT_TOOSMALL) {
            CHECK(rows == 0 && words > cap && (c->table == DT_LISTS || words <= 8));
            size_t need = words;
            buffer = realloc(buffer, need * sizeof *buffer);
            s = dt_table_read(t, c, buffer, need, max_rows, &rows, &words);
            CHECK(rows == 1 && words == need);
        }
        CHECK(s == DT_OK && rows <= max_rows);
        append_ids(out, buffer, words);
        free(buffer);
        total += rows;
        if (rows == 0)
            return total;
    }
}

static void read_table(const struct dt *t, enum dt_table table, bool cw, size_t cap,
                       size_t max_rows, struct dt_ids *out)
{
    struct dt_cursor c;
    CHECK(dt_table_begin(t, NULL, table, cw, &c) == DT_OK);
    CHECK(c.hull_at == DT_NONE); /* no walk along the hull yet */
    CHECK(read_cursor(t, &c, cap, max_rows, out) == c.rows);
}

/* The same in parts of up to 2 * ids - 1 ids each, some rows read before the first cut. */
static void read_in_parts(const struct dt *t, enum dt_table table, bool cw, uint32_t ids,
                          struct dt_ids *out)
{
    struct dt_cursor c, part;
    uint32_t buffer[100];
    size_t total, words;
    CHECK(dt_table_begin(t, NULL, table, cw, &c) == DT_OK);
    enum dt_status s = dt_table_read(t, &c, buffer, 100, test_below(4), &total, &words);
    CHECK(s == DT_OK || s == DT_TOOSMALL);
    append_ids(out, buffer, s == DT_OK ? words : 0);
    while (dt_table_cut(t, &c, 1 + test_below(2 * ids - 1), &part))
        total += read_cursor(t, &part, 8 + test_below(200), 1000000, out);
    CHECK(total == c.rows);
    CHECK(!dt_table_cut(t, &c, 1, &part));
}

static void check_tables(const struct pair *pair)
{
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        for (int cw = 0; cw < 2; cw++) {
            struct dt_ids want = {0};
            brute_table(pair->b, tables[i], cw, &want);
            const size_t caps[] = {100000, 0, 1 + test_below(9), 8 + test_below(200)};
            for (int k = 0; k < 4; k++) {
                struct dt_ids got = {0};
                read_table(pair->t, tables[i], cw, caps[k],
                           k % 2 == 0 ? 1000000 : 1 + test_below(5), &got);
                check_equal_ids(table_names[i], &got, &want);
                got.n = 0;
                read_in_parts(pair->t, tables[i], cw, k == 0 ? 1000000 : 1 + test_below(30), &got);
                check_equal_ids(table_names[i], &got, &want);
                free(got.v);
            }
            free(want.v);
        }
    }
}

TEST_TIMEOUT(tables_equal_brute_force_on_every_family, 60)
{
    for_each_pair(check_tables);
}

TEST(lists_report_how_many_points_are_interior)
{
    const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}, {1, 2}};
    struct pair pair = pair_of(p, 6);
    struct dt_cursor c;
    CHECK(dt_table_begin(pair.t, NULL, DT_LISTS, false, &c) == DT_OK && c.rows == 6 &&
          c.interior == 2);
    CHECK(dt_table_begin(pair.t, NULL, DT_TRIANGLES, false, &c) == DT_OK && c.rows == 6 &&
          c.interior == 0);
    pair_free(&pair);
}

/* A wheel of n points around a hub, which is joined to all of them: more than a batch of stars
 * holds. Then `others` points far away. */
static struct pair wheel(uint32_t n, uint32_t hub, uint32_t others)
{
    struct dt_point p[800];
    for (uint32_t i = 0; i <= n; i++) {
        uint32_t k = i < hub ? i : i - 1;
        p[i] = (struct dt_point){cos(k * TAU / n), sin(k * TAU / n)};
    }
    p[hub] = (struct dt_point){0, 0};
    for (uint32_t i = 0; i < others; i++)
        p[n + 1 + i] = (struct dt_point){100 + test_uniform(), test_uniform()};
    return pair_of(p, n + 1 + others);
}

static void check_hub(uint32_t n, uint32_t hub, uint32_t others)
{
    struct pair pair = wheel(n, hub, others);
    struct dt_ids ring = {0};
    brute_ring(pair.b, hub, false, &ring);
    CHECK_MSG(ring.n == n, "the hub has only %zu neighbours", ring.n);
    check_tables(&pair);
    free(ring.v);
    pair_free(&pair);
}

TEST_TIMEOUT(tables_are_right_where_one_point_has_most_others_around_it, 60)
{
    check_hub(200, 0, 0);
    check_hub(200, 30, 0);
    check_hub(200, 199, 0);
    check_hub(30, 3, 100);
}

TEST_TIMEOUT(tables_are_right_at_points_of_high_degree, 60)
{
    check_hub(40, 0, 700);
    check_hub(40, 7, 700);
}

/* Most points are beyond the rim, so that no more rows of the hub are found among them. */
TEST_TIMEOUT(table_is_read_with_a_bounded_look_at_the_points_in_each_call, 60)
{
    enum { RIM = 5000, OTHERS = 60000 };
    struct dt *t = dt_new(0);
    struct dt_point *p = malloc((1 + RIM + OTHERS) * sizeof *p);
    p[0] = (struct dt_point){0, 0};
    for (uint32_t i = 0; i < RIM; i++)
        p[1 + i] = (struct dt_point){cos(i * TAU / RIM), sin(i * TAU / RIM)};
    for (uint32_t i = 0; i < OTHERS; i++)
        p[1 + RIM + i] = (struct dt_point){2 + test_uniform(), test_uniform()};
    CHECK(dt_add(t, p, 1 + RIM + OTHERS, &(struct dt_added){0}) == DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    for (int table = DT_TRIANGLES; table <= DT_EDGES; table++) {
        struct dt_cursor c;
        size_t rows = 1, words, total = 0, waits = 0;
        CHECK(dt_table_begin(t, NULL, (enum dt_table)table, false, &c) == DT_OK);
        while (rows > 0 || c.left > 0) {
            uint32_t v[1000];
            enum dt_status s = dt_table_read(t, &c, v, 1000, 1000, &rows, &words);
            CHECK(s == DT_OK || (s == DT_TOOLONG && rows == 0 && words == 0));
            waits += s == DT_TOOLONG;
            total += rows;
        }
        CHECK_MSG(waits >= 2 && total == c.rows, "table %d: %zu waits, %zu rows of %u", table,
                  waits, total, c.rows);
    }
    free(p);
    dt_free(t);
}

/* Every first attempt to read at the hub fails. */
static void check_without_memory(const struct dt *t, enum dt_table table)
{
    struct dt_ids want = {0}, got = {0};
    struct dt_cursor c;
    size_t rows = 1, words, failures = 0;
    read_table(t, table, false, 1000, 100, &want);
    CHECK(dt_table_begin(t, NULL, table, false, &c) == DT_OK);
    while (rows > 0) {
        uint32_t buffer[64];
        test_fail_alloc(1);
        enum dt_status s = dt_table_read(t, &c, buffer, 64, 10, &rows, &words);
        test_fail_alloc(0);
        if (s == DT_NOMEM) {
            CHECK(rows == 0);
            failures++;
            s = dt_table_read(t, &c, buffer, 64, 10, &rows, &words);
        }
        CHECK(s == DT_OK);
        append_ids(&got, buffer, words);
    }
    CHECK(failures > 1);
    check_equal_ids("a table read without memory", &got, &want);
    free(want.v);
    free(got.v);
}

TEST(a_table_that_runs_out_of_memory_at_a_hub_can_be_read_on)
{
    struct pair most = wheel(200, 30, 0), many = wheel(40, 0, 700);
    check_without_memory(most.t, DT_TRIANGLES);
    check_without_memory(most.t, DT_EDGES);
    check_without_memory(many.t, DT_TRIANGLES);
    check_without_memory(many.t, DT_EDGES);
    pair_free(&most);
    pair_free(&many);
}

/* Deletes all points but a few of some pages of ids, and all of others. */
static void thin_out(struct dt *t, uint32_t n)
{
    uint32_t *gone = malloc(n * sizeof *gone), count = 0, deleted, missing;
    for (uint32_t id = 0; id < n; id++) {
        uint32_t page = id / 4096 % 4;
        if (page == 1 || (page == 2 && id % 1000 != 0) || (page == 3 && test_below(3) != 0))
            gone[count++] = id;
    }
    CHECK(dt_delete(t, gone, count, &deleted, &missing) == DT_OK && deleted == count);
    free(gone);
}

TEST(parts_make_up_the_table_where_most_ids_have_been_deleted)
{
    enum { N = 40000 };
    struct dt_point *p = malloc(N * sizeof *p);
    for (uint32_t i = 0; i < N; i++)
        p[i] = (struct dt_point){test_below(150), test_below(150)};
    struct dt *t = set_of(p, N);
    thin_out(t, N);
    CHECK(dt_refresh(t, NULL) == DT_OK);
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        const uint32_t sizes[] = {N, 5000, 700, 1};
        struct dt_ids want = {0};
        read_table(t, tables[i], i % 2, 4096, 1000000, &want);
        for (int k = 0; k < 4; k++) {
            struct dt_ids got = {0};
            read_in_parts(t, tables[i], i % 2, sizes[k], &got);
            check_equal_ids(table_names[i], &got, &want);
            free(got.v);
        }
        free(want.v);
    }
    dt_free(t);
    free(p);
}

TEST(tables_of_the_triangulation_need_one)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    struct dt_cursor c;
    CHECK(dt_add(t, &(struct dt_point){1, 2}, 1, &added) == DT_OK);
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        bool points = tables[i] == DT_POINTS || tables[i] == DT_COINCIDENT;
        CHECK(dt_table_begin(t, NULL, tables[i], false, &c) ==
              (points ? DT_OK : DT_UNTRIANGULATED));
    }
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_add(t, &(struct dt_point){3, 2}, 1, &added) == DT_OK);
    enum dt_status s = dt_table_begin(t, NULL, DT_EDGES, false, &c);
    CHECK(s == DT_UNTRIANGULATED || (s == DT_OK && c.rows == 1)); /* stale tables are never read */
    dt_free(t);
}
