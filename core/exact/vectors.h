/* vectors.h - vectors between places and their products, in double words and in long numbers. */
#pragma once

#include <math.h>

#include "core/delaunay.h"
#include "core/exact/bignum.h"
#include "core/exact/double2.h"

/* ---- in double words ---- */

struct dt_vector2 {
    struct dt_double2 x, y;
};

/* b - a, exact. */
static inline struct dt_vector2 dt_vector2_of(struct dt_point a, struct dt_point b)
{
    return (struct dt_vector2){dt_double2_difference(b.x, a.x), dt_double2_difference(b.y, a.y)};
}

/* A value and the sum of the magnitudes of its terms. */
struct dt_bounded2 {
    struct dt_double2 value;
    double size;
};

static inline struct dt_bounded2 dt_bounded2_sum(struct dt_double2 a, struct dt_double2 b)
{
    return (struct dt_bounded2){dt_double2_add(a, b), fabs(a.hi) + fabs(b.hi)};
}

static inline struct dt_bounded2 dt_vector2_cross(struct dt_vector2 a, struct dt_vector2 b)
{
    return dt_bounded2_sum(dt_double2_multiply(a.x, b.y),
                           dt_double2_negate(dt_double2_multiply(a.y, b.x)));
}

static inline struct dt_bounded2 dt_vector2_dot(struct dt_vector2 a, struct dt_vector2 b)
{
    return dt_bounded2_sum(dt_double2_multiply(a.x, b.x), dt_double2_multiply(a.y, b.y));
}

/* ---- in long numbers ---- */

struct dt_big_vector {
    struct dt_big x, y;
};

/* b - a */
static inline struct dt_big_vector dt_big_vector_of(struct dt_point a, struct dt_point b)
{
    return (struct dt_big_vector){dt_big_difference(b.x, a.x), dt_big_difference(b.y, a.y)};
}

/* a d - b c */
static inline struct dt_big dt_big_determinant(const struct dt_big *a, const struct dt_big *b,
                                               const struct dt_big *c, const struct dt_big *d)
{
    return dt_big_subtract(dt_big_multiply(*a, *d), dt_big_multiply(*b, *c));
}

static inline struct dt_big dt_big_cross(const struct dt_big_vector *a,
                                         const struct dt_big_vector *b)
{
    return dt_big_determinant(&a->x, &a->y, &b->x, &b->y);
}

static inline struct dt_big dt_big_dot(const struct dt_big_vector *a, const struct dt_big_vector *b)
{
    return dt_big_add(dt_big_multiply(a->x, b->x), dt_big_multiply(a->y, b->y));
}
