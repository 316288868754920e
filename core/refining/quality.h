/* quality.h - what triangles should be like, and whether one is; every decision is exact.
 *
 *             r                A triangle's least angle is that opposite to its shortest edge, at r. It is too small if
 *            / \               cos^2 of it is larger than cos^2 of the limit:
 *           /   \
 *          p --- q                 dot > 0  and  dot^2 > C |p - r|^2 |q - r|^2,   dot = (p - r) . (q - r)
 *
 * C is the double nearest to cos^2 of the limit in degrees. So the decision is the sign of a polynomial of degree four of
 * coordinates. Doubles decide unless the two sides are almost equal; numbers of many bits (core/exact/bignum.h) do then. */
#pragma once

#include "core/delaunay_constraints.h"

#include <math.h>

/* The limits in the form in which they are compared. */
struct dt_wanted {
    double cosine2;      /* C; at least 1: any angle */
    double area, length; /* HUGE_VAL: any */
    double off; /* the height over the shortest edge, of length 1, of an off-centre; 0: none */
};

void dt_wanted_of(const struct dt_quality *q, struct dt_wanted *out);

/* The double nearest to cos^2 of an angle in degrees, 0 to 60. */
double dt_cosine2(double degrees);

/* What is wrong with a triangle, as bits. */
enum { DT_SHARP = 1, DT_LARGE = 2, DT_LONG = 4 };

struct dt_shape {
    struct dt_point p, q, r; /* counterclockwise; p-q is the shortest edge */
    double pq, qr, rp;       /* the squares of the edges' lengths */
    double cross;            /* twice the area */
    int first;               /* which corner p is */
};

/* Corners counterclockwise. */
static inline void dt_shape_of(struct dt_point a, struct dt_point b, struct dt_point c,
                               struct dt_shape *s)
{
    double ab = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
    double bc = (c.x - b.x) * (c.x - b.x) + (c.y - b.y) * (c.y - b.y);
    double ca = (a.x - c.x) * (a.x - c.x) + (a.y - c.y) * (a.y - c.y);
    if (ab <= bc && ab <= ca)
        *s = (struct dt_shape){.p = a, .q = b, .r = c, .pq = ab, .qr = bc, .rp = ca, .first = 0};
    else if (bc <= ca)
        *s = (struct dt_shape){.p = b, .q = c, .r = a, .pq = bc, .qr = ca, .rp = ab, .first = 1};
    else
        *s = (struct dt_shape){.p = c, .q = a, .r = b, .pq = ca, .qr = ab, .rp = bc, .first = 2};
    s->cross = (s->q.x - s->p.x) * (s->r.y - s->p.y) - (s->q.y - s->p.y) * (s->r.x - s->p.x);
}

/* Whether some angle is too small for this C; C above 1: none is. Exact. */
bool dt_is_sharp(double cosine2, const struct dt_shape *s);

/* Which limits the triangle breaks. Exact. */
unsigned dt_shape_breaks(const struct dt_wanted *w, const struct dt_shape *s);

/* Whether the edge is longer than the limit. Exact. */
bool dt_is_long(const struct dt_wanted *w, struct dt_point a, struct dt_point b);

/* Whether q is in the circle around a-b: it sees the edge under more than 90 degrees. In doubles: who asks needs no more than an
 * answer that is always the same. */
static inline bool dt_encroaches(struct dt_point a, struct dt_point b, struct dt_point q)
{
    return (a.x - q.x) * (b.x - q.x) + (a.y - q.y) * (b.y - q.y) < 0;
}
