/* gradient.c - see gradient.h.
 *
 * With differences to the first corner, b and c:
 *
 *     area = bx cy - by cx      dx = (bz cy - cz by) / area      dy = (cz bx - bz cx) / area
 *
 * In double words, with u = 2^-53, a difference of two doubles is exact, and a determinant errs by less than 11 u^2 of the sum of
 * the magnitudes of its products. A quotient adds 16 u^2. If an error of twice that cannot change the nearest double, a slope
 * is rounded correctly. In all other cases numbers of 2,560 bits decide. These have room for all bits of
 * the determinants. */
#include "core/triangle/gradient.h"

#include "core/exact/vectors.h"

#include <math.h>

/* A determinant, with the sum of the magnitudes of its products. */
struct determinant {
    struct dt_double2 value;
    double size;
    bool exact; /* the factors are doubles */
};

static struct determinant determinant_of(struct dt_double2 a, struct dt_double2 d,
                                         struct dt_double2 b, struct dt_double2 c)
{
    struct dt_double2 plus = dt_double2_multiply(a, d), minus = dt_double2_multiply(b, c);
    return (struct determinant){.value = dt_double2_subtract(plus, minus),
                                .size = fabs(plus.hi) + fabs(minus.hi),
                                .exact = a.lo == 0 && b.lo == 0 && c.lo == 0 && d.lo == 0};
}

/* False: the nearest double is not certain. */
static bool divide(const struct determinant *a, const struct determinant *b, double *out)
{
    struct dt_double2 q;
    if (a->value.hi == 0 &&
        a->exact) { /* products of doubles are exact, and so is the difference of equal ones */
        *out = 0;
        return true;
    }
    if (a->value.hi == 0 || b->value.hi == 0)
        return false;
    q = dt_double2_divide(a->value, b->value);
    double error = 0x1p-101 * (2 + a->size / fabs(a->value.hi) + b->size / fabs(b->value.hi));
    error *= fabs(q.hi);
    *out = q.hi;
    return q.hi + (q.lo + error) == q.hi && q.hi + (q.lo - error) == q.hi;
}

static bool is_moderate(double z)
{
    double size = fabs(z);
    return size == 0 || (size > 0x1p-600 && size < 0x1p600);
}

static bool gradient_in_double_words(const struct dt_point p[3], const double z[3],
                                     struct dt_gradient *out)
{
    if (!is_moderate(z[0]) || !is_moderate(z[1]) || !is_moderate(z[2]))
        return false;
    struct dt_vector2 b = dt_vector2_of(p[0], p[1]), c = dt_vector2_of(p[0], p[2]);
    struct dt_double2 bz = dt_double2_difference(z[1], z[0]),
                      cz = dt_double2_difference(z[2], z[0]);
    struct determinant area = determinant_of(b.x, c.y, b.y, c.x),
                       dx = determinant_of(bz, c.y, b.y, cz), dy = determinant_of(cz, b.x, c.x, bz);
    return divide(&dx, &area, &out->dx) && divide(&dy, &area, &out->dy);
}

/* ---- exactly ---- */

static struct dt_gradient exact_gradient(const struct dt_point p[3], const double z[3])
{
    struct dt_big_vector b = dt_big_vector_of(p[0], p[1]), c = dt_big_vector_of(p[0], p[2]);
    struct dt_big bz = dt_big_difference(z[1], z[0]), cz = dt_big_difference(z[2], z[0]);
    struct dt_big area = dt_big_cross(&b, &c), dx = dt_big_determinant(&bz, &b.y, &cz, &c.y),
                  dy = dt_big_determinant(&cz, &c.x, &bz, &b.x);
    return (struct dt_gradient){dt_big_quotient(dx, area), dt_big_quotient(dy, area)};
}

struct dt_gradient dt_gradient_of(const struct dt_point p[3], const double z[3])
{
    struct dt_gradient r;
    if (!gradient_in_double_words(p, z, &r))
        r = exact_gradient(p, z);
    return (struct dt_gradient){r.dx + 0.0, r.dy + 0.0};
}
