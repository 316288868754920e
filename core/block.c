/* block.c - blocks of up to six points, sorted without a branch and triangulated by case.
 *
 *     2 points     an edge between two ghosts
 *     3 points     a triangle, or a line
 *     4 points     one of twenty cases, known by five signs
 *     5, 6         two halves, joined (knit.h)
 *
 * Half of all the joins of a plain divide and conquer have four points or fewer, and what they cost
 * is mispredicted branches; so they are worth a table. */
#include "core/block.h"

#include <math.h>

#include "core/knit.h"
#include "core/predicates.h"

/* Every point's rank is the number of points before it: no branch depends on the coordinates. */
static void sort_by_rank(struct dt_point *p, uint32_t *from, uint32_t n)
{
    struct dt_point q[DT_BLOCK];
    uint32_t f[DT_BLOCK], rank[DT_BLOCK] = {0};
    for (uint32_t i = 0; i < n; i++) {
        q[i] = p[i];
        f[i] = from[i];
        for (uint32_t j = 0; j < i; j++) {
            uint32_t before = (q[i].x < q[j].x) | ((q[i].x == q[j].x) & (q[i].y < q[j].y));
            rank[j] += before;
            rank[i] += 1 - before;
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        p[rank[i]] = q[i];
        from[rank[i]] = f[i];
    }
}

/* Two points: one edge, a ghost on either side. Returns a ghost, as do the next ones. */
static uint32_t base_of_two(const struct knitting *w, uint32_t a)
{
    uint32_t t = 16 * a, s = t + 8, b = a + 1;
    knit_ghost(w, t, b, a);
    knit_ghost(w, s, a, b);
    knit_link(w, t, s);
    knit_link(w, t + 1, s + 2);
    knit_link(w, t + 2, s + 1);
    return t;
}

/* The ghosts g[0 .. n-1] follow one another around a hull. */
static void close_ring(const struct knitting *w, const uint32_t *g, unsigned n)
{
    for (unsigned i = 0; i < n; i++)
        knit_link(w, g[i] + 2, g[(i + 1) % n] + 1);
}

/* Three points: a triangle and three ghosts, or a line with four. */
static uint32_t base_of_three(const struct knitting *w, uint32_t lo)
{
    uint32_t a = lo, b = lo + 1, c = lo + 2, t = 16 * lo;
    uint32_t g[4] = {t + 8, t + 16, t + 24, t};
    int turn = dt_orient2d(w->p[a], w->p[b], w->p[c]);
    if (turn == 0) {
        knit_ghost(w, g[0], b, a);
        knit_ghost(w, g[1], c, b);
        knit_ghost(w, g[2], b, c);
        knit_ghost(w, g[3], a, b);
        knit_link(w, g[0], g[3]);
        knit_link(w, g[1], g[2]);
        close_ring(w, g, 4);
        return g[0];
    }
    if (turn < 0) {
        uint32_t swap = b;
        b = c;
        c = swap;
    }
    knit_triangle(w, t, a, b, c);
    knit_ghost(w, g[0], b, a);
    knit_ghost(w, g[1], c, b);
    knit_ghost(w, g[2], a, c);
    for (unsigned i = 0; i < 3; i++)
        knit_link(w, t + i, g[i]);
    close_ring(w, g, 3);
    return g[0];
}

/* ---- four points ---- */

/* How four points a, b, c, d lie, by the signs of their turns: one bit each for (a, b, c), (a, b,
 * d), (a, c, d) and (b, c, d) being positive, the first the highest. Two of the sixteen cannot
 * be. */
enum lie { IMPOSSIBLE, CONVEX, INSIDE };

static const struct four {
    uint8_t lie;
    uint8_t odd;       /* whether v is an odd permutation of a, b, c, d */
    uint8_t vertex[4]; /* CONVEX: counterclockwise; INSIDE: so the hull, then the one within */
} fours[16] = {
    {CONVEX, 1, {0, 3, 2, 1}}, {INSIDE, 0, {0, 3, 1, 2}}, {INSIDE, 0, {0, 2, 1, 3}},
    {CONVEX, 0, {0, 2, 3, 1}}, {INSIDE, 0, {1, 3, 2, 0}}, {IMPOSSIBLE, 0, {0}},
    {CONVEX, 1, {0, 2, 1, 3}}, {INSIDE, 0, {0, 2, 3, 1}}, {INSIDE, 0, {0, 3, 2, 1}},
    {CONVEX, 0, {0, 3, 1, 2}}, {IMPOSSIBLE, 0, {0}},      {INSIDE, 0, {1, 2, 3, 0}},
    {CONVEX, 1, {0, 1, 3, 2}}, {INSIDE, 0, {0, 1, 2, 3}}, {INSIDE, 0, {0, 1, 3, 2}},
    {CONVEX, 0, {0, 1, 2, 3}},
};

/* The quadrangle p q r s, cut from p to r. */
static void set_convex(const struct knitting *w, uint32_t t, uint32_t p, uint32_t q, uint32_t r,
                       uint32_t s)
{
    uint32_t u = t + 8, pq = t + 16, qr = t + 24, rs = t + 32, sp = t + 40;
    knit_triangle(w, t, p, q, r);
    knit_triangle(w, u, p, r, s);
    knit_ghost(w, pq, q, p);
    knit_ghost(w, qr, r, q);
    knit_ghost(w, rs, s, r);
    knit_ghost(w, sp, p, s);
    knit_link(w, t, pq);
    knit_link(w, t + 1, qr);
    knit_link(w, t + 2, u);
    knit_link(w, u + 1, rs);
    knit_link(w, u + 2, sp);
    knit_link(w, qr + 1, pq + 2);
    knit_link(w, rs + 1, qr + 2);
    knit_link(w, sp + 1, rs + 2);
    knit_link(w, pq + 1, sp + 2);
}

/* The triangle p q r around m. */
static void set_inside(const struct knitting *w, uint32_t t, uint32_t p, uint32_t q, uint32_t r,
                       uint32_t m)
{
    uint32_t u = t + 8, v = t + 16, pq = t + 24, qr = t + 32, rp = t + 40;
    knit_triangle(w, t, p, q, m);
    knit_triangle(w, u, q, r, m);
    knit_triangle(w, v, r, p, m);
    knit_ghost(w, pq, q, p);
    knit_ghost(w, qr, r, q);
    knit_ghost(w, rp, p, r);
    w->leaving[m] = t + 2;
    knit_link(w, t, pq);
    knit_link(w, u, qr);
    knit_link(w, v, rp);
    knit_link(w, t + 1, u + 2);
    knit_link(w, u + 1, v + 2);
    knit_link(w, v + 1, t + 2);
    knit_link(w, qr + 1, pq + 2);
    knit_link(w, rp + 1, qr + 2);
    knit_link(w, pq + 1, rp + 2);
}

/* Four points in any order: true unless a sign is uncertain. Filter: with the vectors from a, a
 * turn is a 2x2 determinant with the error of merge.c's cr, 8 u D^2; the fourth turn, a sum of
 * three of them, is off by at most 3 * 8 u D^2 + 5 u D^2. The in-circle determinant is a sum of
 * three products of a square, at most 2 D^2 and off by 8 u D^2, and a turn, at most D^2: off by
 * at most 3 (2 * 8 u + 8 u + 2 u) D^4 + 2 * 6 u D^4 = 90 u D^4. Bounds four times and twice as
 * large as those of the merge cover both. */
static bool base_of_four(const struct knitting *w, uint32_t lo)
{
    const struct dt_point *p = w->p + lo;
    double bx = p[1].x - p[0].x, by = p[1].y - p[0].y, cx = p[2].x - p[0].x, cy = p[2].y - p[0].y,
           dx = p[3].x - p[0].x, dy = p[3].y - p[0].y;
    double abc = bx * cy - by * cx, abd = bx * dy - by * dx, acd = cx * dy - cy * dx,
           bcd = abc - abd + acd;
    double circle = (cx * cx + cy * cy) * abd - (bx * bx + by * by) * acd -
                    (dx * dx + dy * dy) * abc; /* > 0: d inside, if a, b, c turn left */
    double turn = 4 * w->cr_bound, det = 2 * w->det_bound;
    if (fabs(abc) <= turn || fabs(abd) <= turn || fabs(acd) <= turn || fabs(bcd) <= turn ||
        fabs(circle) <= det)
        return false;
    const struct four *f = &fours[(abc > 0) << 3 | (abd > 0) << 2 | (acd > 0) << 1 | (bcd > 0)];
    const uint8_t *v = f->vertex;
    if (f->lie == INSIDE) {
        set_inside(w, 16 * lo, lo + v[0], lo + v[1], lo + v[2], lo + v[3]);
    } else {
        unsigned turned = (circle > 0) ^ f->odd;
        set_convex(w, 16 * lo, lo + v[turned], lo + v[1 + turned], lo + v[2 + turned],
                   lo + v[(3 + turned) & 3]);
    }
    return true;
}

static uint32_t halve(const struct knitting *w, uint32_t lo, uint32_t hi)
{
    uint32_t n = hi - lo;
    if (n == 2)
        return base_of_two(w, lo);
    if (n == 3)
        return base_of_three(w, lo);
    if (n == 1)
        return 0;
    if (n == 4 && base_of_four(w, lo))
        return 16 * lo + 40; /* a ghost in either case */
    uint32_t mid = (lo + hi) / 2;
    uint32_t some_l = halve(w, lo, mid), some_r = halve(w, mid, hi);
    dt_knit(w, mid - 1, mid, mid - lo, hi - mid, some_l, some_r, mid);
    return 16 * mid - 8;
}

struct dt_part dt_block(const struct dt_merging *w, struct dt_point *points, uint32_t *from,
                        uint32_t lo, uint32_t n)
{
    const struct dt_point *p = w->p;
    sort_by_rank(points + lo, from + lo, n);
    struct dt_part c = {.n = n, .left = lo, .right = lo + n - 1, .bottom = lo, .top = lo};
    for (uint32_t v = lo + 1; v < lo + n; v++) {
        c.bottom = dt_before_y(p[v], p[c.bottom]) ? v : c.bottom;
        c.top = dt_before_y(p[c.top], p[v]) ? v : c.top;
    }
    double width = p[c.right].x - p[c.left].x, height = p[c.top].y - p[c.bottom].y;
    struct knitting k = knitting_of(w, width > height ? width : height);
    c.ghost = halve(&k, lo, lo + n);
    return c;
}
