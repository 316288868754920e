/* profile_test.c - profiles beside all edges and vertices, in exact arithmetic. */
#include "core/constraints/crossings.h"
#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "core/exact/bignum.h"
#include "core/exact/predicates.h"
#include "tests/core/sets.h"
#include "tests/core/surface/values.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 4000 };

struct profile {
    struct dt_profile_row row[MOST];
    size_t n;
};

static void read_profile(const struct dt *t, const struct dt_surface *s, const struct dt_point *q,
                         size_t n, size_t room, struct profile *out)
{
    struct dt_profile *p;
    size_t rows = 1;
    CHECK(dt_profile_begin(t, s, q, n, NULL, &p) == DT_OK);
    for (out->n = 0; rows > 0; out->n += rows) {
        CHECK(out->n + room <= MOST);
        CHECK(dt_profile_read(p, out->row + out->n, room, &rows) == DT_OK);
    }
    dt_profile_free(p);
}

/* ---- some that can be computed by hand ---- */

static void check_rows(const struct profile *got, const double (*want)[4], size_t n)
{
    CHECK_MSG(got->n == n, "%zu rows", got->n);
    for (size_t i = 0; i < n; i++) {
        const struct dt_profile_row *r = &got->row[i];
        check_same(r->distance, want[i][0], (struct dt_point){r->x, r->y});
        check_same(r->x, want[i][1], (struct dt_point){r->x, r->y});
        check_same(r->y, want[i][2], (struct dt_point){r->x, r->y});
        check_same(r->value, want[i][3], (struct dt_point){r->x, r->y});
    }
}

static struct profile *profile_in(const struct dt *t, const struct dt_point *q, size_t n)
{
    static struct profile p;
    struct dt_surface s = surface_in(t, DT_LINEAR);
    read_profile(t, &s, q, n, 1, &p);
    dt_surface_end(&s);
    return &p;
}

#define NONE ((double)NAN)
#define COUNT(a) (sizeof(a) / sizeof *(a))

/* A square of side 4 with a peak of height 2 in its middle. */
static struct dt *peak(void)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    static const double z[] = {0, 0, 0, 0, 2};
    return set_with(p, z, 5);
}

TEST(a_profile_has_its_ends_and_every_edge_that_it_crosses)
{
    static const struct dt_point q[] = {{-1, 1}, {5, 1}};
    static const double want[][4] = {{0, -1, 1, NONE}, {1, 0, 1, 0}, {2, 1, 1, 1},
                                     {4, 3, 1, 1},     {5, 4, 1, 0}, {6, 5, 1, NONE}};
    struct dt *t = peak();
    check_rows(profile_in(t, q, 2), want, COUNT(want));
    dt_free(t);
}

TEST(a_profile_along_edges_passes_their_ends)
{
    static const struct dt_point q[] = {{-1, -1}, {1, 1}, {5, 5}, {5, 4}, {-1, 4}};
    const double root = sqrt(2);
    const double want[][4] = {{0, -1, -1, NONE},          {root, 0, 0, 0},
                              {2 * root, 1, 1, 1},        {3 * root, 2, 2, 2},
                              {5 * root, 4, 4, 0},        {6 * root, 5, 5, NONE},
                              {6 * root + 1, 5, 4, NONE}, {6 * root + 2, 4, 4, 0},
                              {6 * root + 6, 0, 4, 0},    {6 * root + 7, -1, 4, NONE}};
    struct dt *t = peak();
    struct profile *p = profile_in(t, q, 5);
    for (size_t i = 0; i < p->n && i < COUNT(want); i++) {
        CHECK(fabs(p->row[i].distance - want[i][0]) < 1e-14);
        p->row[i].distance = want[i][0];
    }
    check_rows(p, want, COUNT(want));
    dt_free(t);
}

TEST(a_profile_that_touches_a_corner_of_the_hull_has_that)
{
    static const struct dt_point q[] = {{-1, 1}, {1, -1}};
    struct dt *t = peak();
    struct profile *p = profile_in(t, q, 2);
    CHECK(p->n == 3 && p->row[1].x == 0 && p->row[1].y == 0 && p->row[1].value == 0);
    dt_free(t);
}

TEST(a_profile_of_one_place_or_of_none)
{
    static const struct dt_point q[] = {{2, 1}, {2, 1}, {9, 9}, {9, 9}};
    static const double want[][4] = {{0, 2, 1, 1}, {0, 2, 1, 1}};
    struct dt *t = peak();
    CHECK(profile_in(t, q, 0)->n == 0);
    check_rows(profile_in(t, q, 2), want, 2);
    CHECK(profile_in(t, q + 2, 2)->n == 2);
    dt_free(t);
}

TEST(profiles_are_missing_where_a_value_of_the_edge_is)
{
    static const struct dt_point q[] = {{-1, 1}, {5, 1}};
    static const double want[][4] = {{0, -1, 1, NONE}, {1, 0, 1, 0},    {2, 1, 1, 1},
                                     {4, 3, 1, NONE},  {5, 4, 1, NONE}, {6, 5, 1, NONE}};
    struct dt *t = peak();
    double none = NONE;
    uint32_t missing;
    CHECK(dt_field_set_run(t, "z", 1, 1, &none, 1, NULL, &missing) == DT_OK);
    check_rows(profile_in(t, q, 2), want, COUNT(want));
    dt_free(t);
}

TEST(profiles_beside_points_on_a_line)
{
    static const struct dt_point p[] = {{0, 0}, {4, 4}, {2, 2}};
    static const double z[] = {0, 4, 1};
    static const struct dt_point along[] = {{5, 5}, {1, 1}, {-1, -1}}, across[] = {{3, 0}, {0, 3}},
                                 through[] = {{2, 0}, {2, 5}}, beyond[] = {{9, 0}, {0, 11}};
    struct dt *t = set_with(p, z, 3);
    struct profile *r = profile_in(t, along, 3);
    CHECK(r->n == 6 && r->row[1].value == 4 && r->row[2].value == 1 && r->row[3].value == 0.5);
    CHECK(r->row[3].x == 1 && r->row[4].x == 0 && isnan(r->row[5].value));
    r = profile_in(t, across, 2);
    CHECK(r->n == 3 && r->row[1].x == 1.5 && r->row[1].y == 1.5 && r->row[1].value == 0.75);
    r = profile_in(t, through, 2);
    CHECK(r->n == 3 && r->row[1].y == 2 && r->row[1].value == 1 && r->row[1].distance == 2);
    CHECK(profile_in(t, beyond, 2)->n == 2);
    dt_free(t);
}

TEST(profiles_beside_one_point_or_none)
{
    static const struct dt_point p[] = {{1, 2}};
    static const double z[] = {7};
    static const struct dt_point q[] = {{0, 0}, {2, 4}, {2, 0}};
    struct dt *t = set_with(p, z, 1);
    struct profile *r = profile_in(t, q, 3);
    CHECK(r->n == 4 && r->row[1].value == 7 && r->row[1].x == 1 && r->row[1].y == 2);
    CHECK(isnan(r->row[0].value) && r->row[1].distance == sqrt(5));
    CHECK(profile_in(t, q, 1)->n == 1);
    dt_free(t);
    t = set_of(p, 0);
    struct dt_surface s = surface_of(DT_LINEAR);
    static struct profile none;
    read_profile(t, &s, q, 3, 4, &none);
    CHECK(none.n == 3 && isnan(none.row[2].value));
    dt_free(t);
}

/* The way crosses the edge halfway, in the middle of two doubles for x. */
TEST(crossings_in_the_middle_of_two_doubles_are_even)
{
    const double unit = 0x1p-52;
    for (int k = 0; k < 4; k++) {
        const struct dt_point q[] = {{1 + 2 * k * unit, -1}, {1 + (2 * k + 2) * unit, 1}};
        const struct dt_point a = {-4, 0}, b = {4, 0};
        struct dt_point at = dt_crossing_place(&(struct dt_segment){.p = q[0], .q = q[1]},
                                               &(struct dt_segment){.p = a, .q = b});
        CHECK(at.x == 1 + (2 * k + 1) * unit && at.y == 0);
        const struct dt_point r[] = {{1 + k * unit, -1}, {1 + (k + 1) * unit, 1}};
        at = dt_crossing_place(&(struct dt_segment){.p = r[0], .q = r[1]},
                               &(struct dt_segment){.p = a, .q = b});
        CHECK(at.x == 1 + (k % 2 == 0 ? k : k + 1) * unit && at.y == 0);
    }
}

TEST(profiles_of_unfinished_sets_and_of_few_steps)
{
    static const struct dt_point q[] = {{-1, 1}, {5, 1}};
    struct dt_options few = {.steps = 30};
    struct dt_profile_row row[8];
    struct dt_profile *p;
    size_t n;
    struct dt *t = dt_new(0);
    struct dt_surface s = surface_of(DT_LINEAR);
    CHECK(dt_profile_begin(t, &s, q, 2, NULL, &p) == DT_UNTRIANGULATED);
    dt_free(t);
    t = peak();
    CHECK(dt_profile_begin(t, &s, q, 2, &few, &p) == DT_OK);
    CHECK(dt_profile_read(p, row, 8, &n) == DT_TOOLONG && n < 6);
    dt_profile_free(p);
    atomic_bool cancel = true;
    few = (struct dt_options){.cancel = &cancel};
    CHECK(dt_profile_begin(t, &s, q, 2, &few, &p) == DT_OK);
    CHECK(dt_profile_read(p, row, 8, &n) == DT_CANCELLED && n == 0);
    dt_profile_free(p);
    dt_free(t);
}

/* Of a hull of many edges, from far outside in all directions: each place takes at most a step for each edge of the hull. */
TEST(a_profile_from_far_outside_takes_at_most_a_step_for_each_edge_of_the_hull)
{
    enum { CORNERS = 3000, ROUNDS = 40, OF_PLACES = 100 };
    static struct dt_point p[CORNERS];
    static double z[CORNERS];
    static struct dt_profile_row row[CORNERS];
    unsigned long_ones = 0;
    for (int i = 0; i < CORNERS; i++)
        p[i] = (struct dt_point){cos(6.283185307 * i / CORNERS), sin(6.283185307 * i / CORNERS)};
    struct dt *t = set_with(p, z, CORNERS);
    struct dt_surface s = surface_in(t, DT_LINEAR);
    for (int i = 0; i < ROUNDS; i++) {
        double turn = 0.7 * i, aim = turn + (i % 2 == 0 ? 1.5705 : -1.5705);
        struct dt_point way[] = {{1e9 * cos(turn), 1e9 * sin(turn)}, {cos(aim), sin(aim)}};
        struct dt_profile *f;
        enum dt_status status[2];
        size_t n;
        for (int few = 0; few < 2; few++) {
            struct dt_options opt = {.steps = few ? OF_PLACES : CORNERS + OF_PLACES};
            CHECK(dt_profile_begin(t, &s, way, 2, &opt, &f) == DT_OK);
            status[few] = dt_profile_read(f, row, CORNERS, &n);
            CHECK(n <= 30);
            dt_profile_free(f);
        }
        CHECK(status[0] == DT_OK && (status[1] == DT_OK || status[1] == DT_TOOLONG));
        long_ones += status[1] == DT_TOOLONG;
    }
    CHECK_MSG(long_ones > ROUNDS / 4, "%u", long_ones);
    dt_surface_end(&s);
    dt_free(t);
}

/* ---- beside all edges and vertices ---- */

struct fraction {
    struct dt_big num, den; /* den > 0 */
};

static struct dt_big product(const struct dt_big *a, const struct dt_big *b)
{
    return dt_big_multiply(*a, *b);
}

static struct dt_big cross_of(struct dt_point o, struct dt_point a, struct dt_point p,
                              struct dt_point b)
{
    struct dt_big ax, ay, bx, by;
    ax = dt_big_difference(a.x, o.x);
    ay = dt_big_difference(a.y, o.y);
    bx = dt_big_difference(b.x, p.x);
    by = dt_big_difference(b.y, p.y);
    ax = product(&ax, &by);
    ay = product(&ay, &bx);
    return dt_big_subtract(ax, ay);
}

struct expected {
    struct fraction along;
    struct dt_point at;
    uint32_t a, b; /* ids; equal for a vertex */
    double share;  /* of the edge from a to b */
};

static int compare_fractions(const struct fraction *a, const struct fraction *b)
{
    struct dt_big x = product(&a->num, &b->den), y = product(&b->num, &a->den);
    return dt_big_compare(x, y);
}

static int compare_expected(const void *a, const void *b)
{
    return compare_fractions(&((const struct expected *)a)->along,
                             &((const struct expected *)b)->along);
}

static struct fraction fraction_of(struct dt_big num, struct dt_big den)
{
    num.sign *= den.sign;
    den.sign *= den.sign;
    return (struct fraction){num, den};
}

static bool strictly_between(struct dt_point p, struct dt_point v, struct dt_point q)
{
    int way = dt_compare_xy(p, q);
    return way != 0 && dt_orient2d(p, q, v) == 0 && dt_compare_xy(p, v) == way &&
           dt_compare_xy(v, q) == way;
}

static double quotient(const struct dt_big *a, const struct dt_big *b)
{
    struct dt_big r = dt_big_divide(*a, *b);
    return dt_big_nearest(r);
}

/* Lists the places strictly between p and q. */
static size_t expect(const struct dt *t, struct dt_point p, struct dt_point q, struct expected *out)
{
    uint32_t row[2 * 64], next = dt_next_id(t);
    struct dt_cursor c;
    size_t rows = 1, words, n = 0;
    for (uint32_t id = 0; id < next; id++) {
        struct dt_point v;
        uint32_t rep;
        if (dt_get(t, id, &v) != DT_OK || dt_representative(t, id, &rep) != DT_OK || rep != id ||
            !strictly_between(p, v, q))
            continue;
        struct dt_big num, den;
        bool flat = p.x == q.x;
        num = dt_big_difference(flat ? v.y : v.x, flat ? p.y : p.x);
        den = dt_big_difference(flat ? q.y : q.x, flat ? p.y : p.x);
        out[n++] = (struct expected){fraction_of(num, den), v, id, id, 0};
    }
    CHECK(dt_table_begin(t, NULL, DT_EDGES, false, &c) == DT_OK);
    while (rows > 0) {
        CHECK(dt_table_read(t, &c, row, 2 * 64, 64, &rows, &words) == DT_OK);
        for (size_t i = 0; i < words; i += 2) {
            struct dt_segment way = {.p = p, .q = q}, edge = {0};
            CHECK(dt_get(t, row[i], &edge.p) == DT_OK && dt_get(t, row[i + 1], &edge.q) == DT_OK);
            if (!dt_segments_cross(&way, &edge))
                continue;
            struct dt_big den = cross_of(p, q, edge.p, edge.q),
                          num = cross_of(p, edge.p, edge.p, edge.q),
                          across = cross_of(p, edge.p, p, q);
            out[n++] = (struct expected){fraction_of(num, den), dt_crossing_place(&way, &edge),
                                         row[i], row[i + 1], quotient(&across, &den)};
        }
    }
    qsort(out, n, sizeof *out, compare_expected);
    return n;
}

static void check_crossing(const struct dt_profile_row *r, const struct expected *e, double begin,
                           double length)
{
    double a = value_of(e->a), b = value_of(e->b), want = a + e->share * (b - a),
           along = begin + quotient(&e->along.num, &e->along.den) * length;
    CHECK(r->x == e->at.x && r->y == e->at.y);
    CHECK(fabs(r->value - want) <= 1e-12 && r->value >= fmin(a, b) && r->value <= fmax(a, b));
    CHECK_MSG(fabs(r->distance - along) <= 1e-15 * along + 0x1p-1074, "%.17g instead of %.17g",
              r->distance, along);
}

static double length_between(struct dt_point p, struct dt_point q)
{
    return hypot(q.x - p.x, q.y - p.y);
}

static void check_profile(const struct dt *t, const struct dt *other, const struct dt_point *q,
                          size_t n)
{
    static struct profile got, same;
    static struct expected want[MOST];
    struct dt_surface s = surface_of(DT_LINEAR);
    double begin = 0;
    read_profile(t, &s, q, n, 3, &got);
    read_profile(other, &s, q, n, 7, &same);
    CHECK(got.n == same.n && memcmp(got.row, same.row, got.n * sizeof *got.row) == 0);
    const struct dt_profile_row *r = got.row;
    for (size_t i = 0; i < n; i++, r++) {
        double length = i > 0 ? length_between(q[i - 1], q[i]) : 0;
        size_t between = i > 0 ? expect(t, q[i - 1], q[i], want) : 0;
        CHECK_MSG((size_t)(r - got.row) + between < got.n, "%zu rows, %zu between", got.n, between);
        for (size_t k = 0; k < between; k++)
            check_crossing(r++, &want[k], begin, length);
        begin += length;
        CHECK(r->x == q[i].x && r->y == q[i].y && fabs(r->distance - begin) <= 1e-15 * begin);
        check_same(r->value, value_at(t, &s, q[i]), q[i]);
        CHECK(r == got.row || r->distance >= r[-1].distance);
    }
    CHECK((size_t)(r - got.row) == got.n);
}

static struct dt_point place_for(const struct pair *pair)
{
    struct dt_point p = random_place(pair->b), q = random_place(pair->b);
    if (test_random() % 4 != 0)
        return p;
    struct dt_point far = {p.x + 3 * (p.x - q.x), p.y + 3 * (p.y - q.y)};
    return dt_coordinate_ok(far.x) && dt_coordinate_ok(far.y) ? far : p;
}

/* The same representatives with other half edges: the points are added one by one. */
static struct dt *built_otherwise(const struct dt *t)
{
    uint32_t n = dt_next_id(t), k = 0, deleted, missing;
    struct dt_point *p = malloc((n + 1) * sizeof *p);
    uint32_t *gone = malloc((n + 1) * sizeof *gone);
    for (uint32_t id = 0; id < n; id++)
        if (dt_get(t, id, &p[id]) != DT_OK) {
            p[id] = (struct dt_point){0, 0};
            gone[k++] = id;
        }
    struct dt *other = set_of_each(p, n);
    CHECK(dt_delete(other, gone, k, &deleted, &missing) == DT_OK);
    free(p);
    free(gone);
    return other;
}

static void check_set(const struct pair *pair)
{
    struct dt *other = built_otherwise(pair->t);
    struct dt_point q[4];
    for (int round = 0; round < 12; round++) {
        for (int i = 0; i < 4; i++)
            q[i] = place_for(pair);
        check_profile(pair->t, other, q, 1 + test_random() % 4);
    }
    dt_free(other);
}

TEST(profiles_of_every_family_have_each_edge_and_vertex_once_in_order)
{
    make_values();
    for_each_pair(check_set);
}

TEST(profiles_through_constraints_cross_the_edges_that_these_make)
{
    enum { POINTS = 80, PIECES = 60 };
    struct dt_point p[POINTS], q[4];
    size_t added;
    uint32_t missing;
    make_values();
    for (int i = 0; i < POINTS; i++)
        p[i] = (struct dt_point){(double)(test_random() % 30), (double)(test_random() % 30)};
    struct dt *t = set_of(p, POINTS);
    for (int i = 0; i < PIECES; i++) {
        struct dt_constraint c = {.a = (uint32_t)(test_random() % POINTS),
                                  .b = (uint32_t)(test_random() % POINTS)};
        enum dt_status s = dt_constrain(t, &c, 1, NULL, &added, &missing);
        CHECK(s == DT_OK || s == DT_CROSSES || s == DT_NOEDGE);
    }
    for (int round = 0; round < 50; round++) {
        for (int i = 0; i < 4; i++)
            q[i] = (struct dt_point){(double)(test_random() % 40) - 5,
                                     (double)(test_random() % 40) - 5};
        check_profile(t, t, q, 4);
    }
    dt_free(t);
}
