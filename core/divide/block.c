/* block.c - blocks of up to six points, triangulated by halves (merge.c), down to an edge between two ghosts
 * or a triangle.
 *
 * The number of points of a block is unpredictable, so the work on n points is compiled for every n, with loops
 * of constant length.
 *
 * Tried and left out: four points at once, by a table of the twenty cases of five signs.
 * It gained nothing on uniform points and lost 15 % on lattices. */
#include "core/divide/part.h"

#include "core/exact/predicates.h"

/* Two points: one edge, a ghost on either side. Returns a ghost, as do the next ones. */
static uint32_t base_of_two(const struct dt_merging *w, uint32_t a)
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
static void close_ring(const struct dt_merging *w, const uint32_t *g, unsigned n)
{
    for (unsigned i = 0; i < n; i++)
        knit_link(w, g[i] + 2, g[(i + 1) % n] + 1);
}

/* Three points: a triangle and three ghosts, or a line with four. */
static uint32_t base_of_three(const struct dt_merging *w, uint32_t lo)
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

INLINE uint32_t base_of(const struct dt_merging *w, uint32_t lo, const uint32_t n)
{
    return n == 2 ? base_of_two(w, lo) : n == 3 ? base_of_three(w, lo) : 0;
}

/* Triangulates sorted points; returns a ghost of their triangulation. */
INLINE uint32_t triangulate(const struct dt_merging *w, uint32_t lo, const uint32_t n, bool *close)
{
    const uint32_t half = n / 2, mid = lo + half;
    if (n <= 3)
        return base_of(w, lo, n);
    uint32_t some_l = base_of(w, lo, half), some_r = base_of(w, mid, n - half);
    *close = dt_knit(w, false, mid - 1, mid, half, n - half, some_l, some_r, mid);
    return 16 * mid - 8;
}

INLINE struct dt_part block_of(const struct dt_merging *w, uint32_t lo, const uint32_t n)
{
    const struct dt_point *p = w->p;
    struct dt_part c = {.n = n, .left = lo, .right = lo + n - 1, .bottom = lo, .top = lo};
    for (uint32_t v = lo + 1; v < lo + n; v++) {
        c.bottom = dt_before_y(p[v], p[c.bottom]) ? v : c.bottom;
        c.top = dt_before_y(p[c.top], p[v]) ? v : c.top;
    }
    double width = p[c.right].x - p[c.left].x, height = p[c.top].y - p[c.bottom].y;
    struct dt_merging k = dt_merging_within(w, width > height ? width : height);
    c.ghost = triangulate(&k, lo, n, &c.close);
    return c;
}

struct dt_part dt_block(const struct dt_merging *w, uint32_t lo, uint32_t n)
{
    switch (n) {
    case 1:
        return block_of(w, lo, 1);
    case 2:
        return block_of(w, lo, 2);
    case 3:
        return block_of(w, lo, 3);
    case 4:
        return block_of(w, lo, 4);
    case 5:
        return block_of(w, lo, 5);
    default:
        return block_of(w, lo, DT_BLOCK);
    }
}
