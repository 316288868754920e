/* voronoi.c - see voronoi.h. */
#include "tests/oracle/voronoi.h"

#include "core/exact/bignum.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct dt_big num;

static num of(double v)
{
    return dt_big_of(v);
}

static num plus(num a, num b)
{
    return dt_big_add(a, b);
}

static num minus(num a, num b)
{
    return dt_big_subtract(a, b);
}

static num times(num a, num b)
{
    return dt_big_multiply(a, b);
}

static num over(num a, num b)
{
    return dt_big_divide(a, b);
}

struct place {
    num x, y;
};

static num cross(struct place a, struct place b)
{
    return minus(times(a.x, b.y), times(a.y, b.x));
}

static num dot(struct place a, struct place b)
{
    return plus(times(a.x, b.x), times(a.y, b.y));
}

static struct place less(struct place a, struct place b)
{
    return (struct place){minus(a.x, b.x), minus(a.y, b.y)};
}

/* A convex polygon, counterclockwise; side i, from corner i to the next one, was cut by the bisector of site i. */
struct polygon {
    struct place *corner; /* owns */
    uint32_t *site;       /* owns */
    uint32_t n;
};

static struct polygon polygon_new(uint32_t room)
{
    struct polygon p = {malloc(room * sizeof *p.corner), malloc(room * sizeof *p.site), 0};
    CHECK(p.corner != NULL && p.site != NULL);
    return p;
}

static void polygon_free(struct polygon *p)
{
    free(p->corner);
    free(p->site);
}

static void put(struct polygon *p, struct place corner, uint32_t site)
{
    p->corner[p->n] = corner;
    p->site[p->n++] = site;
}

/* Cuts off the part of the polygon that is closer to b, the site number `site`, than to a. */
static void clip(struct polygon *p, struct place a, struct place b, uint32_t site)
{
    struct polygon r = polygon_new(p->n + 2);
    struct place d = less(b, a);
    num half = over(minus(dot(b, b), dot(a, a)), of(2));
    num *side = malloc(p->n * sizeof *side); /* > 0: beyond the bisector */
    CHECK(side != NULL);
    for (uint32_t i = 0; i < p->n; i++)
        side[i] = minus(dot(p->corner[i], d), half);
    for (uint32_t i = 0; i < p->n; i++) {
        uint32_t next = i + 1 < p->n ? i + 1 : 0;
        struct place from = p->corner[i], along = less(p->corner[next], from);
        bool in = side[i].sign <= 0, then = side[next].sign <= 0;
        if (in)
            put(&r, from, p->site[i]);
        if (in == then)
            continue;
        num part = over(side[i], minus(side[i], side[next]));
        struct place at = {plus(from.x, times(part, along.x)), plus(from.y, times(part, along.y))};
        put(&r, at, in ? site : p->site[i]);
    }
    free(side);
    polygon_free(p);
    *p = r;
}

static num area_of(const struct polygon *p)
{
    num area = of(0);
    for (uint32_t i = 0; i < p->n; i++)
        area = plus(area, cross(p->corner[i], p->corner[i + 1 < p->n ? i + 1 : 0]));
    return area;
}

static struct place place_of(struct dt_point p, struct dt_point q)
{
    num x = of(p.x), y = of(p.y);
    return (struct place){minus(x, of(q.x)), minus(y, of(q.y))};
}

/* The cell of the origin among the sites. */
static struct polygon cell_of(const struct place *site, uint32_t n)
{
    struct polygon cell = polygon_new(4);
    num far = of(0x1p700), minus_far = of(-0x1p700);
    put(&cell, (struct place){minus_far, minus_far}, UINT32_MAX);
    put(&cell, (struct place){far, minus_far}, UINT32_MAX);
    put(&cell, (struct place){far, far}, UINT32_MAX);
    put(&cell, (struct place){minus_far, far}, UINT32_MAX);
    struct place origin = {of(0), of(0)};
    for (uint32_t i = 0; i < n; i++)
        clip(&cell, origin, site[i], i);
    return cell;
}

/* The area of the part of the cell that is nearest to site v among the sites that have a side of the cell. */
static num stolen(const struct polygon *cell, const struct place *site, uint32_t v)
{
    struct polygon p = polygon_new(cell->n);
    for (uint32_t i = 0; i < cell->n; i++)
        put(&p, cell->corner[i], cell->site[i]);
    for (uint32_t i = 0; i < cell->n && p.n > 0; i++)
        if (cell->site[i] != v)
            clip(&p, site[v], site[cell->site[i]], cell->site[i]);
    num area = area_of(&p);
    polygon_free(&p);
    return area;
}

void voronoi_weights(const struct dt_point *p, uint32_t n, struct dt_point q,
                     enum dt_interpolation how, double *weight)
{
    struct place *site = malloc(n * sizeof *site);
    num *share = calloc(n, sizeof *share), total = of(0);
    CHECK(site != NULL && share != NULL);
    for (uint32_t i = 0; i < n; i++)
        site[i] = place_of(p[i], q);
    struct polygon cell = cell_of(site, n);
    for (uint32_t i = 0; i < cell.n; i++) {
        uint32_t v = cell.site[i];
        CHECK(v != UINT32_MAX);
        struct place side = less(cell.corner[i + 1 < cell.n ? i + 1 : 0], cell.corner[i]);
        share[v] = how == DT_NATURAL ? stolen(&cell, site, v)
                                     : over(cross(site[v], side), dot(site[v], site[v]));
    }
    for (uint32_t i = 0; i < n; i++)
        total = plus(total, share[i]);
    for (uint32_t i = 0; i < n; i++) {
        num w = over(share[i], total);
        weight[i] = dt_big_to_double(w);
    }
    polygon_free(&cell);
    free(share);
    free(site);
}
