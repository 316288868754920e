/* clip.c - see clip.h. The triangle is cut at the sides of the box [Sutherland & Hodgman, "Reentrant polygon clipping", 1974], and then
 * where the height is 0; the parts are measured as fans of triangles.
 *
 * Errors in double words, with S the longest side of the triangle along an axis and H its greatest height:
 *
 *  1. A cut moves a corner along its edge if the distances of both ends err by 2^-100 S. That changes the area by less than 2^-99 S^2,
 *     also if the edge is nearly parallel to the side. The height of the corner follows the place.
 *  2. There are at most five cuts with two such corners each, and fans of at most six triangles, so the area errs by less than
 *     2^-94 S^2 and six times a volume by less than 2^-92 S^2 H.
 *  3. If the area is at least 2^-44 S^2, and both volumes together at least 2^-44 S^2 H, the relative errors are below 2^-48.
 *
 * In all other cases numbers of 2,560 bits are used. Their relative errors are below 2^-2400, and an area or volume that is not 0 is
 * more than 2^-2200 of S^2 or S^2 H. */
#include "core/triangle/clip.h"

#include "core/exact/bignum.h"
#include "core/exact/double2.h"

#include <math.h>

enum { CORNERS = 9 };

#define NUMBER struct dt_double2
#define F(name) name##_double2
#define DIFFERENCE(a, b) dt_double2_difference(a, b)
#define PLUS(a, b) dt_double2_add(a, b)
#define MINUS(a, b) dt_double2_subtract(a, b)
#define TIMES(a, b) dt_double2_multiply(a, b)
#define OVER(a, b) dt_double2_divide(a, b)
#define SIGN(a) ((a).hi)
#define ZERO ((struct dt_double2){0, 0})
#include "core/triangle/clip_formula.h"

/* ---- in long numbers ---- */

#define NUMBER struct dt_big
#define F(name) name##_big
#define DIFFERENCE(a, b) dt_big_difference(a, b)
#define PLUS(a, b) dt_big_add(a, b)
#define MINUS(a, b) dt_big_subtract(a, b)
#define TIMES(a, b) dt_big_multiply(a, b)
#define OVER(a, b) dt_big_divide(a, b)
#define SIGN(a) ((a).sign)
#define ZERO ((struct dt_big){0})
#include "core/triangle/clip_formula.h"

/* The top limb becomes the number's integer part, so that it is a double. */
static struct dt_scaled scaled(struct dt_big v)
{
    if (v.sign <= 0)
        return (struct dt_scaled){0, 0};
    int limbs = v.exponent + (int)v.n - 1;
    v.exponent -= limbs;
    return (struct dt_scaled){dt_big_nearest(v), 64 * limbs};
}

static struct dt_slab_parts clip_exactly(const struct dt_slab *s, struct dt_point lo,
                                         struct dt_point hi)
{
    struct dt_big above, below, area;
    clip_big(s, lo, hi, &above, &below, &area);
    return (struct dt_slab_parts){scaled(above), scaled(below), scaled(area)};
}

/* ---- both ---- */

static double longest_side(const struct dt_slab *s)
{
    double most = 0;
    for (int k = 1; k < 3; k++)
        most = fmax(most, fmax(fabs(s->p[k].x - s->p[0].x), fabs(s->p[k].y - s->p[0].y)));
    return most;
}

static double greatest_height(const struct dt_slab *s)
{
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, fabs(s->top[k] - s->base[k]));
    return most;
}

static struct dt_scaled at_least_0(struct dt_double2 v)
{
    return (struct dt_scaled){v.hi > 0 ? v.hi : 0, 0};
}

struct dt_slab_parts dt_slab_clip(const struct dt_slab *s, struct dt_point lo, struct dt_point hi)
{
    const double least = 0x1p-44;
    double side = longest_side(s), height = greatest_height(s);
    struct dt_double2 above, below, area;
    if (height > 0x1p400 || (height > 0 && height < 0x1p-400))
        return clip_exactly(s, lo, hi);
    clip_double2(s, lo, hi, &above, &below, &area);
    if (area.hi < least * side * side || above.hi + below.hi < least * side * side * height)
        return clip_exactly(s, lo, hi);
    return (struct dt_slab_parts){at_least_0(above), at_least_0(below), at_least_0(area)};
}
