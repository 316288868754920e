/* inside_test.c - surfaces that end at borders: the inside is the same as without borders, and there is nothing outside. */
#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "tests/core/polls.h"
#include "tests/core/surface/values.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 9, POINTS = 40, NUMBERS = 3 };

static uint32_t below(uint32_t n)
{
    return (uint32_t)(test_random() % n);
}

/* Whether the place is inside the border of the number, or any, or on its edge. */
static bool is_enclosed(const struct dt *t, uint32_t number, struct dt_point q)
{
    struct dt_ids in = {0}, on = {0};
    CHECK(dt_regions_at(t, q, NULL, &in, &on) == DT_OK);
    bool found = number == DT_NONE && in.n + on.n > 0;
    for (size_t i = 0; i < in.n + on.n; i++)
        found |= (i < in.n ? in.v[i] : on.v[i - in.n]) == number;
    free(in.v);
    free(on.v);
    return found;
}

/* A random set with values and borders, some of which cross nothing; surveyed. */
static struct dt *random_set(void)
{
    struct dt_point p[POINTS];
    double z[POINTS];
    uint32_t missing;
    size_t added;
    for (int i = 0; i < POINTS; i++) {
        p[i] = (struct dt_point){below(SIDE), below(SIDE)};
        z[i] = below(12) == 0 ? (double)NAN : (double)below(9);
    }
    struct dt *t = set_with(p, z, POINTS);
    for (int rings = 0; rings < 12; rings++) {
        uint32_t n = 3 + below(3), id[5], number = below(NUMBERS);
        struct dt_constraint c[5];
        for (uint32_t i = 0; i < n; i++)
            id[i] = below(POINTS);
        for (uint32_t i = 0; i < n; i++)
            c[i] = (struct dt_constraint){id[i], id[(i + 1) % n], true, number};
        (void)dt_constrain(t, c, below(20) == 0 ? n - 1 : n, NULL, &added, &missing);
    }
    CHECK(dt_survey(t, NULL) == DT_OK);
    return t;
}

static void check_places(const struct dt *t, uint32_t number, enum dt_interpolation how,
                         double max_edge)
{
    struct dt_surface all = surface_in(t, how), inside = surface_in(t, how);
    all.max_edge = inside.max_edge = max_edge;
    inside.inside = true;
    inside.number = number;
    for (int i = 0; i < 100; i++) {
        struct dt_point q = {below(4 * SIDE + 4) / 4.0 - 0.5, below(4 * SIDE + 4) / 4.0 - 0.5};
        double want = is_enclosed(t, number, q) ? value_at(t, &all, q) : (double)NAN;
        double got = value_at(t, &inside, q);
        /* a triangle whose edge is too long does not lend its edge to what is beyond the border */
        if (max_edge == HUGE_VAL || isnan(want) || !isnan(got))
            check_same(got, want, q);
    }
    dt_surface_end(&all);
    dt_surface_end(&inside);
}

static void check_cells(const struct dt *t, uint32_t number, enum dt_interpolation how)
{
    enum { COLUMNS = 37, ROWS = 20 };
    struct dt_surface s = surface_in(t, how);
    struct dt_raster r = {{-1, -1}, {SIDE, SIDE}, COLUMNS, ROWS};
    double value[COLUMNS * ROWS];
    size_t done;
    s.inside = true;
    s.number = number;
    CHECK(dt_raster_values(t, &s, &r, 0, COLUMNS * ROWS, NULL, value, &done) == DT_OK);
    for (uint64_t i = 0; i < COLUMNS * ROWS; i++) {
        struct dt_point q = dt_raster_centre(&r, i);
        check_same(value[i], value_at(t, &s, q), q);
    }
    dt_surface_end(&s);
}

/* ---- the cells inside ---- */

static void check_marks(const struct dt *t, uint32_t number, struct dt_raster r)
{
    enum { MOST = 6000 };
    uint8_t bits[MOST / 8];
    bool closed = dt_has_closed_border(t);
    CHECK(r.columns * r.rows <= MOST);
    CHECK(dt_raster_inside(t, number, &r, NULL, bits) == (closed ? DT_OK : DT_OPEN));
    for (uint64_t i = 0; closed && i < r.columns * r.rows; i++) {
        struct dt_point q = dt_raster_centre(&r, i);
        CHECK_MSG((bits[i / 8] >> i % 8 & 1) == is_enclosed(t, number, q), "%.17g %.17g", q.x, q.y);
    }
}

/* Centres at points, on edges, beside the hull on all sides, and far away; wide and high rasters. */
static void check_all_marks(const struct dt *t, uint32_t number)
{
    check_marks(t, number, (struct dt_raster){{-2.25, -2.25}, {SIDE + 1.75, SIDE + 1.75}, 26, 26});
    check_marks(t, number,
                (struct dt_raster){{-1.125, -1.125}, {SIDE + .875, SIDE + .875}, 44, 44});
    check_marks(t, number, (struct dt_raster){{-60, -3}, {60, 12}, 400, 13});
    check_marks(t, number, (struct dt_raster){{2, -900}, {6, 900}, 3, 999});
    check_marks(t, number, (struct dt_raster){{3, 3}, {3, 3}, 5, 2});
    double x = test_uniform() * SIDE, y = test_uniform() * SIDE;
    check_marks(t, number, (struct dt_raster){{x - 1, y - 1}, {x + 1, y + 1}, 70, 9});
    for (int i = 0; i < 20; i++) { /* fewer cells than edges */
        x = below(2 * SIDE + 1) / 2.0;
        y = below(2 * SIDE + 1) / 2.0;
        check_marks(t, number, (struct dt_raster){{x - .75, y - .75}, {x + .75, y + .75}, 3, 3});
    }
}

/* ---- contours ---- */

struct segment {
    struct dt_point from, to;
};

struct segments {
    struct segment *v; /* owns */
    size_t n;
};

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct segment));
}

/* The segments of all lines, sorted; with a number only those inside. */
static struct segments contour(const struct dt *t, bool inside, uint32_t number)
{
    static const double level[] = {2.5, 4.5};
    struct segments s = {malloc(4096 * sizeof *s.v), 0};
    const struct dt_contour_line *line;
    struct dt_contour *c;
    size_t lines;
    bool done = false;
    CHECK(dt_contour_begin(t, NULL, dt_field_find(t, "z", 1), level, 2, HUGE_VAL, &c) == DT_OK);
    if (inside)
        CHECK(dt_contour_inside(c, t, number) == DT_OK);
    while (!done)
        CHECK(dt_contour_read(t, c, &done) == DT_OK);
    CHECK(dt_contour_end(c, NULL, &line, &lines) == DT_OK);
    for (size_t i = 0; i < lines; i++)
        for (size_t k = 0; k + !line[i].closed < line[i].n; k++)
            s.v[s.n++] = (struct segment){line[i].p[k], line[i].p[(k + 1) % line[i].n]};
    qsort(s.v, s.n, sizeof *s.v, compare);
    dt_contour_free(c);
    return s;
}

static void check_contour(const struct dt *t, uint32_t number)
{
    struct segments all = contour(t, false, 0), inside = contour(t, true, number);
    size_t n = 0;
    for (size_t i = 0; i < all.n; i++) {
        const struct segment *s = &all.v[i];
        struct dt_point middle = {(s->from.x + s->to.x) / 2, (s->from.y + s->to.y) / 2};
        if (is_enclosed(t, number, middle))
            CHECK(n < inside.n && compare(s, &inside.v[n++]) == 0);
    }
    CHECK(n == inside.n);
    free(all.v);
    free(inside.v);
}

/* ---- tests ---- */

TEST(a_surface_that_ends_at_borders_is_missing_exactly_where_they_do_not_enclose_the_place)
{
    for (int round = 0; round < 25; round++) {
        struct dt *t = random_set();
        for (uint32_t k = 0; k <= NUMBERS; k++) {
            uint32_t number = k == NUMBERS ? DT_NONE : k;
            if (dt_region_check(t, number) != DT_OK)
                continue;
            check_places(t, number, DT_LINEAR, HUGE_VAL);
            check_places(t, number, DT_CLOSEST, HUGE_VAL);
            check_places(t, number, DT_LINEAR, 3);
            check_cells(t, number, k % 2 == 0 ? DT_LINEAR : DT_CLOSEST);
            check_contour(t, number);
            check_all_marks(t, number);
        }
        dt_free(t);
    }
}

TEST(a_surface_that_ends_at_a_border_needs_it_closed_and_known)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    static const double z[] = {1, 2, 3, 4}, level[] = {2.5};
    struct dt *t = set_with(p, z, 4);
    struct dt_constraint c[] = {{0, 1, true, 5}, {1, 2, true, 5}, {2, 0, true, 5}};
    struct dt_surface s = surface_in(t, DT_LINEAR);
    struct dt_contour *contour;
    size_t n, done;
    uint32_t missing;
    double value;
    s.inside = true;
    s.number = 5;
    CHECK(dt_values(t, &s, p, 1, NULL, &value, &done) == DT_NOREGION);
    CHECK(dt_constrain(t, c, 2, NULL, &n, &missing) == DT_OK);
    CHECK(dt_values(t, &s, p, 1, NULL, &value, &done) == DT_UNSURVEYED);
    CHECK(dt_survey(t, NULL) == DT_OK);
    CHECK(dt_values(t, &s, p, 1, NULL, &value, &done) == DT_OPEN && done == 0);
    struct dt_raster r = {{0, 0}, {4, 4}, 1, 1};
    uint8_t bits;
    CHECK(dt_raster_inside(t, DT_NONE, &r, NULL, &bits) == DT_OPEN);
    CHECK(dt_raster_inside(t, 6, &r, NULL, &bits) == DT_NOREGION);
    CHECK(dt_constrain(t, c, 3, NULL, &n, &missing) == DT_OK && dt_survey(t, NULL) == DT_OK);
    CHECK(value_at(t, &s, p[0]) == 1 && isnan(value_at(t, &s, p[3])));
    s.number = 6;
    CHECK(dt_values(t, &s, p, 1, NULL, &value, &done) == DT_NOREGION);
    CHECK(dt_contour_begin(t, NULL, dt_field_find(t, "z", 1), level, 1, HUGE_VAL, &contour) ==
          DT_OK);
    CHECK(dt_contour_inside(contour, t, 6) == DT_NOREGION);
    dt_contour_free(contour);
    dt_surface_end(&s);
    dt_free(t);
}

TEST(regions_of_a_view_are_those_of_now_until_borders_or_points_change)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    static const double z[] = {1, 2, 3, 4};
    struct dt *t = set_with(p, z, 4);
    struct dt_constraint c[] = {{0, 1, true, 5}, {1, 2, true, 5}, {2, 0, true, 5}};
    size_t n;
    uint32_t missing;
    struct dt_added added;
    CHECK(dt_constrain(t, c, 3, NULL, &n, &missing) == DT_OK && dt_survey(t, NULL) == DT_OK);
    struct dt_view *v = dt_view_begin(t, true);
    CHECK(dt_view_has_regions(t, v));
    c[0].number = 6; /* the triangulation stays */
    CHECK(dt_constrain(t, c, 1, NULL, &n, &missing) == DT_OK && dt_view_is_current(t, v));
    CHECK(!dt_view_has_regions(t, v));
    CHECK(dt_release(t, c, 1, NULL, &n, &n) == DT_OK && dt_survey(t, NULL) == DT_OK);
    CHECK(!dt_view_has_regions(t, v));
    dt_view_end(v);
    v = dt_view_begin(t, true);
    CHECK(dt_add(t, &(struct dt_point){3, 1}, 1, &added) == DT_OK && dt_surveyed(t));
    CHECK(!dt_view_has_regions(t, v));
    dt_view_end(v);
    dt_free(t);
}

/* Two stars, one in the other, with their own numbers: in a set of many points. */
static struct dt *stars(uint32_t corners)
{
    enum { OTHERS = 4000 };
    const uint32_t n = 2 * corners + OTHERS;
    struct dt_point *p = malloc(n * sizeof *p);
    double *z = calloc(n, sizeof *z);
    struct dt_constraint *c = malloc(2 * corners * sizeof *c);
    size_t added;
    uint32_t missing;
    CHECK(p != NULL && z != NULL && c != NULL);
    for (uint32_t i = 0; i < n; i++)
        p[i] = (struct dt_point){test_uniform() * 4 - 2, test_uniform() * 4 - 2};
    for (uint32_t i = 0; i < 2 * corners; i++) {
        double angle = 6.283185307179586 * i / corners,
               far = (i % 2 + 1) * (i < corners ? 0.7 : 0.3);
        p[i] = (struct dt_point){far * cos(angle), far * sin(angle)};
        c[i] = (struct dt_constraint){i, i / corners * corners + (i + 1) % corners, true,
                                      i < corners ? 1 : 2};
    }
    struct dt *t = set_with(p, z, n);
    CHECK(dt_constrain(t, c, 2 * corners, NULL, &added, &missing) == DT_OK);
    CHECK(dt_survey(t, NULL) == DT_OK);
    free(p);
    free(z);
    free(c);
    return t;
}

/* Borders of few edges are followed, so triangles are not looked at; the raster of values looks at them. */
TEST(marks_of_large_rasters_are_where_the_surface_has_values)
{
    enum { SIDE_CELLS = 220, CELLS = SIDE_CELLS * SIDE_CELLS };
    static double value[CELLS];
    static uint8_t bits[CELLS / 8 + 1];
    const struct dt_raster raster[] = {{{-1.5, -1.5}, {1.5, 1.5}, SIDE_CELLS, SIDE_CELLS},
                                       {{0.1, -9}, {0.9, 0.4}, SIDE_CELLS, SIDE_CELLS - 1},
                                       {{-1e30, -1}, {1e30, 1}, SIDE_CELLS, 7}};
    struct dt *t = stars(300);
    struct dt_surface s = surface_in(t, DT_LINEAR);
    s.inside = true;
    for (size_t k = 0; k < sizeof raster / sizeof *raster; k++)
        for (uint32_t number = 0; number < 3; number++) {
            const uint64_t n = (uint64_t)raster[k].columns * raster[k].rows;
            size_t done;
            s.number = number == 0 ? DT_NONE : number;
            CHECK(dt_raster_values(t, &s, &raster[k], 0, n, NULL, value, &done) == DT_OK);
            CHECK(dt_raster_inside(t, s.number, &raster[k], NULL, bits) == DT_OK);
            for (uint64_t i = 0; i < n; i++)
                CHECK_MSG((bits[i / 8] >> i % 8 & 1) == !isnan(value[i]), "cell %d", (int)i);
        }
    dt_surface_end(&s);
    dt_free(t);
}

TEST(marking_cells_polls_its_flag)
{
    static uint8_t bits[1000 * 1000 / 8];
    const struct dt_raster r = {{-1.5, -1.5}, {1.5, 1.5}, 1000, 1000};
    atomic_bool cancel = false;
    struct dt_options opt = {.cancel = &cancel};
    struct dt *t = stars(300);
    polls_begin();
    CHECK(dt_raster_inside(t, DT_NONE, &r, &opt, bits) == DT_OK);
    polls_end();
    CHECK_MSG(polls_longest_ms() < 20, "%g ms", polls_longest_ms());
    uint64_t polls = polls_count();
    CHECK(polls > 300);
    for (uint64_t n = 1; n <= polls; n += polls / 5 + 1) {
        polls_cancel_at(n);
        CHECK(dt_raster_inside(t, DT_NONE, &r, &opt, bits) == DT_CANCELLED);
    }
    polls_cancel_at(0);
    dt_free(t);
}
