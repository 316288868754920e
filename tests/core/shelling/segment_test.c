/* segment_test.c - segments hold what they should, and the cells they touch hold the segments. */
#include "core/shelling/segment.h"

#include <math.h>

#include "core/exact/predicates.h"
#include "core/shelling/scan.h"
#include "tests/oracle/definition.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { POINTS = 300 };

static struct dt_point in[POINTS], xy[POINTS];
static uint32_t from[POINTS];

static struct dt_edge edge_of(struct dt_point a, struct dt_point b)
{
    struct dt_point d = {b.x - a.x, b.y - a.y};
    return (struct dt_edge){a, b, d, sqrt(d.x * d.x + d.y * d.y), fabs(d.x) + fabs(d.y)};
}

/* The cell of p is in the window of the segment, in c or in the cells inside. */
static bool is_covered(const struct dt_edge *e, const struct dt_segment *g,
                       const struct dt_cells *c, uint32_t place)
{
    struct dt_window w;
    uint32_t cell = dt_cells_index(c, xy[place]), line = cell / c->length, first, last;
    if (!dt_window_set(&w, e, g, c) || line < w.first_line || line > w.last_line)
        return false;
    if (!dt_window_line(&w, line, &first, &last) || cell % c->length < first ||
        cell % c->length > last)
        return false;
    double reach = dt_segment_reach(e, g, c);
    CHECK(fabs(xy[place].x - e->a.x) <= reach && fabs(xy[place].y - e->a.y) <= reach);
    CHECK(fabs(xy[place].x - e->b.x) <= reach && fabs(xy[place].y - e->b.y) <= reach);
    uint32_t k = dt_cells_first_sub(c, cell);
    return k == c->subs || c->sub_cell[k] != cell || is_covered(e, g, &c->sub[k], place);
}

/* Returns the cotangent at p as a search computes it. */
static double cotangent_bound(const struct dt_grid *g, uint32_t a, uint32_t b, uint32_t p)
{
    struct dt_scan q = {.grid = g, .a = a, .b = b, .edge = edge_of(xy[a], xy[b])};
    double x = fmax(fabs(xy[p].x - xy[a].x), fabs(xy[p].x - xy[b].x));
    double y = fmax(fabs(xy[p].y - xy[a].y), fabs(xy[p].y - xy[b].y));
    dt_scan_begin(&q, true);
    dt_scan_run(&q, fmax(x, y) * (1 + 0x1p-50), p, p + 1);
    return dt_scan_bound(&q);
}

/* The segment of p, and those that are larger by a little or much, cover all points that belong to it. These are the
 * points inside the circle through a, b and p on the left of the edge. */
static void check_segment(const struct dt_grid *g, uint32_t a, uint32_t b, uint32_t p, double s,
                          const char *name)
{
    struct dt_edge e = edge_of(xy[a], xy[b]);
    struct dt_segment of_cotangent = dt_segment_of_cotangent(&e, s);
    struct dt_segment of_height = dt_segment_of_height(&e, of_cotangent.height * (1 + 0x1p-30));
    struct dt_segment all = dt_segment_all(&e);
    for (uint32_t i = 0; i < g->n; i++) {
        if (dt_orient2d(xy[a], xy[b], xy[i]) <= 0)
            continue;
        CHECK_MSG(is_covered(&e, &all, &g->top, i), "%s, half plane", name);
        if (i != p && dt_incircle(xy[a], xy[b], xy[p], xy[i]) <= 0)
            continue;
        CHECK_MSG(is_covered(&e, &of_cotangent, &g->top, i), "%s, s = %g", name, s);
        CHECK_MSG(is_covered(&e, &of_height, &g->top, i), "%s, height of s = %g", name, s);
    }
}

TEST(the_cells_of_a_segment_hold_all_its_points)
{
    for (const struct family *f = families; f->name != NULL; f++) {
        struct dt_grid g = {.n = 0};
        family_points(f, in, POINTS, test_random());
        uint32_t n = keep_distinct(in, POINTS);
        CHECK(dt_grid_build(&g, in, n, xy, from) == DT_OK);
        for (unsigned i = 0; i < 60; i++) {
            uint32_t a = test_below(n), b = test_below(n), p = test_below(n);
            if (a == b || dt_orient2d(xy[a], xy[b], xy[p]) <= 0)
                continue;
            double s = cotangent_bound(&g, a, b, p);
            if (s < 0x1p60)
                check_segment(&g, a, b, p, s, f->name);
        }
        dt_grid_clear(&g);
    }
}

TEST(the_box_of_a_segment_is_tight)
{
    struct dt_edge e = edge_of((struct dt_point){0, 0}, (struct dt_point){2, 0});
    struct dt_segment half_circle = dt_segment_of_cotangent(&e, 0);
    CHECK(fabs(half_circle.box.lo.x) < 1e-9 && fabs(half_circle.box.hi.x - 2) < 1e-9);
    CHECK(fabs(half_circle.box.lo.y) < 1e-9 && fabs(half_circle.box.hi.y - 1) < 1e-9);
    CHECK(fabs(half_circle.height - 1) < 1e-9);
    struct dt_segment flat = dt_segment_of_height(&e, 0.5); /* a circle of radius 1.25 */
    CHECK(fabs(flat.s - -0.75) < 1e-9 && fabs(flat.box.hi.y - 0.5) < 1e-9 &&
          fabs(flat.box.hi.x - 2) < 1e-9);
    struct dt_segment large = dt_segment_of_height(&e, 2); /* also of radius 1.25 */
    CHECK(fabs(large.s - 0.75) < 1e-9 && fabs(large.box.hi.y - 2) < 1e-9 &&
          fabs(large.box.hi.x - 2.25) < 1e-9);
    CHECK(fabs(large.box.lo.x - -0.25) < 1e-9 && fabs(large.box.lo.y) < 1e-9);
}
