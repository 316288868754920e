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
 *    x | lc     rc | x       l-r = the base; x = the apex of the triangle beyond l-u, or beyond r-v
 *     \|           |/
 *      l --------- r
 *          base
 *        bot ghost
 *
 * The steps of a merge:
 *
 * 1. u and v are candidates as long as they lie above the line l-r. If neither does, l-r is the upper tangent: the end.
 * 2. If u is a candidate and x lies inside the circle l r u, the edge l-u is DELETED. x becomes u, and step 1 follows.
 *    The same for v: if x lies inside the circle l r v, the edge r-v is DELETED.
 * 3. The better candidate is KNITTED to the base: u if v is no candidate or lies outside the circle l r u, else v. The
 *    new edge u-r, or l-v, is the next base, and step 1 follows.
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
 * Predicates. Step 1 examines u and v together in two lanes, and step 2 the apexes x of both sides (sight.h, which has
 * the filters, too). A step corrects at most one edge of a side and begins again: so it has few branches, because
 * unpredictable ones are expensive. */
#include "core/divide/part.h"

#include "core/divide/sight.h"

#define FEW_DOUBTS 1            /* of a merge for which the wide filter is good enough */
#define LONG (1u << 15)         /* points beyond which a merge polls, and may end early */
#define STEPS_BETWEEN_POLLS 512 /* of a long merge: each takes up to ten microseconds */

/* One side of the gap. Beyond a line lies another ghost, which has no apex: then x is c. These are looked up when
 * the ghost changes, so that a step begins with loads of points and not with the search for them. */
struct side {
    size_t ghost; /* next to the gap: (u, l, none) or (r, v, none) */
    uint32_t c;   /* the candidate u or v */
    uint32_t x;   /* the apex beyond the edge to it */
};

/* One merge on its way up. A part of a single point has no ghosts, so its side is not used. */
struct seam {
    uint32_t l, r;        /* the base */
    struct sight_base at; /* its points */
    size_t base;          /* its half edge r->l below the gap */
    struct side left, right;
    struct sight_filter filter;
};

/* The ghosts of the hull form a ring. ghost_before returns the ghost that ends where g starts, ghost_after the ghost
 * that starts where g ends. */
INLINE size_t ghost_before(const struct dt_merging *w, size_t g)
{
    return knit_twin(w, g + 2) - 1;
}

INLINE size_t ghost_after(const struct dt_merging *w, size_t g)
{
    return knit_twin(w, g + 1) - 2;
}

/* The ghost that starts at hull vertex v; some ghost of the same hull helps if leaving[v] is out of
 * date. */
INLINE size_t ghost_from(const struct dt_merging *w, uint32_t v, size_t some)
{
    size_t g = w->leaving[v];
    if (__builtin_expect(w->half[g] == v && w->half[g + 2] == DT_NONE, 1))
        return g;
    for (g = some; w->half[g] != v;)
        g = ghost_before(w, g);
    return g;
}

/* Whether a loop continues with its next step. */
INLINE bool go_on(const struct dt_merging *w, bool polls, uint32_t *steps)
{
    return !polls || ++*steps % STEPS_BETWEEN_POLLS != 0 || !dt_stopped(w->stop);
}

/* Finds the lower common tangent: moves l and r down their hulls, with *gl the ghost that starts at
 * l and *gr the one that ends at r. Both sides may move at once: a vertex below the line from l to r
 * is also below the one from where l will be. */
INLINE void descend(const struct dt_merging *w, bool polls, int sides, struct seam *s, size_t *gl,
                    size_t *gr)
{
    for (uint32_t steps = 0; go_on(w, polls, &steps);) {
        uint32_t u = w->half[sides & SIGHT_LEFT ? *gl + 1 : *gr];
        uint32_t v = w->half[sides & SIGHT_RIGHT ? *gr : *gl + 1];
        struct sight c = sight_of(w->p, &s->at, u, v);
        int below = sides & sight_side(w, false, s->l, s->r, u, v, &c);
        if (below == 0)
            return;
        if (below & SIGHT_LEFT) {
            s->l = u;
            sight_from_left(&s->at, &c);
            *gl = ghost_after(w, *gl);
        }
        if (below & SIGHT_RIGHT) {
            s->r = v;
            sight_from_right(&s->at, &c);
            *gr = ghost_before(w, *gr);
        }
    }
}

/* The candidate c of a side, beyond whose edge lies the triangle of the half edge `beyond`. */
INLINE void look_at(const struct dt_merging *w, struct side *s, uint32_t c, size_t beyond)
{
    uint32_t x = w->half[dt_prev((uint32_t)beyond)];
    s->c = c;
    s->x = x ^ ((x ^ c) & (0 - (x >> 31))); /* no branch: only DT_NONE has its top bit set */
}

INLINE void look_from(const struct dt_merging *w, bool left, struct side *s, size_t ghost)
{
    s->ghost = ghost;
    look_at(w, s, w->half[left ? ghost : ghost + 1], knit_twin(w, ghost));
}

/* Deletes the edge of a side beyond its ghost. On the left this is l-u of L beyond lc = (u, l, none). On the right it is the mirror
 * image: r-v of R beyond rc = (r, v, none). `left` is known when compiled. */
INLINE void delete_edge(const struct dt_merging *w, bool left, struct side *s)
{
    size_t g = s->ghost,
           edge = knit_twin(w, g); /* l->u, in the triangle (l, u, x); v->r, in (v, r, x) */
    uint32_t c = s->c, x = s->x, before = dt_prev((uint32_t)edge), after = dt_next((uint32_t)edge);
    size_t t = dt_base((uint32_t)edge), beyond_side = knit_twin(w, left ? before : after),
           beyond_top = knit_twin(w, left ? after : before),
           out = knit_twin(w, left ? g + 2 : g + 1);
    w->half[left ? g : g + 1] = x;
    knit_link(w, g, beyond_side);
    knit_ghost(w, t, left ? c : x, left ? x : c);
    knit_link(w, t, beyond_top);
    knit_link(w, left ? t + 1 : t + 2, left ? g + 2 : g + 1);
    knit_link(w, left ? t + 2 : t + 1, out);
    w->leaving[left ? x : c] = (uint32_t)(left ? g : out - 2);
    look_at(w, s, x, beyond_side);
}

/* On which of the sides in `above` the edge to the candidate has to go; c is the sight of both. */
INLINE int to_delete(const struct dt_merging *w, struct seam *s, const struct side *left,
                     const struct side *right, int above, const struct sight *c)
{
    struct sight x = sight_of(w->p, &s->at, left->x, right->x);
    above &= (left->x != left->c ? SIGHT_LEFT : 0) | (right->x != right->c ? SIGHT_RIGHT : 0);
    return sight_better(w, &s->filter, s->l, s->r, above, (const uint32_t[]){left->c, right->c},
                        (const uint32_t[]){left->x, right->x}, c, &x);
}

INLINE void knit_left(const struct dt_merging *w, struct seam *s, const struct sight *c)
{
    size_t lc = s->left.ghost, next = ghost_before(w, lc);
    w->half[lc + 2] = s->r;
    knit_link(w, lc + 1, s->base);
    s->base = lc + 2;
    s->l = s->left.c;
    w->leaving[s->l] = (uint32_t)lc;
    sight_from_left(&s->at, c);
    look_from(w, true, &s->left, next);
}

INLINE void knit_right(const struct dt_merging *w, struct seam *s, const struct sight *c)
{
    size_t rc = s->right.ghost, next = ghost_after(w, rc);
    w->half[rc + 2] = s->l;
    knit_link(w, rc + 2, s->base);
    s->base = rc + 1;
    s->r = s->right.c;
    w->leaving[s->r] = (uint32_t)next;
    sight_from_right(&s->at, c);
    look_from(w, false, &s->right, next);
}

/* From the lower common tangent, whose ghost gets the record bot. */
INLINE struct seam start(const struct dt_merging *w, bool polls, int sides, uint32_t l, uint32_t r,
                         size_t some_l, size_t some_r, size_t bot)
{
    struct seam s = {.l = l, .r = r, .at = sight_base_of(w->p[l], w->p[r]), .base = bot};
    size_t gl = sides & SIGHT_LEFT ? ghost_from(w, l, some_l) : 0;
    size_t gr = sides & SIGHT_RIGHT ? ghost_before(w, ghost_from(w, r, some_r)) : 0;
    if (sides != 0)
        descend(w, polls, sides, &s, &gl, &gr);
    knit_ghost(w, bot, s.r, s.l);
    if (sides & SIGHT_LEFT) {
        look_from(w, true, &s.left, ghost_before(w, gl));
        knit_link(w, bot + 1, gl + 2);
        w->leaving[s.l] = (uint32_t)gl;
    }
    if (sides & SIGHT_RIGHT) {
        look_from(w, false, &s.right, ghost_after(w, gr));
        knit_link(w, bot + 2, gr + 1);
    }
    return s;
}

/* The merge proper; l and r are the last vertex of the left part and the first one of the right,
 * `sides` those that have more than one. Whether the close filter would have paid, or has been asked. */
INLINE bool knit(const struct dt_merging *w, bool close, bool polls, int sides, uint32_t l,
                 uint32_t r, size_t some_l, size_t some_r, size_t bot, size_t top)
{
    struct seam s = start(w, polls, sides, l, r, some_l, some_r, bot);
    const struct side *left = sides & SIGHT_LEFT ? &s.left : &s.right;
    const struct side *right = sides & SIGHT_RIGHT ? &s.right : &s.left;
    uint32_t steps = 0;
    s.filter.close = close;
    while (sides != 0 && go_on(w, polls, &steps)) {
        struct sight c = sight_of(w->p, &s.at, left->c, right->c);
        int above = sides & sight_side(w, true, s.l, s.r, left->c, right->c, &c);
        if (above == 0)
            break;
        int worse = to_delete(w, &s, left, right, above, &c);
        if (worse & SIGHT_LEFT)
            delete_edge(w, true, &s.left);
        if (worse & SIGHT_RIGHT)
            delete_edge(w, false, &s.right);
        if (worse != 0)
            continue;
        if (sight_left_wins(w, &s.filter, s.l, s.r, above, left->c, right->c, &c))
            knit_left(w, &s, &c);
        else
            knit_right(w, &s, &c);
    }
    knit_ghost(w, top, s.l, s.r);
    knit_link(w, top, s.base);
    knit_link(w, top + 1, sides & SIGHT_RIGHT ? s.right.ghost + 2 : bot + 2);
    knit_link(w, top + 2, sides & SIGHT_LEFT ? s.left.ghost + 1 : bot + 1);
    return close | (s.filter.settled > FEW_DOUBTS);
}

/* The common cases and the others, each compiled separately with constant conditions. */
static __attribute__((noinline)) bool knit_both(const struct dt_merging *w, uint32_t l, uint32_t r,
                                                uint32_t some_l, uint32_t some_r, uint32_t bot,
                                                uint32_t top)
{
    const struct dt_merging local = *w;
    return knit(&local, false, false, SIGHT_BOTH, l, r, some_l, some_r, bot, top);
}

static __attribute__((noinline)) bool knit_close(const struct dt_merging *w, uint32_t l, uint32_t r,
                                                 uint32_t some_l, uint32_t some_r, uint32_t bot,
                                                 uint32_t top)
{
    const struct dt_merging local = *w;
    return knit(&local, true, false, SIGHT_BOTH, l, r, some_l, some_r, bot, top);
}

static __attribute__((noinline)) bool knit_long(const struct dt_merging *w, bool close, uint32_t l,
                                                uint32_t r, uint32_t some_l, uint32_t some_r,
                                                uint32_t bot, uint32_t top)
{
    const struct dt_merging local = *w;
    return knit(&local, close, true, SIGHT_BOTH, l, r, some_l, some_r, bot, top);
}

static __attribute__((noinline)) bool knit_single(const struct dt_merging *w, bool polls, int sides,
                                                  uint32_t l, uint32_t r, uint32_t some_l,
                                                  uint32_t some_r, uint32_t bot, uint32_t top)
{
    if (sides == SIGHT_LEFT)
        return knit(w, false, polls, SIGHT_LEFT, l, r, some_l, some_r, bot, top);
    if (sides == SIGHT_RIGHT)
        return knit(w, false, polls, SIGHT_RIGHT, l, r, some_l, some_r, bot, top);
    return knit(w, false, false, 0, l, r, some_l, some_r, bot, top);
}

bool dt_knit(const struct dt_merging *w, bool close, uint32_t l, uint32_t r, uint32_t nl,
             uint32_t nr, uint32_t some_l, uint32_t some_r, uint32_t mid)
{
    uint32_t bot = 16 * mid - 16, top = 16 * mid - 8;
    int sides = (nl > 1 ? SIGHT_LEFT : 0) | (nr > 1 ? SIGHT_RIGHT : 0);
    bool polls = nl + nr > LONG;
    if (__builtin_expect(sides != SIGHT_BOTH, 0))
        return knit_single(w, polls, sides, l, r, some_l, some_r, bot, top);
    if (__builtin_expect(polls, 0))
        return knit_long(w, close, l, r, some_l, some_r, bot, top);
    if (close)
        return knit_close(w, l, r, some_l, some_r, bot, top);
    return knit_both(w, l, r, some_l, some_r, bot, top);
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
    struct dt_merging k = dt_merging_within(w, width > height ? width : height);
    bool close = a->close | b->close;
    if (axis == 0)
        c.close = dt_knit(&k, close, a->right, b->left, a->n, b->n, a->ghost, b->ghost, mid);
    else
        c.close = dt_knit(&k, close, a->top, b->bottom, a->n, b->n, a->ghost, b->ghost, mid);
    if (__builtin_expect(c.n > LONG, 0) && w->stop != NULL && dt_stop_status(w->stop) != DT_OK)
        return (struct dt_part){0}; /* it may have ended early */
    return c;
}
