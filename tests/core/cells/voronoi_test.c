/* voronoi_test.c - Voronoi cells: their corners are exact places rounded once, and they tile the box. */
#include "core/delaunay_surface.h"
#include "tests/core/sets.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* All cells of a set. */
struct cells {
    struct dt_point lo, hi;
    struct dt_cell *cell;
    struct dt_point *corner;
    size_t n, corners, cap;
};

static void append(struct cells *r, const struct dt_cell *cell, size_t n,
                   const struct dt_point *corner, size_t corners)
{
    r->cell = realloc(r->cell, (r->n + n) * sizeof *cell);
    r->corner = realloc(r->corner, (r->corners + corners + 1) * sizeof *corner);
    CHECK(r->cell != NULL && r->corner != NULL);
    memcpy(r->cell + r->n, cell, n * sizeof *cell);
    memcpy(r->corner + r->corners, corner, corners * sizeof *corner);
    r->n += n;
    r->corners += corners;
}

/* Reads the cells of the cursor, through a buffer that is as small as possible, or not. */
static void read_to_end(const struct dt *t, struct dt_cells *c, bool small, struct cells *r)
{
    struct dt_cell cell[100];
    size_t cap = small ? 1 : 4000, n, corners;
    struct dt_point *corner = malloc(cap * sizeof *corner);
    CHECK(corner != NULL);
    for (;;) {
        enum dt_status s = dt_cells_read(t, c, cell, small ? 1 : 100, corner, cap, &n, &corners);
        if (s == DT_TOOSMALL) {
            CHECK(n == 0 && corners > cap);
            cap = corners;
            corner = realloc(corner, cap * sizeof *corner);
            CHECK(corner != NULL);
            continue;
        }
        CHECK(s == DT_OK);
        if (n == 0)
            break;
        append(r, cell, n, corner, corners);
    }
    free(corner);
}

static struct dt_cells_made *make_all(const struct dt *t, const struct dt_cells *c)
{
    struct dt_cells_made *m;
    CHECK(dt_cells_make_begin(t, c, &m) == DT_OK);
    for (bool done = m == NULL; !done;)
        CHECK(dt_cells_make(t, m, NULL, 7, &done) == DT_OK);
    return m;
}

static void usual_box(const struct dt *t, const struct dt_view *v, struct dt_point *lo,
                      struct dt_point *hi)
{
    struct dt_bounds b = {0};
    bool done = false;
    while (!done)
        CHECK(dt_bounds_read(t, v, &b, 3, &done) == DT_OK);
    dt_bounds_grow(&b, lo, hi);
}

static struct cells cells_in(const struct dt *t, const struct dt_view *v, struct dt_point lo,
                             struct dt_point hi)
{
    struct dt_cells c;
    struct cells r = {lo, hi, NULL, NULL, 0, 0, 0};
    CHECK(dt_cells_begin(t, v, lo, hi, &c) == DT_OK);
    read_to_end(t, &c, false, &r);
    CHECK(r.n == c.rows);
    return r;
}

static struct cells cells_of(const struct dt *t, const struct dt_view *v)
{
    struct dt_point lo, hi;
    usual_box(t, v, &lo, &hi);
    return cells_in(t, v, lo, hi);
}

static void cells_free(struct cells *r)
{
    free(r->cell);
    free(r->corner);
}

static bool are_equal(const struct cells *a, const struct cells *b)
{
    return a->n == b->n && a->corners == b->corners &&
           (a->n == 0 || memcmp(a->cell, b->cell, a->n * sizeof *a->cell) == 0) &&
           (a->corners == 0 || memcmp(a->corner, b->corner, a->corners * sizeof *a->corner) == 0);
}

/* Whether the areas that are made at once are those of these cells, bit by bit. */
static void check_areas_made(const struct dt *t, const struct cells *r)
{
    struct dt_cells c;
    struct dt_cells_made *m;
    uint32_t id[5];
    double area[5], expected;
    size_t n, cell = 0, at = 0;
    CHECK(dt_cells_begin(t, NULL, r->lo, r->hi, &c) == DT_OK);
    CHECK(dt_areas_make_begin(t, &c, &m) == DT_OK);
    if (m == NULL)
        return;
    for (bool done = false; !done;)
        CHECK(dt_cells_make(t, m, NULL, 7, &done) == DT_OK);
    c.made = m;
    while ((n = dt_areas_read(&c, id, area, 5)) > 0)
        for (size_t i = 0; i < n; i++, at += r->cell[cell++].corners) {
            CHECK(cell < r->n && id[i] == r->cell[cell].id);
            expected = dt_polygon_area(r->corner + at, r->cell[cell].corners);
            CHECK(memcmp(&area[i], &expected, sizeof expected) == 0);
        }
    CHECK(cell == r->n);
    dt_cells_made_free(m);
}

/* Whether all cells that are made at once are these; small: read one by one. */
static void check_made(const struct dt *t, const struct cells *r, bool small)
{
    struct dt_cells c;
    struct cells made = {r->lo, r->hi, NULL, NULL, 0, 0, 0};
    CHECK(dt_cells_begin(t, NULL, r->lo, r->hi, &c) == DT_OK);
    struct dt_cells_made *m = make_all(t, &c);
    c.made = m;
    read_to_end(t, &c, small, &made);
    CHECK(are_equal(r, &made));
    CHECK(m == NULL || dt_cells_made_corners(m) == r->corners);
    dt_cells_made_free(m);
    cells_free(&made);
    check_areas_made(t, r);
}

/* ---- tiling ---- */

struct edge {
    struct dt_point a, b; /* a before b */
    int way;
};

static int compare_points(struct dt_point a, struct dt_point b)
{
    if (a.x != b.x)
        return a.x < b.x ? -1 : 1;
    return a.y < b.y ? -1 : a.y > b.y;
}

static int compare_edges(const void *p, const void *q)
{
    const struct edge *e = p, *f = q;
    int order = compare_points(e->a, f->a);
    return order != 0 ? order : compare_points(e->b, f->b);
}

static bool is_on_side(const struct cells *r, struct dt_point a, struct dt_point b)
{
    return (a.x == b.x && (a.x == r->lo.x || a.x == r->hi.x)) ||
           (a.y == b.y && (a.y == r->lo.y || a.y == r->hi.y));
}

/* Every edge but those along the sides of the box is there once in either direction, in bytes. */
static void check_edges(const struct cells *r)
{
    struct edge *e = malloc((r->corners + 1) * sizeof *e);
    size_t n = 0, at = 0;
    CHECK(e != NULL);
    for (size_t i = 0; i < r->n; at += r->cell[i++].corners) {
        for (size_t k = 0; k < r->cell[i].corners; k++) {
            struct dt_point a = r->corner[at + k];
            struct dt_point b = r->corner[at + (k + 1) % r->cell[i].corners];
            int order = compare_points(a, b);
            CHECK(order != 0);
            CHECK(r->lo.x <= a.x && a.x <= r->hi.x && r->lo.y <= a.y && a.y <= r->hi.y);
            if (!is_on_side(r, a, b))
                e[n++] = order < 0 ? (struct edge){a, b, 1} : (struct edge){b, a, -1};
        }
    }
    qsort(e, n, sizeof *e, compare_edges);
    int balance = 0;
    for (size_t i = 0; i < n; i++) {
        balance += e[i].way;
        if (i + 1 == n || compare_edges(&e[i], &e[i + 1]) != 0)
            CHECK_MSG(balance == 0, "an edge from %.17g %.17g to %.17g %.17g has one cell",
                      e[i].a.x, e[i].a.y, e[i].b.x, e[i].b.y);
    }
    free(e);
}

static void check_area(const struct cells *r)
{
    double sum = 0, rest = 0, box = (r->hi.x - r->lo.x) * (r->hi.y - r->lo.y);
    size_t at = 0;
    for (size_t i = 0; i < r->n; at += r->cell[i++].corners) {
        double area = dt_polygon_area(r->corner + at, r->cell[i].corners), before = sum;
        sum += area;
        rest += area - (sum - before);
    }
    if (r->n > 0)
        CHECK_MSG(fabs(sum + rest - box) <= 1e-12 * box, "%.17g of %.17g", sum + rest, box);
}

static void check_canonical_starts(const struct cells *r)
{
    size_t at = 0;
    for (size_t i = 0; i < r->n; at += r->cell[i++].corners) {
        CHECK(r->cell[i].corners == 0 || r->cell[i].corners >= 3);
        CHECK(i == 0 || r->cell[i - 1].id < r->cell[i].id);
        for (size_t k = 1; k < r->cell[i].corners; k++)
            CHECK(compare_points(r->corner[at], r->corner[at + k]) <= 0);
    }
}

static void check_tiling(const struct cells *r)
{
    check_canonical_starts(r);
    check_edges(r);
    check_area(r);
}

static void check_pair(const struct pair *pair)
{
    struct cells r = cells_of(pair->t, NULL);
    check_tiling(&r);
    check_made(pair->t, &r, false);
    /* Boxes through the points: their sides meet corners and run along edges. */
    for (int i = 0; i < 10 && r.n > 0; i++) {
        struct dt_point a = random_place(pair->b), b = random_place(pair->b);
        struct dt_point lo = {fmin(a.x, b.x), fmin(a.y, b.y)},
                        hi = {fmax(a.x, b.x), fmax(a.y, b.y)};
        if (!(lo.x < hi.x && lo.y < hi.y))
            continue;
        struct cells part = cells_in(pair->t, NULL, lo, hi);
        check_tiling(&part);
        check_made(pair->t, &part, false);
        cells_free(&part);
    }
    cells_free(&r);
}

TEST_TIMEOUT(cells_tile_every_box_on_every_family, 120)
{
    for_each_pair(check_pair);
}

/* ---- areas ---- */

TEST(areas_of_cells_are_those_of_their_polygons_and_exact_for_small_numbers)
{
    enum { N = 200 };
    struct dt_cell cell[N];
    struct dt_point corner[N * 12];
    double area[N], want[N];
    size_t at = 0;
    for (uint32_t i = 0; i < N; i++) {
        cell[i] = (struct dt_cell){i, test_below(5) == 0 ? 0 : 3 + test_below(9)};
        struct dt_point *p = corner + at;
        int64_t twice = 0;
        for (uint32_t k = 0; k < cell[i].corners; k++)
            p[k] = (struct dt_point){0x1p40 + test_below(1000), -0x1p41 + test_below(1000)};
        for (uint32_t k = 2; k < cell[i].corners; k++)
            twice += (int64_t)(p[k - 1].x - p[0].x) * (int64_t)(p[k].y - p[0].y) -
                     (int64_t)(p[k - 1].y - p[0].y) * (int64_t)(p[k].x - p[0].x);
        want[i] = (double)twice / 2;
        at += cell[i].corners;
    }
    for (uint32_t n = 0; n <= N; n += 67) {
        dt_cell_areas(cell, n, corner, area);
        for (size_t i = 0, from = 0; i < n; from += cell[i++].corners)
            CHECK(area[i] == want[i] && dt_polygon_area(corner + from, cell[i].corners) == want[i]);
    }
}

TEST(areas_of_polygons_keep_what_doubles_round)
{
    /* A sliver whose cross products agree in all but their last bits. */
    double u = 0x1p-52;
    struct dt_point p[] = {{0, 0}, {1 + u, 1 + 3 * u}, {1 + 2 * u, 1 + 4 * u}};
    struct dt_cell cell[] = {{0, 3}, {1, 3}};
    struct dt_point twice[] = {p[0], p[1], p[2], p[0], p[2], p[1]};
    double area[2];
    dt_cell_areas(cell, 2, twice, area);
    CHECK(area[0] == -u * u && area[1] == u * u); /* (1 + u)(1 + 4u) - (1 + 3u)(1 + 2u) = -2 u^2 */
}

/* ---- small sets ---- */

static void check_corners(const struct cells *r, size_t i, const char *want)
{
    char text[400] = "";
    size_t at = 0;
    for (size_t k = 0; k < i; k++)
        at += r->cell[k].corners;
    for (size_t k = 0; k < r->cell[i].corners; k++)
        sprintf(text + strlen(text), "%s%g %g", k == 0 ? "" : "  ", r->corner[at + k].x,
                r->corner[at + k].y);
    CHECK_MSG(strcmp(text, want) == 0, "%s, not %s", text, want);
}

TEST(the_cell_of_the_only_point_is_the_box)
{
    struct dt_point p = {3, -5};
    struct dt *t = set_of(&p, 1);
    struct cells r = cells_of(t, NULL);
    CHECK(r.n == 1);
    check_corners(&r, 0, "-2 -10  8 -10  8 0  -2 0");
    cells_free(&r);
    dt_free(t);
}

TEST(cells_of_points_on_a_line_are_strips)
{
    static const struct dt_point p[] = {{0, 0}, {2, 0}, {6, 0}};
    struct dt *t = set_of(p, 3);
    struct cells r = cells_of(t, NULL);
    check_corners(&r, 0, "-3 -3  1 -3  1 3  -3 3");
    check_corners(&r, 1, "1 -3  4 -3  4 3  1 3");
    check_corners(&r, 2, "4 -3  9 -3  9 3  4 3");
    cells_free(&r);
    r = cells_in(t, NULL, (struct dt_point){1, 0}, (struct dt_point){3, 1});
    CHECK(r.cell[0].corners == 0 && r.cell[2].corners == 0); /* the first one touches the box */
    check_corners(&r, 1, "1 0  3 0  3 1  1 1");
    cells_free(&r);
    dt_free(t);
}

TEST(cells_of_a_lattice_are_squares)
{
    struct dt_point p[25];
    for (int i = 0; i < 25; i++)
        p[i] = (struct dt_point){i % 5, i / 5};
    struct dt *t = set_of(p, 25);
    struct cells r = cells_of(t, NULL);
    for (size_t i = 0; i < r.n; i++)
        CHECK(r.cell[i].corners == 4);
    check_corners(&r, 0, "-2 -2  0.5 -2  0.5 0.5  -2 0.5");
    check_corners(&r, 12, "1.5 1.5  2.5 1.5  2.5 2.5  1.5 2.5");
    cells_free(&r);
    dt_free(t);
}

TEST(an_empty_set_has_no_cells)
{
    struct dt *t = set_of(NULL, 0);
    struct cells r = cells_of(t, NULL);
    CHECK(r.n == 0);
    cells_free(&r);
    dt_free(t);
}

TEST(a_box_without_area_is_refused)
{
    static const struct dt_point p[] = {{0, 0}, {1, 0}, {0, 1}};
    struct dt *t = set_of(p, 3);
    struct dt_cells c;
    CHECK(dt_cells_begin(t, NULL, p[0], p[1], &c) == DT_RANGE);
    CHECK(dt_cells_begin(t, NULL, (struct dt_point){1, 1}, p[0], &c) == DT_RANGE);
    dt_free(t);
}

/* ---- canonical, cut, and as of a view ---- */

static uint32_t random_points(struct dt_point *p, uint32_t n, bool lattice)
{
    for (uint32_t i = 0; i < n; i++)
        p[i] = lattice ? (struct dt_point){(double)(test_random() % 9), (double)(test_random() % 9)}
                       : (struct dt_point){test_uniform(), test_uniform()};
    return n;
}

TEST(cells_after_any_edits_are_those_of_a_set_built_at_once)
{
    struct dt_point p[80], q;
    for (int round = 0; round < 40; round++) {
        uint32_t n = random_points(p, 80, round % 2 == 0), deleted, missing;
        struct dt *t = set_of(p, n), *fresh;
        for (int i = 0; i < 60; i++) {
            uint32_t id = (uint32_t)(test_random() % n);
            random_points(&q, 1, round % 2 == 0);
            if (test_random() % 3 == 0)
                dt_delete(t, &id, 1, &deleted, &missing);
            else
                dt_move(t, id, q);
        }
        CHECK(dt_clone_points(t, NULL, &fresh) == DT_OK);
        CHECK(dt_triangulate(fresh, NULL) == DT_OK);
        struct cells a = cells_of(t, NULL), b = cells_of(fresh, NULL);
        CHECK(are_equal(&a, &b));
        check_tiling(&a);
        check_made(t, &b, true);
        cells_free(&a);
        cells_free(&b);
        dt_free(t);
        dt_free(fresh);
    }
}

TEST(cells_of_a_view_stay_as_they_were)
{
    struct dt_point p[200], q;
    for (int round = 0; round < 20; round++) {
        uint32_t n = random_points(p, round == 0 ? 30 : 200, round % 2 == 0), deleted, missing;
        for (uint32_t i = 0; round == 1 && i < n; i++)
            p[i].y = p[i].x; /* on a line */
        struct dt *t = set_of(p, n);
        struct cells before = cells_of(t, NULL);
        struct dt_view *v = dt_view_begin(t, true);
        CHECK(v != NULL);
        for (int i = 0; i < 100; i++) {
            uint32_t id = (uint32_t)(test_random() % n);
            random_points(&q, 1, round % 2 == 0);
            if (test_random() % 2 == 0)
                dt_delete(t, &id, 1, &deleted, &missing);
            else
                dt_move(t, id, q);
            if (i % 20 > 0)
                continue;
            struct cells then = cells_of(t, v);
            CHECK(are_equal(&before, &then));
            cells_free(&then);
        }
        dt_view_end(v);
        cells_free(&before);
        dt_free(t);
    }
}

TEST(parts_of_cells_are_the_whole_in_order)
{
    struct dt_point p[300];
    struct dt *t = set_of(p, random_points(p, 300, false));
    struct cells whole = cells_of(t, NULL), parts = {whole.lo, whole.hi, NULL, NULL, 0, 0, 0};
    struct dt_cells c, part;
    CHECK(dt_cells_begin(t, NULL, whole.lo, whole.hi, &c) == DT_OK);
    while (dt_cells_cut(t, &c, 7, &part))
        read_to_end(t, &part, true, &parts);
    CHECK(are_equal(&whole, &parts));
    cells_free(&whole);
    cells_free(&parts);
    dt_free(t);
}

TEST(cells_that_are_made_stay_as_they_were_while_the_set_is_edited)
{
    struct dt_point p[300];
    struct dt *t = set_of(p, random_points(p, 300, false));
    struct cells whole = cells_of(t, NULL), parts = {whole.lo, whole.hi, NULL, NULL, 0, 0, 0};
    struct dt_view *v = dt_view_begin(t, true);
    struct dt_cells c, part;
    uint32_t deleted, missing;
    CHECK(v != NULL && dt_cells_begin(t, v, whole.lo, whole.hi, &c) == DT_OK);
    struct dt_cells_made *m = make_all(t, &c);
    CHECK(m != NULL);
    c.made = m;
    for (uint32_t id = 0; dt_cells_cut(t, &c, 7, &part); id += 2) {
        read_to_end(t, &part, true, &parts);
        dt_delete(t, &id, 1, &deleted, &missing);
    }
    CHECK(are_equal(&whole, &parts));
    dt_cells_made_free(m);
    dt_view_end(v);
    cells_free(&whole);
    cells_free(&parts);
    dt_free(t);
}

TEST(cells_of_more_triangles_than_are_kept_are_made_the_same)
{
    enum { N = 20000 };
    struct dt_point *p = malloc(N * sizeof *p);
    CHECK(p != NULL);
    struct dt *t = set_of(p, random_points(p, N, false));
    struct cells whole = cells_of(t, NULL);
    check_made(t, &whole, false);
    cells_free(&whole);
    dt_free(t);
    free(p);
}

TEST(cells_are_made_at_once_unless_most_ids_are_gone)
{
    struct dt_point p[300];
    struct dt *t = set_of(p, random_points(p, 300, false));
    for (uint32_t id = 0, deleted, missing; id < 200; id++)
        dt_delete(t, &id, 1, &deleted, &missing);
    struct cells whole = cells_of(t, NULL);
    struct dt_cells c;
    struct dt_cells_made *m;
    CHECK(whole.n == 100 && dt_cells_begin(t, NULL, whole.lo, whole.hi, &c) == DT_OK);
    CHECK(dt_cells_make_begin(t, &c, &m) == DT_OK && m == NULL);
    cells_free(&whole);
    dt_free(t);
}

TEST(cells_that_are_made_without_memory_are_freed)
{
    struct dt_point p[300];
    struct dt *t = set_of(p, random_points(p, 300, false));
    struct cells whole = cells_of(t, NULL);
    struct dt_cells c;
    CHECK(dt_cells_begin(t, NULL, whole.lo, whole.hi, &c) == DT_OK);
    for (int i = 0; i < 40; i++) {
        struct dt_cells_made *m;
        bool done = false;
        test_fail_alloc(i / 2);
        enum dt_status s =
            i % 2 == 0 ? dt_cells_make_begin(t, &c, &m) : dt_areas_make_begin(t, &c, &m);
        while (s == DT_OK && !done)
            s = dt_cells_make(t, m, NULL, 100, &done);
        CHECK(s == (test_alloc_failed() ? DT_NOMEM : DT_OK));
        test_fail_alloc(0);
        dt_cells_made_free(m);
    }
    check_made(t, &whole, false);
    cells_free(&whole);
    dt_free(t);
}

TEST(the_cell_of_a_hub_is_read_at_once)
{
    enum { N = 500 };
    struct dt_point p[N + 1] = {{0, 0}};
    for (int i = 1; i <= N; i++)
        p[i] = (struct dt_point){cos(i * 0.0125), sin(i * 0.0125)};
    struct dt *t = set_of(p, N + 1);
    struct cells r = cells_of(t, NULL), only = {r.lo, r.hi, NULL, NULL, 0, 0, 0};
    struct dt_cells c, one;
    check_tiling(&r);
    check_made(t, &r, true);
    CHECK(r.cell[0].corners > 400);
    CHECK(dt_cells_begin(t, NULL, r.lo, r.hi, &c) == DT_OK);
    dt_cells_only(&c, 0, &one);
    read_to_end(t, &one, true, &only);
    CHECK(only.n == 1 && only.corners == r.cell[0].corners);
    cells_free(&r);
    cells_free(&only);
    dt_free(t);
}
