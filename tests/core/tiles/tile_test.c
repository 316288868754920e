/* tile_test.c - tiles in one process, round by round until nothing is left to be sent, against brute force, and if they are
 * larger, against one set. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_arrays.h"
#include "core/delaunay_tiles.h"
#include "core/set/set.h"
#include "tests/core/sets.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { SMALL = 80, MOST = 4000, TILES = 7 };

/* ---- the division of points among tiles ---- */

struct plan {
    const struct dt_point *p;
    uint32_t n;
    unsigned tiles;
    bool wide;                 /* global ids do not fit 32 bits */
    unsigned tile_of[MOST];    /* by id */
    bool has[TILES][MOST];     /* whether the point, by id, is foreign in the tile */
    uint32_t own[TILES][MOST]; /* the ids of own points, by local id */
    double box[4 * TILES];
};

/* Cuts the ids id[n] into `tiles` parts along x and y in turn. Equal coordinates stay together, so parts may be empty. */
static void cut(struct plan *plan, const uint32_t *id, uint32_t n, unsigned first, unsigned tiles,
                bool by_x)
{
    uint32_t low[MOST], high[MOST], lows = 0, highs = 0;
    if (tiles == 1) {
        for (uint32_t i = 0; i < n; i++)
            plan->tile_of[id[i]] = first;
        return;
    }
    struct dt_point at = n == 0 ? (struct dt_point){0, 0} : plan->p[id[test_below(n)]];
    for (uint32_t i = 0; i < n; i++) {
        struct dt_point p = plan->p[id[i]];
        if (by_x ? p.x <= at.x : p.y <= at.y)
            low[lows++] = id[i];
        else
            high[highs++] = id[i];
    }
    cut(plan, low, lows, first, tiles / 2, !by_x);
    cut(plan, high, highs, first + tiles / 2, tiles - tiles / 2, !by_x);
}

/* Coincident points share a tile; apart from that, tiles are random, so their boxes overlap. */
static void scatter(struct plan *plan)
{
    for (uint32_t i = 0; i < plan->n; i++) {
        plan->tile_of[i] = test_below(plan->tiles);
        for (uint32_t k = 0; k < i; k++)
            if (plan->p[k].x == plan->p[i].x && plan->p[k].y == plan->p[i].y)
                plan->tile_of[i] = plan->tile_of[k];
    }
}

static void divide(struct plan *plan)
{
    uint32_t id[MOST];
    for (uint32_t i = 0; i < plan->n; i++)
        id[i] = i;
    if (test_below(4) == 0)
        scatter(plan);
    else
        cut(plan, id, plan->n, 0, plan->tiles, test_below(2) == 0);
}

/* ---- rounds ---- */

/* Global ids have gaps, and do not fit 32 bits if `wide`. */
static uint64_t global(uint32_t id, bool wide)
{
    return 7 * (uint64_t)id + 3 + (wide ? (uint64_t)1 << 40 : 0);
}

static void extend(double *box, struct dt_point p)
{
    box[0] = fmin(box[0], p.x);
    box[1] = fmin(box[1], p.y);
    box[2] = fmax(box[2], p.x);
    box[3] = fmax(box[3], p.y);
}

static struct dt_tile *tile_of_plan(struct plan *plan, unsigned tile)
{
    struct dt_point p[MOST];
    uint64_t id[MOST];
    uint32_t n = 0;
    struct dt_tile *made;
    for (unsigned k = 0; k < 4; k++)
        plan->box[4 * tile + k] = (double)NAN;
    for (uint32_t i = 0; i < plan->n; i++)
        if (plan->tile_of[i] == tile) {
            extend(plan->box + 4 * (size_t)tile, plan->p[i]);
            plan->own[tile][n] = i;
            p[n] = plan->p[i];
            id[n++] = global(i, plan->wide);
        }
    CHECK(dt_tile_new(p, id, n, NULL, 1, &made) == DT_OK);
    return made;
}

static void deliver(struct plan *plan, unsigned from, unsigned to, struct dt_tile *tile,
                    const uint32_t *vertex, size_t n)
{
    struct dt_point p[MOST];
    uint64_t id[MOST];
    CHECK(n <= MOST);
    if (n == 0)
        return;
    for (size_t i = 0; i < n; i++) {
        uint32_t own = plan->own[from][vertex[i]];
        plan->has[to][own] = true;
        p[i] = plan->p[own];
        id[i] = global(own, plan->wide);
    }
    CHECK(dt_tile_insert(tile, p, id, n) == DT_OK);
    if (test_below(8) == 0) /* as if a worker had died after it */
        CHECK(dt_tile_insert(tile, p, id, n) == DT_OK);
}

/* All tiles are opened, then everything is delivered. Returns how many points were sent. */
static size_t round_of(struct plan *plan, struct dt_tile **tile)
{
    unsigned tiles = plan->tiles;
    int64_t offset[TILES][TILES + 1];
    struct dt_ids vertex[TILES] = {0};
    size_t sent = 0;
    for (unsigned k = 0; k < tiles; k++) {
        CHECK(dt_tile_open(tile[k], plan->box, tiles, k, offset[k], &vertex[k]) == DT_OK);
        CHECK(offset[k][0] == 0 && offset[k][tiles] == (int64_t)vertex[k].n);
        CHECK(offset[k][k] == offset[k][k + 1]);
        sent += vertex[k].n;
    }
    for (unsigned k = 0; k < tiles; k++)
        for (unsigned to = 0; to < tiles && vertex[k].n > 0; to++) {
            const uint32_t *first = vertex[k].v + offset[k][to];
            size_t n = (size_t)(offset[k][to + 1] - offset[k][to]);
            deliver(plan, k, to, tile[to], first, n);
        }
    for (unsigned k = 0; k < tiles; k++)
        free(vertex[k].v);
    return sent;
}

static void run_rounds(struct plan *plan, struct dt_tile **tile)
{
    size_t sent, rounds = 0;
    do {
        sent = round_of(plan, tile);
    } while (sent > 0 && rounds++ < MOST);
    CHECK(sent == 0);
}

/* ---- results ---- */

static int compare_rows(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    for (unsigned k = 0; k < 3; k++)
        if (x[k] != y[k])
            return x[k] < y[k] ? -1 : 1;
    return 0;
}

/* Appends the rows of the tile with ids as in brute force; they are sorted, and counterclockwise. */
static void append_rows(const struct dt_tile *tile, bool wide, struct dt_ids *out)
{
    struct dt_tile_counts sum;
    size_t rows, from = out->n;
    dt_tile_counts(tile, &sum);
    uint64_t *v = malloc((3 * sum.triangles + 1) * sizeof *v);
    CHECK(v != NULL);
    CHECK(dt_tile_triangles(tile, wide, v, &rows) == DT_OK && rows <= sum.triangles);
    for (size_t i = 0; i < 3 * rows; i++) {
        uint64_t id = wide ? v[i] : ((uint32_t *)v)[i];
        uint32_t local = (uint32_t)((id - global(0, wide)) / 7);
        CHECK(id == global(local, wide));
        append_ids(out, &local, 1);
    }
    for (size_t i = 3; i < 3 * rows; i += 3)
        CHECK(compare_rows(out->v + from + i - 3, out->v + from + i) < 0);
    if (wide && rows > 0)
        CHECK(dt_tile_triangles(tile, false, v, &rows) == DT_RANGE);
    free(v);
}

/* A tile has all neighbours of its own points, also where all points are on one line. */
static void check_neighbours(const struct plan *plan, const struct brute *b)
{
    struct dt_ids edge = {0};
    brute_table(b, DT_EDGES, false, &edge);
    for (size_t i = 0; i < edge.n; i += 2) {
        unsigned one = plan->tile_of[edge.v[i]], other = plan->tile_of[edge.v[i + 1]];
        CHECK(one == other || (plan->has[one][edge.v[i + 1]] && plan->has[other][edge.v[i]]));
    }
    free(edge.v);
}

static void rows_of_one_set(const struct plan *plan, struct dt_ids *out)
{
    struct dt *t = set_of(plan->p, plan->n);
    struct dt_summary sum;
    dt_summary(t, &sum);
    CHECK(dt_ids_reserve(out, 3 * (size_t)sum.triangles + 1) == DT_OK);
    CHECK(dt_flat(t, false, out->v, NULL) == DT_OK);
    out->n = 3 * (size_t)sum.triangles;
    dt_free(t);
}

static void check_tiles(struct plan *plan, const char *what)
{
    struct dt_tile *tile[TILES];
    struct dt_ids got = {0}, want = {0};
    plan->wide = test_below(2) == 0;
    for (unsigned k = 0; k < plan->tiles; k++)
        tile[k] = tile_of_plan(plan, k);
    run_rounds(plan, tile);
    for (unsigned k = 0; k < plan->tiles; k++)
        append_rows(tile[k], plan->wide, &got);
    if (got.n > 0)
        qsort(got.v, got.n / 3, 3 * sizeof *got.v, compare_rows);
    if (plan->n <= SMALL) {
        struct brute *b = brute_new(plan->p, NULL, plan->n);
        brute_table(b, DT_TRIANGLES, false, &want);
        check_neighbours(plan, b);
        brute_free(b);
    } else {
        rows_of_one_set(plan, &want);
    }
    check_equal_ids(what, &got, &want);
    free(got.v);
    free(want.v);
    for (unsigned k = 0; k < plan->tiles; k++)
        dt_tile_free(tile[k]);
}

TEST_TIMEOUT(tiles_have_the_triangles_of_brute_force_on_every_family, 120)
{
    static const uint32_t sizes[] = {0, 1, 2, 3, 4, 6, 9, 17, 40, SMALL};
    struct dt_point p[MOST];
    for (const struct family *f = families; f->name != NULL; f++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
            for (unsigned again = 0; again < 4; again++) {
                struct plan plan = {.p = p, .n = sizes[i], .tiles = 1 + test_below(TILES)};
                family_points(f, p, plan.n, test_random());
                divide(&plan);
                check_tiles(&plan, f->name);
            }
}

/* Batches that are small beside the tile walk from point to point; where walks are long the tile makes its grid. */
TEST_TIMEOUT(tiles_of_thousands_of_points_have_the_triangles_of_one_set, 120)
{
    static struct dt_point p[MOST];
    for (const struct family *f = families; f->name != NULL; f++) {
        struct plan plan = {.p = p, .n = MOST, .tiles = 2 + test_below(TILES - 1)};
        family_points(f, p, plan.n, test_random());
        divide(&plan);
        check_tiles(&plan, f->name);
    }
}

/* Points of a lattice with few columns: lines in all directions, rectangles, coincident points. */
static void lattice(struct dt_point *p, uint32_t n, unsigned columns, unsigned rows)
{
    for (uint32_t i = 0; i < n; i++)
        p[i] = (struct dt_point){test_below(columns), test_below(rows)};
}

TEST_TIMEOUT(tiles_of_lattices_and_lines_have_the_triangles_of_brute_force, 60)
{
    struct dt_point p[MOST];
    for (unsigned again = 0; again < 1500; again++) {
        unsigned columns = 1 + test_below(5), rows = 1 + test_below(7);
        struct plan plan = {.p = p, .n = test_below(30), .tiles = 2 + test_below(TILES - 1)};
        lattice(p, plan.n, columns, rows);
        for (uint32_t i = 0; i < plan.n && again % 3 == 0; i++) /* slanted */
            p[i] = (struct dt_point){p[i].x + 3 * p[i].y, p[i].y - p[i].x};
        divide(&plan);
        check_tiles(&plan, "lattice");
    }
}

/* Exponents far apart: circles that overflow, and flat ones. */
TEST_TIMEOUT(tiles_of_wide_exponents_have_the_triangles_of_brute_force, 60)
{
    struct dt_point p[MOST];
    for (unsigned again = 0; again < 600; again++) {
        struct plan plan = {.p = p, .n = test_below(25), .tiles = 2 + test_below(TILES - 1)};
        int spread = (int)test_below(140);
        for (uint32_t i = 0; i < plan.n; i++) {
            double x =
                ldexp(test_uniform() - 0.5, (int)test_below(1 + 2 * (unsigned)spread) - spread);
            double y =
                ldexp(test_uniform() - 0.5, (int)test_below(1 + 2 * (unsigned)spread) - spread);
            p[i] = (struct dt_point){dt_coordinate_ok(x) ? x : 0, test_below(3) == 0 ? x : y};
            p[i].y = dt_coordinate_ok(p[i].y) ? p[i].y : 0;
        }
        divide(&plan);
        check_tiles(&plan, "wide");
    }
}

/* ---- errors change nothing ---- */

static const struct dt_point square[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}};
static const uint64_t ids[] = {1, 3, 5, 8, 9};

static struct dt_tile *square_tile(void)
{
    struct dt_tile *tile;
    CHECK(dt_tile_new(square, ids, 5, NULL, 1, &tile) == DT_OK);
    return tile;
}

static void check_counts(const struct dt_tile *tile, uint64_t foreign, uint64_t triangles)
{
    struct dt_tile_counts c;
    dt_tile_counts(tile, &c);
    CHECK(c.own == 5 && c.coincident == 1 && c.foreign == foreign && c.triangles == triangles);
}

TEST(a_tile_refuses_ids_that_do_not_ascend_and_bad_coordinates)
{
    struct dt_tile *tile;
    CHECK(dt_tile_new(square, (uint64_t[]){1, 3, 3}, 3, NULL, 1, &tile) == DT_RANGE &&
          tile == NULL);
    CHECK(dt_tile_new((struct dt_point[]){{(double)NAN, 0}}, ids, 1, NULL, 1, &tile) == DT_RANGE);
}

TEST(foreign_points_that_contradict_the_tile_are_refused_and_change_nothing)
{
    struct dt_tile *tile = square_tile();
    check_counts(tile, 0, 2);
    CHECK(dt_tile_insert(tile, (struct dt_point[]){{9, 9}, {4, 0}}, (uint64_t[]){100, 101}, 2) ==
          DT_RANGE);
    CHECK(dt_tile_insert(tile, (struct dt_point[]){{9, 9}, {9, 9}}, (uint64_t[]){100, 101}, 2) ==
          DT_RANGE);
    CHECK(dt_tile_insert(tile, (struct dt_point[]){{7, 9}}, (uint64_t[]){5}, 1) == DT_RANGE);
    CHECK(dt_tile_insert(tile, (struct dt_point[]){{7, HUGE_VAL}}, (uint64_t[]){50}, 1) ==
          DT_RANGE);
    check_counts(tile, 0, 2);
    CHECK(dt_tile_insert(tile, (struct dt_point[]){{9, 9}, {4, 4}, {9, 9}}, (uint64_t[]){0, 5, 0},
                         3) == DT_OK);
    check_counts(tile, 1, 4);
    uint32_t row[12];
    size_t rows;
    CHECK(dt_tile_triangles(tile, false, row, &rows) == DT_OK); /* 0 is foreign and the smallest */
    CHECK(rows == 2);
    dt_tile_free(tile);
}

TEST(boxes_that_are_none_are_refused)
{
    double nan = (double)NAN;
    const double bad[][4] = {{0, nan, 1, 1}, {2, 0, 1, 1}, {0, 0, HUGE_VAL, 1}};
    struct dt_tile *tile = square_tile();
    int64_t offset[3];
    struct dt_ids v = {0};
    for (unsigned k = 0; k < 3; k++) {
        double box[8] = {0, 0, 4, 4};
        memcpy(box + 4, bad[k], sizeof bad[k]);
        CHECK(dt_tile_open(tile, box, 2, 0, offset, &v) == DT_RANGE);
    }
    CHECK(dt_tile_open(tile, (double[]){0, 0, 4, 4}, 1, 1, offset, &v) == DT_RANGE);
    CHECK(dt_tile_open(tile, (double[]){0, 0, 4, 4, 8, 8, 9, 9}, 2, 0, offset, &v) == DT_OK);
    CHECK(v.n == 3 && v.v[0] == 1 && v.v[1] == 2 && v.v[2] == 3);
    CHECK(offset[0] == 0 && offset[1] == 0 && offset[2] == 3);
    CHECK(dt_tile_open(tile, (double[]){0, 0, 4, 4, 8, 8, 9, 9}, 2, 0, offset, &v) == DT_OK &&
          v.n == 0);
    free(v.v);
    dt_tile_free(tile);
}

/* The point at the bottom is on the hull and no extreme one: the first call does not send it. */
static struct dt_tile *tile_with_a_tip(const double *box)
{
    const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, -1}};
    struct dt_tile *tile;
    struct dt_tile_counts c;
    struct dt_ids v = {0};
    int64_t offset[6];
    CHECK(dt_tile_new(p, (uint64_t[]){0, 1, 2, 3, 4}, 5, NULL, 1, &tile) == DT_OK);
    CHECK(dt_tile_open(tile, box, 5, 0, offset, &v) == DT_OK);
    dt_tile_counts(tile, &c);
    CHECK(v.n == 16 && c.postponed > 0);
    for (unsigned i = 0; i < 16; i++)
        CHECK(v.v[i] == i % 4);
    free(v.v);
    return tile;
}

TEST(postponed_faces_are_judged_by_the_next_call_also_after_a_repeated_point)
{
    const double box[] = {0, -1, 4, 4, 0, -9, 4, -8, 10, 0, 11, 4, -9, 0, -8, 4, 0, 30, 4, 31};
    for (unsigned way = 0; way < 2; way++) {
        struct dt_tile *tile = tile_with_a_tip(box);
        struct dt_tile_counts c;
        struct dt_ids v = {0};
        int64_t offset[6];
        if (way == 1)
            CHECK(dt_tile_insert(tile, (struct dt_point[]){{4, 4}}, (uint64_t[]){2}, 1) == DT_OK);
        CHECK(dt_tile_open(tile, box, 5, 0, offset, &v) == DT_OK);
        CHECK(offset[2] - offset[1] == 1 && offset[5] - offset[4] == 0 && v.v[0] == 4);
        dt_tile_counts(tile, &c);
        CHECK(c.postponed == 0);
        CHECK(dt_tile_open(tile, box, 5, 0, offset, &v) == DT_OK && v.n == 0);
        free(v.v);
        dt_tile_free(tile);
    }
}

static const struct dt_point far[] = {{6, 1}, {9, 9}};
static const uint64_t far_ids[] = {2, 4};

static void check_rows(const struct dt_tile *tile, const uint32_t *want, size_t wanted)
{
    uint32_t row[15];
    size_t rows;
    check_counts(tile, 2, 5);
    CHECK(dt_tile_triangles(tile, false, row, &rows) == DT_OK && rows == wanted);
    CHECK(memcmp(row, want, 3 * rows * sizeof *row) == 0);
}

/* Any allocation may fail: the call reports it, and the tile is as it was. */
TEST_TIMEOUT(a_tile_out_of_memory_is_as_it_was, 60)
{
    const double box[] = {0, 0, 4, 4, 6, 0, 9, 9};
    uint32_t want[15], row[15];
    size_t wanted, rows;
    struct dt_tile *calm = square_tile();
    CHECK(dt_tile_insert(calm, far, far_ids, 2) == DT_OK);
    CHECK(dt_tile_triangles(calm, false, want, &wanted) == DT_OK);
    dt_tile_free(calm);
    for (long fail = 1, failed = 1; failed; fail++) {
        struct dt_tile *tile = square_tile();
        struct dt_ids v = {0};
        int64_t offset[3];
        size_t sent = 0;
        test_fail_alloc(fail);
        enum dt_status s = dt_tile_open(tile, box, 2, 0, offset, &v);
        sent = s == DT_OK ? v.n : 0;
        if (s == DT_OK)
            s = dt_tile_insert(tile, far, far_ids, 2);
        if (s == DT_OK)
            s = dt_tile_triangles(tile, false, row, &rows);
        failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK(s == DT_OK || (s == DT_NOMEM && failed));
        struct dt_tile_counts c;
        dt_tile_counts(tile, &c);
        if (c.foreign == 0)
            CHECK(dt_tile_open(tile, box, 2, 0, offset, &v) == DT_OK && sent + v.n == 3);
        CHECK(dt_tile_insert(tile, far, far_ids, 2) == DT_OK);
        check_rows(tile, want, wanted);
        free(v.v);
        dt_tile_free(tile);
    }
}
