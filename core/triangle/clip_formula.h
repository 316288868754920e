/* clip_formula.h - what is above and below a triangle in a box, once for each kind of number; for clip.c only, which defines, before it
 * includes this file, what is undefined again at its end:
 *
 *     NUMBER                          the type
 *     F(name)                         name with a suffix of its own
 *     DIFFERENCE(a, b)                of two doubles
 *     PLUS, MINUS, TIMES, OVER(a, b)
 *     SIGN(a)                         a number with the sign of a
 *     ZERO                            0 */

/* Relative to the first corner of the triangle. */
struct F(corner) {
    NUMBER along[3]; /* x, y and the height */
};

/* A triangle has at most four more corners after four cuts, and one more after another one. */
struct F(polygon) {
    struct F(corner) v[CORNERS];
    int n;
};

/* The place on a-b where a linear function is 0 that is *at_a at a and *at_b at b: different signs. */
static struct F(corner) F(between)(const struct F(corner) * a, const struct F(corner) * b,
                                   const NUMBER *at_a, const NUMBER *at_b)
{
    struct F(corner) r;
    NUMBER share = OVER(*at_a, MINUS(*at_a, *at_b));
    for (int k = 0; k < 3; k++)
        r.along[k] = PLUS(a->along[k], TIMES(share, MINUS(b->along[k], a->along[k])));
    return r;
}

/* Keeps the part of *p where along[axis] is at least the bound or, unless `from` is true, at most the bound. */
static void F(cut)(struct F(polygon) * p, int axis, const NUMBER *bound, bool from)
{
    struct F(polygon) q;
    NUMBER inside[CORNERS];
    q.n = 0;
    for (int i = 0; i < p->n; i++)
        inside[i] = from ? MINUS(p->v[i].along[axis], *bound) : MINUS(*bound, p->v[i].along[axis]);
    for (int i = 0; i < p->n; i++) {
        int next = i + 1 < p->n ? i + 1 : 0;
        bool in = SIGN(inside[i]) >= 0, next_in = SIGN(inside[next]) >= 0;
        if (in)
            q.v[q.n++] = p->v[i];
        if (in != next_in && SIGN(inside[i]) != 0 && SIGN(inside[next]) != 0)
            q.v[q.n++] = F(between)(&p->v[i], &p->v[next], &inside[i], &inside[next]);
    }
    *p = q;
}

/* Twice the area, and six times the volume below the heights. */
static void F(measure)(const struct F(polygon) * p, NUMBER *area, NUMBER *volume)
{
    *area = *volume = ZERO;
    for (int i = 1; i + 1 < p->n; i++) {
        const NUMBER *a = p->v[0].along, *b = p->v[i].along, *c = p->v[i + 1].along;
        NUMBER part = MINUS(TIMES(MINUS(b[0], a[0]), MINUS(c[1], a[1])),
                            TIMES(MINUS(b[1], a[1]), MINUS(c[0], a[0])));
        *area = PLUS(*area, part);
        *volume = PLUS(*volume, TIMES(part, PLUS(a[2], PLUS(b[2], c[2]))));
    }
}

/* *area: twice the area in the box; *above and *below: six times the volumes there. */
static void F(clip)(const struct dt_slab *s, struct dt_point lo, struct dt_point hi, NUMBER *above,
                    NUMBER *below, NUMBER *area)
{
    const struct dt_point *p = s->p;
    const NUMBER zero = ZERO, least[] = {DIFFERENCE(lo.x, p[0].x), DIFFERENCE(lo.y, p[0].y)},
                 most[] = {DIFFERENCE(hi.x, p[0].x), DIFFERENCE(hi.y, p[0].y)};
    struct F(polygon) in = {.n = 3}, part;
    NUMBER unused;
    for (int k = 0; k < 3; k++) {
        in.v[k].along[0] = DIFFERENCE(p[k].x, p[0].x);
        in.v[k].along[1] = DIFFERENCE(p[k].y, p[0].y);
        in.v[k].along[2] = DIFFERENCE(s->top[k], s->base[k]);
    }
    for (int axis = 0; axis < 2; axis++) {
        F(cut)(&in, axis, &least[axis], true);
        F(cut)(&in, axis, &most[axis], false);
    }
    F(measure)(&in, area, &unused);
    part = in;
    F(cut)(&part, 2, &zero, true);
    F(measure)(&part, &unused, above);
    part = in;
    F(cut)(&part, 2, &zero, false);
    F(measure)(&part, &unused, below);
    *below = MINUS(zero, *below);
}

#undef NUMBER
#undef F
#undef DIFFERENCE
#undef PLUS
#undef MINUS
#undef TIMES
#undef OVER
#undef SIGN
#undef ZERO
