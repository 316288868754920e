/* plane.c - see plane.h. */
#include "core/thinning/plane.h"

#include "core/exact/vectors.h"

/* The range of the largest value in which doubles are used. Beyond it products could overflow. Below it the bits that products
 * lose at the least doubles count: they become 2^-485 by the division by D >= 2^-388 and a side below 2^202. */
#define PLANE_MOST 0x1p600
#define PLANE_LEAST 0x1p-300

/* A plane whose rounded values mean nothing. */
static void give_up(struct dt_plane *p)
{
    p->dx = p->dy = 0;
    p->doubt = HUGE_VAL;
}

static void set_slopes(struct dt_plane *p, const struct dt_corners *c, double largest)
{
    double bx = c->second.at.x - p->at.x, by = c->second.at.y - p->at.y;
    double cx = c->third.at.x - p->at.x, cy = c->third.at.y - p->at.y;
    double bz = c->second.z - p->z, cz = c->third.z - p->z;
    double bb = bx * bx + by * by, cc = cx * cx + cy * cy, area = bx * cy - by * cx;
    double f = (bb > cc ? bb : cc) / area, range = fmax(fabs(bz), fabs(cz));
    p->dx = (bz * cy - cz * by) / area;
    p->dy = (cz * bx - bz * cx) / area;
    p->doubt = 0x1p-47 * f * range + 0x1p-49 * largest;
    if (!(f > 0 && f < 0x1p30)) /* rounding may have turned the triangle over */
        give_up(p);
}

/* The ends differ in x, or all points of the line have the same x. */
static void set_slope_of_line(struct dt_plane *p, const struct dt_corners *c, double largest)
{
    double x = c->second.at.x - p->at.x, z = c->second.z - p->z;
    if (x != 0)
        p->dx = z / x;
    else
        p->dy = z / (c->second.at.y - p->at.y);
    p->doubt = 0x1p-47 * fabs(z) + 0x1p-49 * largest;
}

struct dt_plane dt_plane_of(const struct dt_corners *c, double largest)
{
    struct dt_plane p = {.at = c->first.at, .z = c->first.z};
    double sum = c->first.z + c->second.z + (c->on_line ? 0 : c->third.z);
    if (isnan(sum) &&
        (isnan(c->first.z) || isnan(c->second.z) || (!c->on_line && isnan(c->third.z)))) {
        p.z = HUGE_VAL;
        return p;
    }
    p.level = c->first.z == c->second.z && (c->on_line || c->first.z == c->third.z);
    if (p.level) { /* also where rounding has left no area */
        p.doubt = 0x1p-49 * largest;
        return p;
    }
    if (largest > PLANE_MOST || largest < PLANE_LEAST) {
        give_up(&p);
        return p;
    }
    if (!c->on_line)
        set_slopes(&p, c, largest);
    else
        set_slope_of_line(&p, c, largest);
    return p;
}

/* ---- bounds ---- */

/* The weights of the second and the third corner at a point, and the largest error of each. */
struct weights {
    double second, third;
    double doubt;
};

/* The cross of a and b as seen from o; errs by at most 10.2 u^2 of *size (core/exact/bounds.h). */
static double cross(struct dt_point o, struct dt_point a, struct dt_point b, double *size)
{
    struct dt_bounded2 cross = dt_vector2_cross(dt_vector2_of(o, a), dt_vector2_of(o, b));
    *size = fmax(*size, cross.size);
    return cross.value.hi;
}

/* Let D be twice the area, and e = 16 u^2 size / D. The two crosses and D err by 0.64 e D, and their rounding by u of themselves.
 * A weight is at most 1, so it errs by 1.28 e + 5 u. */
static struct weights weights_of(const struct dt_corners *c, struct dt_point q)
{
    const struct dt_point o = c->first.at;
    double size = 0, area = cross(o, c->second.at, c->third.at, &size);
    double second = cross(o, q, c->third.at, &size), third = cross(o, c->second.at, q, &size);
    return (struct weights){second / area, third / area, 0x1p-101 * size / area + 0x1p-50};
}

/* The same on a line: the quotient of two differences errs by 3.1 u. */
static struct weights weights_between(const struct dt_corners *c, struct dt_point q)
{
    const struct dt_point o = c->first.at, e = c->second.at;
    double second = e.x != o.x ? (q.x - o.x) / (e.x - o.x) : (q.y - o.y) / (e.y - o.y);
    return (struct weights){second, 0, 0x1p-50};
}

/* All values are divided by 16, so that no sum overflows; let M be the largest one, and d the doubt, at most 1/2.
 *
 * 1. A difference of values is at most 2 M, and errs by 2 u M. A weight is at most 1 + d.
 * 2. The two products err by 4 M d from the weights and by 13 u M from rounding.
 * 3. The three sums are at most 9 M, and err by 21 u M.
 *
 * The error below exceeds the sum by enough for its own rounding. The last term covers underflow. No point is off by more than it differs
 * from some corner. */
struct dt_off_range dt_plane_off_range(const struct dt_corners *c, const struct dt_sample *q)
{
    const double part = 0x1p-4;
    double z = part * c->first.z, value = part * q->z;
    double second = part * c->second.z, third = part * (c->on_line ? c->first.z : c->third.z);
    double most = fmax(fmax(fabs(z), fabs(value)), fmax(fabs(second), fabs(third)));
    struct weights w = c->on_line ? weights_between(c, q->at) : weights_of(c, q->at);
    double off = fabs(z + (w.second * (second - z) + w.third * (third - z)) - value);
    double error = 4 * most * (w.doubt + 0x1p-49) + 0x1p-1060;
    double corner = fmax(fmax(fabs(c->first.z - q->z), fabs(c->second.z - q->z)),
                         fabs((c->on_line ? c->first.z : c->third.z) - q->z));
    if (!(w.doubt <= 0.5)) /* also if the area has vanished */
        return (struct dt_off_range){0, corner};
    return (struct dt_off_range){(off - error) / part, fmin((off + error) / part, corner)};
}

/* ---- exactly ---- */

/* A point is off by sum / area, both positive. */
struct off_big {
    struct dt_big sum, area;
};

/* weight (value - base); these may be so large that doubles have no difference. */
static struct dt_big weighted_big(struct dt_big weight, double value, double base)
{
    return dt_big_multiply(dt_big_difference(value, base), weight);
}

/* The weights are the crosses of the second corner, the third one and q, as seen from the first one. */
static struct off_big off_of_triangle(const struct dt_corners *c, const struct dt_sample *q)
{
    const struct dt_point o = c->first.at;
    struct dt_big_vector second = dt_big_vector_of(o, c->second.at),
                         third = dt_big_vector_of(o, c->third.at),
                         to_q = dt_big_vector_of(o, q->at);
    struct dt_big area = dt_big_cross(&second, &third);
    struct dt_big sum = weighted_big(area, c->first.z, q->z);
    sum = dt_big_add(sum, weighted_big(dt_big_cross(&to_q, &third), c->second.z, c->first.z));
    sum = dt_big_add(sum, weighted_big(dt_big_cross(&second, &to_q), c->third.z, c->first.z));
    return (struct off_big){sum, area};
}

/* The same on a line, by the coordinate in which its points differ. */
static struct off_big off_of_line(const struct dt_corners *c, const struct dt_sample *q)
{
    const struct dt_point o = c->first.at, e = c->second.at;
    const bool by_x = e.x != o.x;
    struct dt_big length = by_x ? dt_big_difference(e.x, o.x) : dt_big_difference(e.y, o.y);
    struct dt_big part = by_x ? dt_big_difference(q->at.x, o.x) : dt_big_difference(q->at.y, o.y);
    return (struct off_big){dt_big_add(weighted_big(length, c->first.z, q->z),
                                       weighted_big(part, c->second.z, c->first.z)),
                            length};
}

static struct off_big off_big(const struct dt_corners *c, const struct dt_sample *q)
{
    struct off_big off = c->on_line ? off_of_line(c, q) : off_of_triangle(c, q);
    off.sum.sign = off.sum.sign == 0 ? 0 : 1;
    off.area.sign = 1;
    return off;
}

bool dt_plane_exceeds(const struct dt_corners *c, const struct dt_sample *q, double bound)
{
    struct off_big off = off_big(c, q);
    return dt_big_compare(off.sum, dt_big_multiply(dt_big_of(bound), off.area)) > 0;
}

double dt_plane_nearest_off(const struct dt_corners *c, const struct dt_sample *q)
{
    struct off_big off = off_big(c, q);
    return dt_big_nearest(dt_big_divide(off.sum, off.area));
}
