/* cells_test.c - Voronoi cells: their corners are exact places rounded once, and they tile the box. */
#include "core/delaunay_surface.h"
#include "core/exact/predicates.h"
#include "core/surface/centre.h"
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
           memcmp(a->cell, b->cell, a->n * sizeof *a->cell) == 0 &&
           memcmp(a->corner, b->corner, a->corners * sizeof *a->corner) == 0;
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
    /* Boxes through the points: their sides meet corners and run along edges. */
    for (int i = 0; i < 10 && r.n > 0; i++) {
        struct dt_point a = random_place(pair->b), b = random_place(pair->b);
        struct dt_point lo = {fmin(a.x, b.x), fmin(a.y, b.y)},
                        hi = {fmax(a.x, b.x), fmax(a.y, b.y)};
        if (!(lo.x < hi.x && lo.y < hi.y))
            continue;
        struct cells part = cells_in(pair->t, NULL, lo, hi);
        check_tiling(&part);
        cells_free(&part);
    }
    cells_free(&r);
}

TEST_TIMEOUT(cells_tile_every_box_on_every_family, 120)
{
    for_each_pair(check_pair);
}

/* ---- rounding ---- */

TEST(all_triangles_of_points_on_a_circle_have_the_same_centre)
{
    static const double at[8][2] = {{25, 0}, {24, 7}, {20, 15}, {15, 20},
                                    {7, 24}, {0, 25}, {-7, 24}, {-15, -20}};
    static const double scale[] = {1, 0x1p-130, 0x1p190}, from[] = {0, 1.0 / 3, 12345678.9, 0x1p40};
    for (int s = 0; s < 3; s++) {
        for (int f = 0; f < 4; f++) {
            struct dt_point p[8], first = {0, 0};
            bool exact = true;
            for (int i = 0; i < 8; i++) {
                p[i] = (struct dt_point){(at[i][0] + from[f]) * scale[s], at[i][1] * scale[s]};
                exact &= p[i].x / scale[s] - from[f] == at[i][0];
            }
            for (int a = 0; a < 8; a++)
                for (int b = 0; b < 8; b++)
                    for (int c = 0; c < 8; c++) {
                        if (a == b || b == c || c == a || !exact)
                            continue;
                        struct dt_point q = dt_centre(p[a], p[b], p[c]);
                        if (a == 0 && b == 1 && c == 2)
                            first = q;
                        CHECK(f == 1 || (q.x == first.x && q.y == first.y && q.y == 0));
                    }
        }
    }
}

TEST(a_centre_half_way_between_two_doubles_is_the_even_one)
{
    /* The centres' x is 2^52 + 0.5, 2^52 + 1.5 and, with a point far away, a little more. */
    double big = 0x1p52;
    struct dt_point a = {big, 0}, b = {big + 1, 0}, c = {big, 10}, d = {big + 2, 0};
    CHECK(dt_centre(a, b, c).x == big);
    CHECK(dt_centre(b, d, (struct dt_point){big + 1, 4}).x == big + 2);
    CHECK(dt_centre(a, b, c).y == 5);
    CHECK(dt_bisector_x(a, b, 7) == big && dt_bisector_x(b, d, -0x1p200) == big + 2);
    CHECK(dt_bisector_x((struct dt_point){big, 0}, (struct dt_point){big + 1, 0x1p-142}, 0) ==
          big + 1);
}

__extension__ typedef __int128 wide;

/* Whether v is from + n / d rounded to nearest, for 1 <= |v| < 2^31 and |d| < 2^43. */
static bool is_rounded(double v, int64_t from, wide n, wide d)
{
    int e;
    frexp(v, &e); /* |v| < 2^e: half a unit is 2^(e - 54) */
    wide unit = (wide)1 << (54 - e);
    wide scaled = (wide)ldexp(v, 54 - e), error = (scaled - from * unit) * d - n * unit;
    error = error < 0 ? -error : error;
    return error < (d < 0 ? -d : d) || (error == (d < 0 ? -d : d) && scaled / 2 % 2 == 0);
}

TEST(centres_of_points_far_from_the_origin_are_rounded_to_nearest)
{
    int checked = 0;
    for (int i = 0; i < 100000; i++) {
        int64_t base = (int64_t)(test_random() % (1u << 30)), v[4];
        unsigned spread = 1 + (unsigned)(test_random() % 18);
        for (int k = 0; k < 4; k++)
            v[k] = (int64_t)(test_random() % (2u << spread)) - (1 << spread);
        struct dt_point a = {(double)base, (double)-base};
        struct dt_point b = {(double)(base + v[0]), (double)(v[1] - base)};
        struct dt_point c = {(double)(base + v[2]), (double)(v[3] - base)};
        int64_t bb = v[0] * v[0] + v[1] * v[1], cc = v[2] * v[2] + v[3] * v[3];
        int64_t twice = 2 * (v[0] * v[3] - v[1] * v[2]);
        if (twice == 0)
            continue;
        struct dt_point p = dt_centre(a, b, c);
        if (fabs(p.x) >= 1 && fabs(p.x) < 0x1p31 && ++checked > 0)
            CHECK(is_rounded(p.x, base, (wide)bb * v[3] - (wide)cc * v[1], twice));
        if (fabs(p.y) >= 1 && fabs(p.y) < 0x1p31 && ++checked > 0)
            CHECK(is_rounded(p.y, -base, (wide)cc * v[0] - (wide)bb * v[2], twice));
    }
    CHECK(checked > 100000);
}

TEST(centres_do_not_depend_on_the_order_of_the_corners)
{
    for (int i = 0; i < 5000; i++) {
        struct dt_point p[3];
        int spread = (int)(test_random() % 60), flat = (int)(test_random() % 80);
        for (int k = 0; k < 3; k++) {
            p[k].x = ldexp(test_uniform() - 0.5, (int)(test_random() % (unsigned)(spread + 1)));
            p[k].y = p[k].x / 3 + ldexp(test_uniform(), -flat);
        }
        if (dt_orient2d(p[0], p[1], p[2]) == 0)
            continue;
        struct dt_point q = dt_centre(p[0], p[1], p[2]);
        for (int k = 0; k < 3; k++) {
            struct dt_point r = dt_centre(p[(k + 1) % 3], p[k], p[(k + 2) % 3]);
            CHECK(q.x == r.x && q.y == r.y);
        }
    }
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
    CHECK(r.cell[0].corners > 400);
    CHECK(dt_cells_begin(t, NULL, r.lo, r.hi, &c) == DT_OK);
    dt_cells_only(&c, 0, &one);
    read_to_end(t, &one, true, &only);
    CHECK(only.n == 1 && only.corners == r.cell[0].corners);
    cells_free(&r);
    cells_free(&only);
    dt_free(t);
}
