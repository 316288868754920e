/* thin_test.c - points that are thinned out, beside the definition: a triangulation from scratch for each point that is kept. */
#include "core/delaunay_thinning.h"
#include "core/exact/predicates.h"
#include "tests/core/sets.h"
#include "tests/core/thinning/exactly.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 64 };

/* ---- the definition ---- */

/* Different places with values, of which some are missing, and constraints. */
struct input {
    struct dt_point p[MOST];
    double z[MOST];
    uint32_t n;
    struct dt_constraint c[MOST];
    size_t constraints;
};

/* The corners of the surface around q, counterclockwise from the least place, or the ends of an edge of a line. */
static int corners_around(const struct dt *t, const struct input *in, const uint32_t *kept,
                          struct dt_point q, struct corner *k)
{
    struct dt_location at;
    struct dt_ids rows = {0};
    uint32_t id[3];
    int n = 3, least = 0;
    CHECK(dt_locate(t, q, &at) == DT_OK && at.where != DT_OUTSIDE && at.where != DT_ON_VERTEX);
    memcpy(id, at.id, sizeof id);
    if (at.where == DT_ON_EDGE) {
        bool up = dt_compare_xy(in->p[kept[id[0]]], in->p[kept[id[1]]]) < 0;
        CHECK(dt_triangles_at_edge(t, id[up ? 0 : 1], id[up ? 1 : 0], false, &rows) == DT_OK);
        n = rows.n == 0 ? 2 : 3;
        for (size_t r = rows.n / 3;
             r-- > 0;) { /* the last one that is to the left, or the only one */
            const uint32_t *v = rows.v + 3 * r;
            bool left = false;
            for (int i = 0; i < 3; i++)
                left = left || (v[i] == id[up ? 0 : 1] && v[(i + 1) % 3] == id[up ? 1 : 0]);
            if (left || rows.n == 3) {
                memcpy(id, v, sizeof id);
                break;
            }
        }
    }
    for (int i = 1; i < n; i++)
        if (dt_compare_xy(in->p[kept[id[i]]], in->p[kept[id[least]]]) < 0)
            least = i;
    for (int i = 0; i < n; i++) {
        uint32_t v = kept[id[(least + i) % n]];
        k[i] = (struct corner){in->p[v], in->z[v]};
    }
    free(rows.v);
    return n;
}

static struct dt *surface_of(const struct input *in, const uint32_t *kept, uint32_t n)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    struct dt_point p[MOST];
    struct dt_constraint c[MOST];
    size_t declared;
    uint32_t missing, number[MOST] = {0};
    for (uint32_t i = 0; i < n; i++) {
        p[i] = in->p[kept[i]];
        number[kept[i]] = i;
    }
    CHECK(t != NULL && dt_add(t, p, n, &added) == DT_OK && added.coincident == 0);
    for (size_t i = 0; i < in->constraints; i++)
        c[i] = (struct dt_constraint){number[in->c[i].a], number[in->c[i].b], false, 0};
    CHECK(dt_constrain(t, c, in->constraints, NULL, &declared, &missing) == DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    return t;
}

static bool has_huge_value(const struct input *in)
{
    uint32_t i = 0;
    while (i < in->n && !(fabs(in->z[i]) > 0x1p600))
        i++;
    return i < in->n;
}

/* How far a point is off as far as it counts. */
static double off_of(const struct dt *t, const struct input *in, const uint32_t *kept, uint32_t i,
                     double bound)
{
    struct corner k[3];
    int n = corners_around(t, in, kept, in->p[i], k);
    for (int c = 0; c < n; c++)
        if (isnan(k[c].z))
            return HUGE_VAL;
    double off = has_huge_value(in) ? nearest_off(k, n, in->p[i], in->z[i])
                                    : rounded_off(k, n, in->p[i], in->z[i]);
    if (exact_side(k, n, in->p[i], in->z[i], bound) > 0)
        return off > bound ? fmin(off, DBL_MAX) : nextafter(bound, HUGE_VAL);
    return off > bound ? bound : off;
}

static bool is_kept(const uint32_t *kept, uint32_t n, uint32_t i)
{
    while (n > 0 && kept[n - 1] != i)
        n--;
    return n > 0;
}

/* The worst point; DT_NONE: none is off by more than the bound. *error: of the worst of all. */
static uint32_t worst_of(const struct input *in, const uint32_t *kept, uint32_t n, double bound,
                         double *error)
{
    struct dt *t = surface_of(in, kept, n);
    uint32_t worst = DT_NONE;
    *error = 0;
    for (uint32_t i = 0; i < in->n; i++) {
        if (isnan(in->z[i]) || is_kept(kept, n, i))
            continue;
        double off = off_of(t, in, kept, i, bound);
        if (worst == DT_NONE || off > *error ||
            (off == *error && dt_compare_xy(in->p[i], in->p[worst]) < 0))
            worst = i;
        *error = fmax(*error, off);
    }
    dt_free(t);
    return *error > bound ? worst : DT_NONE;
}

static int compare_ids(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

/* Continues from the `n` points that must stay. Returns how many are kept. */
static uint32_t thin_out(const struct input *in, uint32_t *kept, uint32_t n, double bound,
                         uint32_t most, double *error)
{
    for (uint32_t worst; (worst = worst_of(in, kept, n, bound, error)) != DT_NONE && n < most;)
        kept[n++] = worst;
    qsort(kept, n, sizeof *kept, compare_ids);
    return n;
}

/* ---- inputs ---- */

static struct dt_thinned thinned(const struct input *in, double error, uint32_t most)
{
    struct dt_thinning t = {in->p, in->z, in->n, in->c, in->constraints,
                            error, most,  NULL,  NULL,  NULL};
    struct dt_thinned out;
    enum dt_status status = dt_thin(&t, NULL, &out);
    CHECK_MSG(status == DT_OK, "%s", dt_status_text(status));
    return out;
}

/* Values of a kind; kinds 0 to 6. */
static double value_of(struct dt_point p, int kind)
{
    double random = (double)(test_random() % 1000) / 100;
    switch (kind) {
    case 0:
        return random;
    case 1:
        return 3; /* a plateau */
    case 2:
        return test_random() % 4 == 0 ? 1 : 0;
    case 3:
        return test_random() % 3 == 0 ? (double)NAN : random;
    case 4:
        return fabs(p.x) < 1e100 && fabs(p.y) < 1e100 ? 2 * p.x + p.y : random; /* a plane */
    case 5:
        return ldexp(random - 5, (int)(test_random() % 400) - 200);
    default:
        return 1e303 * (double)(test_random() % 3) - 1e302;
    }
}

static bool has_place(const struct input *in, struct dt_point p)
{
    uint32_t i = 0;
    while (i < in->n && (in->p[i].x != p.x || in->p[i].y != p.y))
        i++;
    return i < in->n;
}

static void make_input(struct input *in, const struct family *f, uint32_t n, int kind)
{
    struct dt_point p[MOST];
    family_points(f, p, n, test_random());
    in->n = 0;
    in->constraints = 0;
    for (uint32_t i = 0; i < n; i++)
        if (!has_place(in, p[i])) {
            in->p[in->n] = p[i];
            in->z[in->n++] = value_of(p[i], kind);
        }
}

/* Constraints that cross no others where no point is. */
static void constrain(struct input *in, uint32_t tries)
{
    struct dt *t = set_of(in->p, in->n);
    for (uint32_t i = 0; in->n > 1 && i < tries; i++) {
        struct dt_constraint c = {test_below(in->n), test_below(in->n), false, 0};
        uint32_t missing;
        size_t added = 0;
        if (c.a != c.b && dt_constrain(t, &c, 1, NULL, &added, &missing) == DT_OK && added == 1)
            in->c[in->constraints++] = c;
    }
    dt_free(t);
}

/* ---- what must stay ---- */

static bool is_inside_constraint(const struct input *in, const struct dt_constraint *c, uint32_t i)
{
    struct dt_point a = in->p[c->a], b = in->p[c->b], q = in->p[i];
    return dt_orient2d(a, b, q) == 0 && dt_compare_xy(a, q) == dt_compare_xy(q, b) &&
           dt_compare_xy(a, q) != 0;
}

/* Whether constraints cross at the point. */
static bool is_crossing(const struct input *in, uint32_t i)
{
    for (size_t a = 0; a < in->constraints; a++)
        for (size_t b = 0; b < a; b++) {
            const struct dt_constraint *c = &in->c[a], *d = &in->c[b];
            if (is_inside_constraint(in, c, i) && is_inside_constraint(in, d, i) &&
                dt_orient2d(in->p[c->a], in->p[c->b], in->p[d->a]) != 0)
                return true;
        }
    return false;
}

/* Adds the corners of the hull of points[n], which have these numbers. */
static void mark_corners(const struct dt_point *point, const uint32_t *number, uint32_t n,
                         bool *stays)
{
    struct dt *t = set_of(point, n);
    struct dt_cursor c;
    uint32_t hull[MOST + 8];
    size_t rows, words;
    CHECK(dt_table_begin(t, NULL, DT_HULL, false, &c) == DT_OK);
    CHECK(dt_table_read(t, &c, hull, MOST + 8, MOST, &rows, &words) == DT_OK);
    for (size_t i = 0; i < rows; i++) {
        struct dt_point at = point[hull[i]], before = point[hull[(i + rows - 1) % rows]];
        struct dt_point after = point[hull[(i + 1) % rows]];
        if (rows < 3 || dt_orient2d(before, at, after) != 0 ||
            (dt_compare_xy(at, before) > 0) == (dt_compare_xy(at, after) > 0))
            stays[number[hull[i]]] = true;
    }
    dt_free(t);
}

static uint32_t first_points(const struct input *in, uint32_t *kept)
{
    bool stays[MOST] = {false};
    struct dt_point point[MOST];
    uint32_t number[MOST], n = 0, k = 0;
    for (size_t i = 0; i < in->constraints; i++)
        stays[in->c[i].a] = stays[in->c[i].b] = true;
    for (uint32_t i = 0; i < in->n; i++)
        if (stays[i] || !isnan(in->z[i])) {
            point[n] = in->p[i];
            number[n++] = i;
        }
    mark_corners(point, number, n, stays);
    for (uint32_t i = 0; i < in->n; i++)
        if (stays[i] || is_crossing(in, i))
            kept[k++] = i;
    return k;
}

static void compare(const struct input *in, double bound, uint32_t more)
{
    uint32_t kept[MOST], least = first_points(in, kept);
    uint32_t most = more > MOST - least ? UINT32_MAX : least + more;
    double error;
    uint32_t n = thin_out(in, kept, least, bound, most, &error);
    struct dt_thinned got = thinned(in, bound, most);
    CHECK_MSG(got.least == least, "%u points stay instead of %u", got.least, least);
    CHECK_MSG(got.n == n && memcmp(got.kept, kept, n * sizeof *kept) == 0,
              "%u points instead of %u, bound %.17g", got.n, n, bound);
    CHECK_MSG(got.error == error, "error %.17g instead of %.17g, bound %.17g", got.error, error,
              bound);
    dt_pages_release(got.kept);
}

enum { KINDS = 7 };

static void compare_all(const struct family *f, uint32_t n, int kind)
{
    struct input in;
    make_input(&in, f, n, kind);
    for (int constrained = 0; constrained < 2; constrained++) {
        double some = fabs(in.n > 0 && !isnan(in.z[0]) ? in.z[0] : 1);
        compare(&in, 0, MOST);
        compare(&in, some * (double)(test_random() % 100) / 100, MOST);
        compare(&in, some / 8, (uint32_t)(test_random() % 10));
        constrain(&in, 1 + (uint32_t)(test_random() % 8));
    }
}

TEST_TIMEOUT(the_points_that_are_kept_are_those_of_the_definition_on_every_family, 120)
{
    static const uint32_t sizes[] = {0, 1, 2, 3, 4, 6, 9, 30};
    for (const struct family *f = families; f->name != NULL; f++)
        for (int kind = 0; kind < KINDS; kind++)
            for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
                compare_all(f, sizes[i], kind);
}

static void shuffle(struct input *to, const struct input *in)
{
    uint32_t number[MOST];
    *to = *in;
    for (uint32_t i = 0; i < in->n; i++) {
        uint32_t k = (uint32_t)(test_random() % (i + 1));
        if (i > 0)
            number[i] = number[k];
        number[k] = i;
    }
    for (uint32_t i = 0; i < in->n; i++) {
        to->p[number[i]] = in->p[i];
        to->z[number[i]] = in->z[i];
    }
    for (size_t i = 0; i < in->constraints; i++)
        to->c[in->constraints - 1 - i] =
            (struct dt_constraint){number[in->c[i].b], number[in->c[i].a], false, 0};
}

TEST(the_order_of_points_and_constraints_does_not_matter)
{
    for (const struct family *f = families; f->name != NULL; f++) {
        struct input in, other;
        make_input(&in, f, 60, (int)(test_random() % KINDS));
        constrain(&in, 6);
        shuffle(&other, &in);
        double bound = (double)(test_random() % 3);
        struct dt_thinned a = thinned(&in, bound, UINT32_MAX);
        struct dt_thinned b = thinned(&other, bound, UINT32_MAX);
        CHECK(a.n == b.n && a.error == b.error);
        for (uint32_t i = 0; i < a.n; i++) {
            bool there = false;
            for (uint32_t k = 0; k < b.n; k++)
                there = there || dt_compare_xy(in.p[a.kept[i]], other.p[b.kept[k]]) == 0;
            CHECK(there);
        }
        dt_pages_release(a.kept);
        dt_pages_release(b.kept);
    }
}

/* ---- named cases ---- */

TEST(a_point_that_is_off_by_exactly_the_error_is_not_kept)
{
    struct input in = {.p = {{0, 0}, {4, 0}, {0, 4}, {1, 1}}, .z = {0, 0, 0, 0.1}, .n = 4};
    struct dt_thinned at = thinned(&in, 0.1, 9), below = thinned(&in, nextafter(0.1, 0), 9);
    CHECK(at.n == 3 && at.error == 0.1);
    CHECK(below.n == 4 && below.error == 0);
    dt_pages_release(at.kept);
    dt_pages_release(below.kept);
}

TEST(a_third_of_a_value_is_compared_exactly)
{
    /* 1/3 is above the double 1/3, by less than rounding shows. */
    struct input in = {.p = {{0, 0}, {3, 0}, {0, 3}, {1, 1}}, .z = {1, 0, 0, 0}, .n = 4};
    struct dt_thinned out = thinned(&in, 1. / 3, 9), more = thinned(&in, nextafter(1. / 3, 1), 9);
    CHECK(out.n == 4 && more.n == 3 && more.error <= nextafter(1. / 3, 1));
    dt_pages_release(out.kept);
    dt_pages_release(more.kept);
}

TEST(a_point_in_a_triangle_with_a_corner_without_a_value_is_kept)
{
    struct input in = {.p = {{0, 0}, {4, 0}, {0, 4}, {1, 1}, {1, 2}, {8, 8}},
                       .z = {0, (double)NAN, 0, 0, 0, (double)NAN},
                       .n = 6,
                       .c = {{0, 1, false, 0}},
                       .constraints = 1};
    struct dt_thinned out = thinned(&in, 100, 9);
    CHECK(out.n == 5 && out.kept[1] == 1 && out.kept[4] == 4 && out.error == 0);
    dt_pages_release(out.kept);
    out = thinned(&in, 100, 3);
    CHECK(out.n == 3 && out.error == HUGE_VAL);
    dt_pages_release(out.kept);
}

TEST(the_point_where_constraints_cross_stays)
{
    struct input in = {.p = {{0, 0}, {4, 4}, {0, 4}, {4, 0}, {2, 2}, {2, 1}},
                       .z = {0, 0, 0, 0, 0, 0},
                       .n = 6,
                       .c = {{0, 1, false, 0}, {2, 3, false, 0}},
                       .constraints = 2};
    struct dt_thinned out = thinned(&in, 1, 9);
    CHECK(out.n == 5 && out.kept[4] == 4);
    dt_pages_release(out.kept);
}

TEST(constraints_that_cross_where_no_point_is_are_refused)
{
    const struct dt_point p[] = {{0, 0}, {4, 4}, {0, 4}, {4, 0}, {2, 1}};
    const double z[5] = {0};
    const struct dt_constraint c[] = {{0, 1, false, 0}, {2, 3, false, 0}};
    struct dt_thinning in = {p, z, 5, c, 2, 1, 9, NULL, NULL, NULL};
    struct dt_thinned out;
    CHECK(dt_thin(&in, NULL, &out) == DT_CROSSES && out.kept == NULL);
}

TEST(fewer_points_than_must_stay_are_refused)
{
    struct input in = {.p = {{0, 0}, {4, 0}, {0, 4}, {1, 1}}, .z = {0, 0, 0, 5}, .n = 4};
    struct dt_thinning t = {in.p, in.z, in.n, NULL, 0, 1, 2, NULL, NULL, NULL};
    struct dt_thinned out;
    CHECK(dt_thin(&t, NULL, &out) == DT_TOOBIG && out.least == 3 && out.kept == NULL);
    out = thinned(&in, 1, 3);
    CHECK(out.n == 3 && out.error == 5);
    dt_pages_release(out.kept);
}
