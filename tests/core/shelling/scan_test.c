/* scan_test.c - the two scans: decisions of the first one are correct, and the second one is
 * exact. */
#include "core/shelling/scan.h"

#include <math.h>

#include "core/exact/predicates.h"
#include "tests/oracle/definition.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { POINTS = 60 };

static struct dt_point in[POINTS], xy[POINTS];
static uint32_t from[POINTS];

static struct dt_scan scan_of(const struct dt_grid *g, uint32_t a, uint32_t b)
{
    struct dt_point d = {xy[b].x - xy[a].x, xy[b].y - xy[a].y};
    struct dt_scan q = {.grid = g, .a = a, .b = b};
    q.edge = (struct dt_edge){xy[a], xy[b], d, hypot(d.x, d.y), fabs(d.x) + fabs(d.y)};
    return q;
}

/* A bound for points i..end-1. */
static double reach_of(const struct dt_scan *q, uint32_t i, uint32_t end)
{
    double r = 0;
    for (; i < end; i++)
        r = fmax(r, fmax(fmax(fabs(xy[i].x - q->edge.a.x), fabs(xy[i].y - q->edge.a.y)),
                         fmax(fabs(xy[i].x - q->edge.b.x), fabs(xy[i].y - q->edge.b.y))));
    return r * (1 + 0x1p-40);
}

/* Scans all points in runs of random length, so with several bounds. */
static void scan_all(struct dt_scan *q, bool exact)
{
    dt_scan_begin(q, exact);
    for (uint32_t i = 0, end; i < q->grid->n; i = end) {
        end = i + 1 + test_below(9);
        end = end > q->grid->n ? q->grid->n : end;
        dt_scan_run(q, reach_of(q, i, end), i, end);
    }
}

static uint32_t slow_best(const struct dt_grid *g, uint32_t a, uint32_t b)
{
    uint32_t best = DT_NONE;
    for (uint32_t c = 0; c < g->n; c++)
        if (!dt_grid_removed(g, c) && dt_orient2d(xy[a], xy[b], xy[c]) > 0 &&
            (best == DT_NONE || dt_incircle_perturbed(xy[a], xy[b], xy[best], xy[c]) > 0))
            best = c;
    return best;
}

static unsigned sure, unsure;

static void check_edge(const struct dt_grid *g, uint32_t a, uint32_t b, const char *name)
{
    struct dt_scan q = scan_of(g, a, b);
    uint32_t best = slow_best(g, a, b);
    scan_all(&q, false);
    if (dt_scan_is_certain(&q)) {
        CHECK_MSG(dt_scan_best(&q) == best, "%s, first scan", name);
        CHECK((dt_scan_bound(&q) == HUGE_VAL) == (best == DT_NONE));
        sure++;
    } else {
        unsure++;
    }
    scan_all(&q, true);
    CHECK_MSG(dt_scan_best(&q) == best && dt_scan_is_certain(&q), "%s, exact scan", name);
}

static void check_family(const struct family *f)
{
    struct dt_grid g = {.n = 0};
    family_points(f, in, POINTS, test_random());
    uint32_t n = keep_distinct(in, POINTS);
    CHECK(dt_grid_build(&g, in, n, xy, from) == DT_OK);
    for (unsigned i = 0; i < 200 && n > 2; i++) {
        uint32_t a = test_below(n), b = test_below(n);
        if (a != b)
            check_edge(&g, a, b, f->name);
    }
    dt_grid_clear(&g);
}

TEST(scans_find_the_best_point_or_are_not_certain)
{
    for (const struct family *f = families; f->name != NULL; f++)
        check_family(f);
}

TEST(the_first_scan_is_certain_on_random_points_and_not_on_ties)
{
    sure = unsure = 0;
    check_family(family_find("uniform"));
    CHECK(sure > 100 && unsure == 0);
    check_family(family_find("circle_exact"));
    CHECK(unsure > 50);
}

TEST(scans_pass_over_removed_points)
{
    struct dt_grid g = {.n = 0};
    family_points(family_find("uniform"), in, POINTS, test_random());
    CHECK(dt_grid_build(&g, in, POINTS, xy, from) == DT_OK);
    for (uint32_t k = 2; k < POINTS; k++) {
        check_edge(&g, 0, 1, "removed");
        dt_grid_remove(&g, k);
    }
    check_edge(&g, 0, 1, "removed");
    CHECK(slow_best(&g, 0, 1) == DT_NONE);
    dt_grid_clear(&g);
}
