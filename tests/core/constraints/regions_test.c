/* regions_test.c - what borders enclose, on small lattices: compared with exact ray casting, also after edits that leave
 * regions current. */
#include "core/delaunay_constraints.h"

#include <stdlib.h>
#include <string.h>

#include "tests/test.h"

static uint32_t below(uint32_t n)
{
    return (uint32_t)(test_random() % n);
}

/* ---- the oracle: integers ---- */

struct at {
    long x, y;
};

struct border {
    struct at a, b;
    uint32_t number;
};

/* The borders of a set, with coordinates times 6. */
struct borders {
    struct border *v;
    size_t n;
};

static struct at place(const struct dt *t, uint32_t id)
{
    uint32_t rep;
    struct dt_point p;
    CHECK(dt_representative(t, id, &rep) == DT_OK && dt_get(t, rep, &p) == DT_OK);
    return (struct at){(long)p.x * 6, (long)p.y * 6};
}

static struct borders borders_of(const struct dt *t)
{
    struct dt_constraint *c;
    struct borders b = {0};
    size_t n;
    CHECK(dt_constraints(t, NULL, DT_NONE, &c, &n) == DT_OK);
    b.v = malloc((n + 1) * sizeof *b.v);
    for (size_t i = 0; i < n; i++)
        if (c[i].border)
            b.v[b.n++] = (struct border){place(t, c[i].a), place(t, c[i].b), c[i].number};
    free(c);
    return b;
}

static long turn(struct at a, struct at b, struct at c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* Whether q, on no border, is inside: crossings with the ray to the right. */
static bool cast(const struct borders *b, uint32_t number, struct at q)
{
    bool in = false;
    for (size_t i = 0; i < b->n; i++) {
        struct at p = b->v[i].a, r = b->v[i].b;
        if (b->v[i].number != number || (p.y <= q.y) == (r.y <= q.y))
            continue;
        in ^= p.y < r.y ? turn(p, r, q) > 0 : turn(r, p, q) > 0;
    }
    return in;
}

static bool is_closed(const struct borders *b, uint32_t number)
{
    for (size_t i = 0; i < 2 * b->n; i++) {
        struct at p = i % 2 == 0 ? b->v[i / 2].a : b->v[i / 2].b;
        size_t ends = 0;
        for (size_t k = 0; k < b->n && b->v[i / 2].number == number; k++)
            if (b->v[k].number == number)
                ends += (size_t)(b->v[k].a.x == p.x && b->v[k].a.y == p.y) +
                        (size_t)(b->v[k].b.x == p.x && b->v[k].b.y == p.y);
        if (ends % 2 != 0)
            return false;
    }
    return true;
}

enum { NUMBERS = 4 };

/* The closed borders around a triangle, as bits. */
static unsigned enclosing(const struct borders *b, const struct at corner[3])
{
    struct at q = {(corner[0].x + corner[1].x + corner[2].x) / 3,
                   (corner[0].y + corner[1].y + corner[2].y) / 3};
    unsigned bits = 0;
    for (uint32_t k = 0; k < NUMBERS; k++)
        if (is_closed(b, k) && cast(b, k, q))
            bits |= 1u << k;
    return bits;
}

/* ---- what a set says ---- */

/* The rows of a table. */
static struct dt_ids table_of(const struct dt *t, enum dt_table table, bool cw)
{
    struct dt_cursor c;
    struct dt_ids out = {0};
    size_t rows, words;
    CHECK(dt_table_begin(t, NULL, table, cw, &c) == DT_OK);
    size_t cap = 3 * (size_t)c.rows + 8;
    out.v = malloc(cap * sizeof *out.v);
    CHECK(dt_table_read(t, &c, out.v, cap, cap, &rows, &words) == DT_OK);
    out.n = words;
    return out;
}

struct answer {
    struct borders borders;
    struct dt_ids triangles; /* rows */
    unsigned *in;            /* by row */
};

static void answer_clear(struct answer *a)
{
    free(a->borders.v);
    free(a->triangles.v);
    free(a->in);
}

static struct answer answer_of(const struct dt *t)
{
    struct answer a = {borders_of(t), table_of(t, DT_TRIANGLES, false), NULL};
    a.in = calloc(a.triangles.n / 3 + 1, sizeof *a.in);
    for (size_t i = 0; i < a.triangles.n; i += 3) {
        const uint32_t *row = a.triangles.v + i;
        a.in[i / 3] = enclosing(
            &a.borders, (struct at[]){place(t, row[0]), place(t, row[1]), place(t, row[2])});
    }
    return a;
}

/* Twice the area, of the triangles with one of the bits; *n: how many. */
static long area_of(const struct dt *t, const struct answer *a, unsigned bits, uint32_t *n)
{
    long area = 0;
    *n = 0;
    for (size_t i = 0; i < a->triangles.n; i += 3)
        if ((a->in[i / 3] & bits) != 0) {
            const uint32_t *row = a->triangles.v + i;
            area += turn(place(t, row[0]), place(t, row[1]), place(t, row[2]));
            ++*n;
        }
    return area;
}

static void check_rows(const struct dt *t, const struct answer *a)
{
    struct dt_region *row, all;
    size_t n, k = 0;
    uint32_t triangles;
    CHECK(dt_regions(t, &row, &n, &all) == DT_OK);
    for (uint32_t number = 0; number < NUMBERS; number++) {
        bool there = false;
        for (size_t i = 0; i < a->borders.n; i++)
            there |= a->borders.v[i].number == number;
        if (!there)
            continue;
        long area = area_of(t, a, 1u << number, &triangles);
        CHECK(k < n && row[k].number == number && row[k].closed == is_closed(&a->borders, number));
        CHECK(row[k].triangles == triangles && row[k].area * 72 == (double)area);
        k++;
    }
    CHECK(k == n);
    long area = area_of(t, a, ~0u, &triangles);
    CHECK(all.triangles == triangles && all.area * 72 == (double)area);
    free(row);
}

static bool row_inside(const struct answer *a, size_t i, uint32_t number)
{
    return number == DT_NONE ? a->in[i] != 0 : (a->in[i] >> number & 1) != 0;
}

/* Whether a triangle with this edge is inside. */
static bool edge_inside(const struct answer *a, const uint32_t edge[2], uint32_t number)
{
    for (size_t i = 0; i < a->triangles.n; i += 3)
        for (size_t k = 0; k < 3; k++) {
            uint32_t p = a->triangles.v[i + k], q = a->triangles.v[i + (k + 1) % 3];
            if (((p == edge[0] && q == edge[1]) || (q == edge[0] && p == edge[1])) &&
                row_inside(a, i / 3, number))
                return true;
        }
    return false;
}

/* cw: the rows of the clockwise table whose triangles are those of `in`. */
static void check_clockwise(const struct dt *t, const struct dt_ids *in, const struct dt_ids *cw)
{
    struct dt_ids all = table_of(t, DT_TRIANGLES, true);
    size_t n = 0;
    for (size_t i = 0; i < all.n; i += 3)
        for (size_t k = 0; k < in->n; k += 3)
            if (memcmp(&all.v[i], (uint32_t[]){in->v[k], in->v[k + 2], in->v[k + 1]}, 12) == 0)
                CHECK(memcmp(&cw->v[3 * n++], &all.v[i], 12) == 0);
    CHECK(3 * n == cw->n);
    free(all.v);
}

static void check_lists(const struct dt *t, const struct answer *a, uint32_t number)
{
    struct dt_ids in = {0}, edges = table_of(t, DT_EDGES, false), cw = {0};
    size_t n = 0;
    enum dt_status status = dt_inside(t, number, DT_TRIANGLES, false, NULL, &in);
    bool there = number == DT_NONE;
    CHECK(dt_has_borders(t) == (a->borders.n > 0));
    CHECK(dt_region_check(t, number) == (dt_has_borders(t) ? status : DT_NOREGION));
    for (size_t i = 0; i < a->borders.n; i++)
        there |= a->borders.v[i].number == number;
    bool closed = number == DT_NONE || is_closed(&a->borders, number);
    CHECK(status == (!there ? DT_NOREGION : closed ? DT_OK : DT_OPEN));
    if (status != DT_OK) {
        free(edges.v);
        return;
    }
    for (size_t i = 0; i < a->triangles.n; i += 3)
        if (row_inside(a, i / 3, number)) {
            CHECK(n + 3 <= in.n && memcmp(in.v + n, a->triangles.v + i, 12) == 0);
            n += 3;
        }
    CHECK(n == in.n);
    CHECK(dt_inside(t, number, DT_TRIANGLES, true, NULL, &cw) == DT_OK && cw.n == in.n);
    check_clockwise(t, &in, &cw);
    in.n = n = 0;
    CHECK(dt_inside(t, number, DT_EDGES, false, NULL, &in) == DT_OK);
    for (size_t i = 0; i < edges.n; i += 2)
        if (edge_inside(a, edges.v + i, number)) {
            CHECK(n + 2 <= in.n && memcmp(in.v + n, edges.v + i, 8) == 0);
            n += 2;
        }
    CHECK(n == in.n);
    free(in.v);
    free(cw.v);
    free(edges.v);
}

/* Whether q is on the hull, or outside it. */
static bool is_at_hull(const struct dt *t, struct at q)
{
    struct dt_ids hull = table_of(t, DT_HULL, false);
    bool at = hull.n < 3;
    for (size_t i = 0; i < hull.n; i++)
        at |= turn(place(t, hull.v[i]), place(t, hull.v[(i + 1) % hull.n]), q) <= 0;
    free(hull.v);
    return at;
}

static bool has(const struct dt_ids *list, uint32_t number)
{
    for (size_t i = 0; i < list->n; i++)
        if (list->v[i] == number)
            return true;
    return false;
}

/* q is a place times 6. */
static void check_place(const struct dt *t, const struct answer *a, struct at q)
{
    struct dt_ids in = {0}, on = {0};
    unsigned all = is_at_hull(t, q) ? 0 : ~0u, some = 0;
    for (size_t i = 0; i < a->triangles.n; i += 3) {
        const uint32_t *row = a->triangles.v + i;
        bool meets = true;
        for (size_t k = 0; k < 3; k++)
            meets &= turn(place(t, row[k]), place(t, row[(k + 1) % 3]), q) >= 0;
        if (meets) {
            all &= a->in[i / 3];
            some |= a->in[i / 3];
        }
    }
    CHECK(dt_regions_at(t, (struct dt_point){(double)q.x / 6, (double)q.y / 6}, NULL, &in, &on) ==
          DT_OK);
    for (uint32_t k = 0; k < NUMBERS; k++) {
        CHECK(has(&in, k) == ((all & some) >> k & 1));
        CHECK(has(&on, k) == ((some & ~all) >> k & 1));
    }
    for (size_t i = 1; i < in.n; i++)
        CHECK(in.v[i - 1] < in.v[i]);
    free(in.v);
    free(on.v);
}

enum { SIDE = 9 };

/* On the lattice or between, or just outside. */
static struct at random_place(void)
{
    long x = below(2 * SIDE + 2), y = below(2 * SIDE + 2);
    return (struct at){3 * x - 3, 3 * y - 3};
}

static void check_regions(const struct dt *t)
{
    const char *fault = NULL;
    CHECK(dt_surveyed(t));
    if (dt_check(t, NULL, &fault) != DT_OK)
        CHECK_MSG(false, "%s", fault);
    struct answer a = answer_of(t);
    check_rows(t, &a);
    for (uint32_t k = 0; k < NUMBERS; k++)
        check_lists(t, &a, k);
    check_lists(t, &a, DT_NONE);
    for (int i = 0; i < 6; i++)
        check_place(t, &a, random_place());
    answer_clear(&a);
}

/* ---- sets ---- */

static struct dt *set_of(const struct dt_point *p, size_t n)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(dt_add(t, p, n, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    return t;
}

/* Declares the ring of ids as a border. */
static enum dt_status ring(struct dt *t, uint32_t number, size_t n, const uint32_t *id)
{
    struct dt_constraint c[16];
    size_t added;
    uint32_t missing;
    for (size_t i = 0; i < n; i++)
        c[i] = (struct dt_constraint){id[i], id[(i + 1) % n], true, number};
    return dt_constrain(t, c, n, NULL, &added, &missing);
}

#define RING(t, number, ...)                                                                       \
    ring(t, number, sizeof((uint32_t[]){__VA_ARGS__}) / sizeof(uint32_t), (uint32_t[]){__VA_ARGS__})

static struct dt *grid(uint32_t side)
{
    struct dt_point *p = malloc(side * side * sizeof *p);
    for (uint32_t i = 0; i < side * side; i++)
        p[i] = (struct dt_point){i % side, i / side};
    struct dt *t = set_of(p, side * side);
    free(p);
    return t;
}

/* 0 .. 15 of a grid of 4 are the corners (i % 4, i / 4). */
TEST(a_ring_encloses_its_triangles_and_a_hole_in_it_does_not_count)
{
    struct dt *t = grid(4);
    struct dt_region *row, all;
    size_t n;
    CHECK(RING(t, 2, 0, 3, 15, 12) == DT_OK && RING(t, 2, 5, 6, 10, 9) == DT_OK);
    CHECK(dt_regions(t, &row, &n, &all) == DT_UNSURVEYED);
    CHECK(dt_survey(t, NULL) == DT_OK && dt_regions(t, &row, &n, &all) == DT_OK);
    CHECK(n == 1 && row[0].number == 2 && row[0].closed && row[0].triangles == 16);
    CHECK(row[0].area == 8 && all.area == 8 && all.triangles == 16);
    free(row);
    check_regions(t);
    dt_free(t);
}

TEST(an_island_in_a_hole_is_inside_again)
{
    struct dt *t = grid(8);
    CHECK(RING(t, 1, 0, 7, 63, 56) == DT_OK && RING(t, 1, 9, 14, 54, 49) == DT_OK &&
          RING(t, 1, 18, 21, 45, 42) == DT_OK);
    CHECK(dt_survey(t, NULL) == DT_OK);
    check_regions(t);
    dt_free(t);
}

TEST(two_parcels_with_a_common_side_are_whole)
{
    struct dt *t = grid(4);
    struct dt_ids in = {0}, on = {0};
    CHECK(RING(t, 1, 0, 1, 13, 12) == DT_OK && RING(t, 2, 1, 3, 15, 13) == DT_OK);
    CHECK(dt_survey(t, NULL) == DT_OK);
    check_regions(t);
    CHECK(dt_regions_at(t, (struct dt_point){1, 1.5}, NULL, &in, &on) == DT_OK);
    CHECK(in.n == 0 && on.n == 2 && on.v[0] == 1 && on.v[1] == 2);
    free(in.v);
    free(on.v);
    dt_free(t);
}

TEST(borders_that_touch_at_a_vertex_and_run_along_one_another_count_each)
{
    struct dt *t = grid(4);
    CHECK(RING(t, 1, 0, 1, 5, 4) == DT_OK && RING(t, 1, 5, 6, 10, 9) == DT_OK);
    CHECK(RING(t, 2, 0, 3, 15, 12) == DT_OK && RING(t, 2, 1, 2, 6, 5) == DT_OK);
    CHECK(RING(t, 3, 0, 2, 6, 4) == DT_OK && RING(t, 3, 1, 3, 7, 5) == DT_OK);
    CHECK(dt_survey(t, NULL) == DT_OK);
    check_regions(t);
    dt_free(t);
}

TEST(an_open_border_encloses_nothing_and_a_line_does_not_close_it)
{
    struct dt *t = grid(4);
    struct dt_constraint c[] = {
        {0, 3, true, 1}, {3, 15, true, 1}, {15, 12, true, 1}, {12, 0, false, 1}};
    struct dt_ids out = {0};
    size_t added;
    uint32_t missing;
    CHECK(dt_constrain(t, c, 4, NULL, &added, &missing) == DT_OK && dt_survey(t, NULL) == DT_OK);
    CHECK(dt_inside(t, 1, DT_TRIANGLES, false, NULL, &out) == DT_OPEN);
    CHECK(dt_inside(t, 7, DT_TRIANGLES, false, NULL, &out) == DT_NOREGION);
    CHECK(dt_inside(t, DT_NONE, DT_TRIANGLES, false, NULL, &out) == DT_OK && out.n == 0);
    CHECK(dt_region_check(t, 1) == DT_OPEN && dt_region_check(t, DT_NONE) == DT_OK);
    check_regions(t);
    dt_free(t);
}

TEST(edits_of_points_and_lines_keep_regions_and_a_change_of_borders_does_not)
{
    struct dt *t = grid(4);
    struct dt_added added;
    uint32_t deleted, missing, inner = 6, end = 0;
    struct dt_constraint line = {0, 10, false, 1};
    size_t n;
    CHECK(dt_surveyed(t) && RING(t, 1, 0, 3, 15, 12) == DT_OK && !dt_surveyed(t));
    CHECK(dt_survey(t, NULL) == DT_OK);
    CHECK(dt_add(t, (struct dt_point[]){{0.25, 0.5}, {0.5, 0}, {5, 5}}, 3, &added) == DT_OK);
    CHECK(dt_delete(t, &inner, 1, &deleted, &missing) == DT_OK);
    CHECK(dt_move(t, 9, (struct dt_point){2.5, 2.25}) == DT_OK);
    CHECK(dt_constrain(t, &line, 1, NULL, &n, &missing) == DT_OK && dt_surveyed(t));
    struct dt_region *row, all;
    CHECK(dt_regions(t, &row, &n, &all) == DT_OK && n == 1 && row[0].area == 9);
    free(row);
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    CHECK(dt_move(t, end, (struct dt_point){-1, -1}) == DT_OK && !dt_surveyed(t));
    CHECK(dt_survey(t, NULL) == DT_OK && dt_regions(t, &row, &n, &all) == DT_OK &&
          row[0].area == 12);
    free(row);
    CHECK(dt_triangulate(t, &(struct dt_options){.rebuild = true}) == DT_OK && !dt_surveyed(t));
    dt_free(t);
}

TEST(a_line_across_a_region_leaves_its_triangles_inside)
{
    struct dt *t = grid(8);
    struct dt_constraint line[] = {{9, 23, false, 1}, {17, 62, false, 1}};
    size_t n;
    uint32_t missing;
    CHECK(RING(t, 1, 0, 7, 63, 56) == DT_OK && dt_survey(t, NULL) == DT_OK);
    for (size_t i = 0; i < 2; i++)
        CHECK(dt_constrain(t, &line[i], 1, NULL, &n, &missing) == DT_OK);
    check_regions(t);
    CHECK(dt_release(t, line, 2, NULL, &n, &n) == DT_OK);
    check_regions(t);
    dt_free(t);
}

TEST(a_point_inside_a_triangle_of_its_own_and_one_on_its_side_keep_what_it_encloses)
{
    struct dt *t = set_of((struct dt_point[]){{0, 0}, {6, 0}, {0, 6}, {8, 8}}, 4);
    struct dt_added added;
    uint32_t deleted, missing;
    CHECK(RING(t, 3, 0, 1, 2) == DT_OK && dt_survey(t, NULL) == DT_OK);
    CHECK(dt_add(t, (struct dt_point[]){{1, 1}, {3, 3}, {2, 0}}, 3, &added) == DT_OK);
    check_regions(t);
    for (uint32_t id = 4; id < 7; id++)
        CHECK(dt_delete(t, &id, 1, &deleted, &missing) == DT_OK);
    check_regions(t);
    dt_free(t);
}

TEST(borders_of_points_on_a_line_and_of_coincident_points_enclose_nothing)
{
    struct dt *t = set_of((struct dt_point[]){{0, 0}, {1, 1}, {2, 2}, {2, 2}}, 4);
    struct dt_region *row, all;
    size_t n;
    CHECK(RING(t, 1, 0, 1, 2) == DT_OK && RING(t, 2, 2, 3) == DT_OK && dt_survey(t, NULL) == DT_OK);
    CHECK(dt_regions(t, &row, &n, &all) == DT_OK && n == 2 && all.triangles == 0 && all.area == 0);
    CHECK(row[0].closed && row[1].closed && row[0].area == 0);
    free(row);
    struct dt_added added;
    CHECK(dt_add(t, &(struct dt_point){0, 5}, 1, &added) == DT_OK);
    check_regions(t);
    dt_free(t);
}

TEST(areas_are_exact_where_doubles_of_their_terms_are_not)
{
    const double far = 0x1p52, near = 0x1p-40;
    struct dt *t =
        set_of((struct dt_point[]){{far, far}, {far + 1, far}, {far, far + 1}, {near, 0}}, 4);
    struct dt_region *row, all;
    size_t n;
    CHECK(RING(t, 1, 0, 1, 2) == DT_OK && RING(t, 2, 0, 3, 1) == DT_OK);
    CHECK(dt_survey(t, NULL) == DT_OK && dt_regions(t, &row, &n, &all) == DT_OK);
    CHECK(row[0].area == 0.5 && row[1].area == far / 2 && all.area == far / 2 + 0.5);
    free(row);
    dt_free(t);
}

TEST(a_thousand_nested_borders_take_memory_for_each_once)
{
    enum { N = 1000 };
    struct dt *t = dt_new(0);
    struct dt_added added;
    struct dt_summary before, after;
    struct dt_ids in = {0}, on = {0};
    for (int i = 1; i <= N; i++)
        CHECK(dt_add(t, (struct dt_point[]){{-i, -i}, {i, -i}, {i, i}, {-i, i}}, 4, &added) ==
              DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    for (uint32_t i = 0; i < N; i++)
        CHECK(RING(t, i, 4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3) == DT_OK);
    dt_summary(t, &before);
    size_t estimate = dt_survey_memory(t);
    CHECK(dt_survey(t, NULL) == DT_OK && dt_survey_memory(t) == 0);
    dt_summary(t, &after);
    CHECK(after.memory - before.memory < 100 * N && after.memory - before.memory < estimate);
    CHECK(dt_regions_at(t, (struct dt_point){0.5, 10.5}, NULL, &in, &on) == DT_OK);
    CHECK(in.n == N - 10 && in.v[0] == 10 && on.n == 0);
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    free(in.v);
    free(on.v);
    dt_free(t);
}

/* ---- random edits ---- */

static void edit(struct dt *t)
{
    struct dt_added added;
    size_t n;
    uint32_t ids = dt_next_id(t), id = below(ids), other = below(ids), missing;
    struct dt_point p = {below(SIDE), below(SIDE)};
    struct dt_constraint c = {id, other, below(2) == 0, below(NUMBERS)};
    switch (below(8)) {
    case 0:
    case 1:
        CHECK(dt_add(t, &p, 1, &added) == DT_OK);
        break;
    case 2:
        (void)dt_delete(t, &id, 1, &missing, &missing);
        break;
    case 3:
        (void)dt_move(t, id, p);
        break;
    case 4:
        (void)dt_constrain(t, &c, 1, NULL, &n, &missing);
        break;
    case 5:
        (void)dt_release(t, &c, 1, NULL, &n, &n);
        break;
    case 6:
        (void)ring(t, c.number, 3 + below(2), (uint32_t[]){id, other, below(ids), below(ids)});
        break;
    default:
        if (below(4) == 0)
            (void)dt_delete_cascade(t, &id, 1, NULL, &missing, &missing);
    }
}

TEST(regions_after_random_edits_are_those_of_ray_casting)
{
    for (int round = 0; round < 30; round++) {
        struct dt *t = dt_new(0);
        struct dt_point p[16];
        struct dt_added added;
        for (int i = 0; i < 16; i++)
            p[i] = (struct dt_point){below(SIDE), below(SIDE)};
        CHECK(dt_add(t, p, 16, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
        for (int i = 0; i < 60; i++) {
            edit(t);
            if (below(3) == 0)
                CHECK(dt_refresh(t, NULL) == DT_OK && dt_survey(t, NULL) == DT_OK);
            if (dt_surveyed(t))
                check_regions(t);
        }
        dt_free(t);
    }
}
