/* merge.c - the merge of two triangulations along a line, on triangles with ghosts [Guibas & Stolfi
 * 1985, sec. 9, who do it on edges].
 *
 * Let L lie left of R. The merge starts at the lower common tangent l-r, whose ghost is `bot`, and
 * rises like a bubble:
 *
 *        top ghost
 *       - - - - - -
 *      .           .         u = the next hull vertex above l in L, by the ghost lc (u, l, none)
 *      u    gap    v         v = the next one above r in R, by the ghost rc (r, v, none)
 *     /|           |\
 *    x | lc     rc | x       Each of u and v is wanted only above the base l-r; and while the
 *     \|           |/        triangle beyond its edge has its apex x inside the circle l r u (or
 *      l --------- r         l r v), that edge has to go: it is DELETED. Then the better one of u
 *          base              and v is KNITTED to the base.
 *        bot ghost
 *
 * Both moves happen in place. Deleting the edge l-u between the ghost lc and the triangle
 * t = (l, u, x) leaves two ghosts in the same two records:
 *
 *          u                   u            lc: (u, l, none)  ->  (x, l, none)
 *         /|                  /             t:  (l, u, x)     ->  (u, x, none)
 *        x | lc      ->      x
 *         \|                  \             and u becomes x, to be tested again.
 *          l                   l
 *
 * Knitting u to the base turns the ghost lc into a real triangle by one store, (u, l, none) ->
 * (u, l, r), whose new edge u-r is the next base. At the upper tangent, a last ghost closes the
 * hull. So exactly two records are added: bot and top.
 *
 * Predicates. The candidates of one base l-r are compared by the in-circle test of (l, r, u, x),
 * whose determinant in coordinates relative to l and r is
 *
 *     det(u, x) = dt(u) cr(x) - dt(x) cr(u),  cr(c) = (r - l) x (c - l),  dt(c) = (c - l).(c - r)
 *
 * cr(c) is the orientation of l, r, c as well, and cr and dt are computed once per candidate: half
 * the work of testing anew. (cr / dt is the tangent of the angle at which c sees l-r; the test
 * compares these angles.)
 *
 * Filter. Let D be the longer side of the box of both parts and u = 2^-53. All differences of
 * coordinates are at most D with a relative error of u, so each product of two carries an error of
 * at most 3 u D^2 (+ O(u^2)), and with the final rounding
 *
 *     |err cr| <= 2 * 3 u D^2 + 2 u D^2 = 8 u D^2 < 8.9e-16 D^2,    |err dt| the same.
 *
 * With |cr| <= D^2 (twice the area of a triangle in a square) and |dt| <= 2 D^2
 *
 *     |err det| <= 2 (2 * 8 u + 8 u + 2 u) D^4 + 4 u D^4 = 56 u D^4 < 6.3e-15 D^4.
 *
 * The bounds used are 1e-15 D^2 and 1e-14 D^4, which leaves room for the rounding of D itself.
 * Undecided signs go to the exact predicates. No product under- or overflows for the coordinates
 * that dt_coordinate_ok accepts. */
#include "core/merge.h"

#include <math.h>

#include "core/knit.h"
#include "core/predicates.h"

/* A candidate to be joined to the base. */
struct candidate {
    uint32_t v;
    struct dt_point p;
    double cr, dt;
    bool above; /* the base */
};

/* The ghosts of the hull form a ring: the one that ends where g starts, and the one that starts
 * where it ends. */
INLINE size_t ghost_before(const struct knitting *w, size_t g)
{
    return knit_twin(w, g + 2) - 1;
}

INLINE size_t ghost_after(const struct knitting *w, size_t g)
{
    return knit_twin(w, g + 1) - 2;
}

/* The ghost that starts at hull vertex v; some ghost of the same hull helps if leaving[v] is out of
 * date. */
INLINE size_t ghost_from(const struct knitting *w, uint32_t v, size_t some)
{
    size_t g = w->leaving[v];
    if (__builtin_expect(w->half[g] == v && w->half[g + 2] == DT_NONE, 1))
        return g;
    for (g = some; w->half[g] != v;)
        g = ghost_before(w, g);
    return g;
}

INLINE bool below(const struct knitting *w, struct dt_point l, struct dt_point r, struct dt_point c)
{
    double cr = (r.x - l.x) * (c.y - l.y) - (r.y - l.y) * (c.x - l.x);
    if (cr > w->cr_bound)
        return false;
    return cr < -w->cr_bound || dt_orient2d(l, r, c) < 0;
}

INLINE struct candidate look_at(const struct knitting *w, struct dt_point l, struct dt_point r,
                                uint32_t v)
{
    struct candidate c = {.v = v, .p = w->p[v]};
    double ux = c.p.x - l.x, uy = c.p.y - l.y;
    c.cr = (r.x - l.x) * uy - (r.y - l.y) * ux;
    c.dt = ux * (c.p.x - r.x) + uy * (c.p.y - r.y);
    return c;
}

INLINE bool is_above(const struct knitting *w, struct dt_point l, struct dt_point r,
                     const struct candidate *c)
{
    if (__builtin_expect(fabs(c->cr) <= w->cr_bound, 0))
        return dt_orient2d(l, r, c->p) > 0;
    return c->cr > 0;
}

/* Whether x lies in the circle of l, r and c. */
INLINE bool in_circle(const struct knitting *w, struct dt_point l, struct dt_point r,
                      const struct candidate *c, const struct candidate *x)
{
    double det = c->dt * x->cr - x->dt * c->cr;
    if (__builtin_expect(fabs(det) <= w->det_bound, 0))
        return dt_incircle_perturbed(l, r, c->p, x->p) > 0;
    return det > 0;
}

/* Deletes edges l-u of L, beyond the ghost lc, as long as the next neighbour of l is a better
 * candidate; returns that. */
INLINE struct candidate clear_left(const struct knitting *w, struct dt_point l, struct dt_point r,
                                   size_t lc, struct candidate u)
{
    uint32_t edge = (uint32_t)knit_twin(w, lc); /* l->u, in the triangle (l, u, x) */
    for (;;) {
        size_t t = dt_base(edge), side = dt_prev(edge), top = dt_next(edge);
        if (w->half[side] == DT_NONE)
            return u;
        struct candidate x = look_at(w, l, r, w->half[side]);
        if (!in_circle(w, l, r, &u, &x))
            return u;
        size_t beyond_top = knit_twin(w, top), beyond_side = knit_twin(w, side),
               out = knit_twin(w, lc + 2);
        w->half[lc] = x.v;
        knit_link(w, lc, beyond_side);
        knit_ghost(w, t, u.v, x.v);
        knit_link(w, t, beyond_top);
        knit_link(w, t + 1, lc + 2);
        knit_link(w, t + 2, out);
        w->leaving[x.v] = (uint32_t)lc;
        u = x;
        edge = (uint32_t)beyond_side;
    }
}

/* The mirror image: edges r-v of R, beyond the ghost rc. */
INLINE struct candidate clear_right(const struct knitting *w, struct dt_point l, struct dt_point r,
                                    size_t rc, struct candidate v)
{
    uint32_t edge = (uint32_t)knit_twin(w, rc); /* v->r, in the triangle (v, r, x) */
    for (;;) {
        size_t t = dt_base(edge), top = dt_prev(edge), side = dt_next(edge);
        if (w->half[top] == DT_NONE)
            return v;
        struct candidate x = look_at(w, l, r, w->half[top]);
        if (!in_circle(w, l, r, &v, &x))
            return v;
        size_t beyond_side = knit_twin(w, side), beyond_top = knit_twin(w, top),
               out = knit_twin(w, rc + 1);
        w->half[rc + 1] = x.v;
        knit_link(w, rc, beyond_side);
        knit_ghost(w, t, x.v, v.v);
        knit_link(w, t, beyond_top);
        knit_link(w, t + 1, out);
        knit_link(w, t + 2, rc + 1);
        w->leaving[v.v] = (uint32_t)out - 2;
        v = x;
        edge = (uint32_t)beyond_side;
    }
}

/* Finds the lower common tangent: moves *l and *r down their hulls, with gl the ghost that starts
 * at l and gr the one that ends at r. */
INLINE void descend(const struct knitting *w, bool left_single, bool right_single, uint32_t *l,
                    uint32_t *r, size_t *gl, size_t *gr)
{
    struct dt_point pl = w->p[*l], pr = w->p[*r];
    bool moved;
    do {
        moved = false;
        if (!left_single && below(w, pl, pr, w->p[w->half[*gl + 1]])) {
            *l = w->half[*gl + 1];
            pl = w->p[*l];
            *gl = ghost_after(w, *gl);
            moved = true;
        }
        if (!right_single && below(w, pl, pr, w->p[w->half[*gr]])) {
            *r = w->half[*gr];
            pr = w->p[*r];
            *gr = ghost_before(w, *gr);
            moved = true;
        }
    } while (moved);
}

/* The merge proper; l and r are the last vertex of the left part and the first one of the right.
 * Single points have no ghosts. */
INLINE void knit(const struct knitting *w, bool left_single, bool right_single, uint32_t l,
                 uint32_t r, size_t some_l, size_t some_r, size_t bot, size_t top)
{
    size_t gl = left_single ? 0 : ghost_from(w, l, some_l);
    size_t gr = right_single ? 0 : ghost_before(w, ghost_from(w, r, some_r));
    descend(w, left_single, right_single, &l, &r, &gl, &gr);
    size_t lc = left_single ? 0 : ghost_before(w, gl);
    size_t rc = right_single ? 0 : ghost_after(w, gr);

    knit_ghost(w, bot, r, l);
    if (!left_single) {
        knit_link(w, bot + 1, gl + 2);
        w->leaving[l] = (uint32_t)gl;
    }
    if (!right_single)
        knit_link(w, bot + 2, gr + 1);

    size_t base = bot; /* the half edge r->l below the gap */
    struct dt_point pl = w->p[l], pr = w->p[r];
    for (;;) {
        struct candidate u = {0}, v = {0};
        if (!left_single) {
            u = look_at(w, pl, pr, w->half[lc]);
            u.above = is_above(w, pl, pr, &u);
        }
        if (!right_single) {
            v = look_at(w, pl, pr, w->half[rc + 1]);
            v.above = is_above(w, pl, pr, &v);
        }
        bool take_left = u.above, take_right = v.above;
        if (take_left)
            u = clear_left(w, pl, pr, lc, u);
        if (take_right)
            v = clear_right(w, pl, pr, rc, v);
        if (take_left && take_right)
            take_left = !in_circle(w, pl, pr, &u, &v);
        else if (!take_left && !take_right)
            break;
        if (take_left) {
            size_t next = ghost_before(w, lc);
            w->half[lc + 2] = r;
            knit_link(w, lc + 1, base);
            base = lc + 2;
            w->leaving[u.v] = (uint32_t)lc;
            l = u.v;
            pl = u.p;
            lc = next;
        } else {
            size_t next = ghost_after(w, rc);
            w->half[rc + 2] = l;
            knit_link(w, rc + 2, base);
            base = rc + 1;
            w->leaving[v.v] = (uint32_t)next;
            r = v.v;
            pr = v.p;
            rc = next;
        }
    }
    knit_ghost(w, top, l, r);
    knit_link(w, top, base);
    knit_link(w, top + 1, right_single ? bot + 2 : rc + 2);
    knit_link(w, top + 2, left_single ? bot + 1 : lc + 1);
}

/* The common case and the others, each compiled on its own with its conditions decided. */
static __attribute__((noinline)) void knit_many(const struct knitting *w, uint32_t l, uint32_t r,
                                                uint32_t some_l, uint32_t some_r, uint32_t bot,
                                                uint32_t top)
{
    const struct knitting local = *w;
    knit(&local, false, false, l, r, some_l, some_r, bot, top);
}

static __attribute__((noinline)) void knit_single(const struct knitting *w, bool left_single,
                                                  bool right_single, uint32_t l, uint32_t r,
                                                  uint32_t some_l, uint32_t some_r, uint32_t bot,
                                                  uint32_t top)
{
    const struct knitting local = *w;
    if (left_single && right_single)
        knit(&local, true, true, l, r, some_l, some_r, bot, top);
    else if (left_single)
        knit(&local, true, false, l, r, some_l, some_r, bot, top);
    else
        knit(&local, false, true, l, r, some_l, some_r, bot, top);
}

void dt_knit(const struct knitting *w, uint32_t l, uint32_t r, uint32_t nl, uint32_t nr,
             uint32_t some_l, uint32_t some_r, uint32_t mid)
{
    uint32_t bot = 16 * mid - 16, top = 16 * mid - 8;
    if (__builtin_expect(nl > 1 && nr > 1, 1))
        knit_many(w, l, r, some_l, some_r, bot, top);
    else
        knit_single(w, nl == 1, nr == 1, l, r, some_l, some_r, bot, top);
}

struct dt_part dt_merge_parts(const struct dt_merging *w, const struct dt_part *a,
                              const struct dt_part *b, unsigned axis, uint32_t mid)
{
    const struct dt_point *p = w->p;
    if (a->n == 0)
        return *b;
    if (b->n == 0)
        return *a;
    struct dt_part c = {
        .n = a->n + b->n,
        .left = dt_before_x(p[b->left], p[a->left]) ? b->left : a->left,
        .right = dt_before_x(p[a->right], p[b->right]) ? b->right : a->right,
        .bottom = dt_before_y(p[b->bottom], p[a->bottom]) ? b->bottom : a->bottom,
        .top = dt_before_y(p[a->top], p[b->top]) ? b->top : a->top,
        .ghost = 16 * mid - 8,
    };
    double width = p[c.right].x - p[c.left].x, height = p[c.top].y - p[c.bottom].y;
    struct knitting k = knitting_of(w, width > height ? width : height);
    if (axis == 0)
        dt_knit(&k, a->right, b->left, a->n, b->n, a->ghost, b->ghost, mid);
    else
        dt_knit(&k, a->top, b->bottom, a->n, b->n, a->ghost, b->ghost, mid);
    return c;
}
