/* circles.c - see circles.h. */
#include "core/surface/circles.h"

#include <math.h>
#include <stdlib.h>

enum dt_status dt_circles_init(struct dt_circles *c, uint32_t n)
{
    c->circle = malloc(n * sizeof *c->circle);
    c->mask = n - 1;
    if (c->circle == NULL)
        return DT_NOMEM;
    for (uint32_t i = 0; i < n; i++)
        c->circle[i].triangle = DT_NONE;
    return DT_OK;
}

void dt_circles_clear(struct dt_circles *c)
{
    free(c->circle);
    *c = (struct dt_circles){0};
}

/* Whether side i of a triangle is longer than side j, or as long and ends at a lesser corner; side i ends at corner i. */
static bool is_longer(const struct dt_point p[3], const double square[3], uint32_t i, uint32_t j)
{
    return square[i] > square[j] || (square[i] == square[j] && dt_compare_xy(p[i], p[j]) < 0);
}

/* The corner at which the longest side ends, counterclockwise. */
static uint32_t first_corner(const struct dt_point p[3])
{
    double square[3];
    for (uint32_t i = 0, before = 2; i < 3; before = i++) {
        double x = p[i].x - p[before].x, y = p[i].y - p[before].y;
        square[i] = x * x + y * y;
    }
    bool last = (square[2] > square[0]) & (square[2] > square[1]);
    bool middle = (square[1] > square[0]) & (square[1] > square[2]);
    bool first = (square[0] > square[1]) & (square[0] > square[2]);
    if (first | middle |
        last) /* without a branch on which one it is, which would be unpredictable */
        return (uint32_t)middle | (uint32_t)last << 1;
    uint32_t longest = is_longer(p, square, 1, 0) ? 1 : 0;
    return is_longer(p, square, 2, longest) ? 2 : longest;
}

/* How much the squares of the distances of a place and of the corners from the centre, as they are rounded, may seem to
 * differ where they do not: of a centre of this length and error. A place as far from the centre as a corner has it at c,
 * where c is off by `error` and by 3 units of the length (dt_circle_from), and so the lengths differ by at most 2 `error` +
 * 3 units; nearer and farther places come to the same, since their units are those of c, less than one for each that the
 * length differs by. A square is off by the length twice that, and by 2 units of itself. */
static double doubt(double length, double error)
{
    return 2.1 * length * (2 * error + 9 * DT_U * length);
}

void dt_circle_make(struct dt_circle *k, const struct dt *t, uint32_t triangle)
{
    const uint32_t *v = t->mesh.half + triangle;
    *k = (struct dt_circle){.triangle = triangle, .inside = -1, .outside = -1};
    if (v[2] == DT_NONE)
        return;
    struct dt_point p[3] = {t->points.xy[v[0]], t->points.xy[v[1]], t->points.xy[v[2]]};
    uint32_t i = first_corner(p), j = i == 2 ? 0 : i + 1, last = j == 2 ? 0 : j + 1;
    double sx = p[j].x - p[i].x, sy = p[j].y - p[i].y;
    double tx = p[last].x - p[i].x, ty = p[last].y - p[i].y;
    double ex = p[last].x - p[j].x, ey = p[last].y - p[j].y;
    double left = sx * ey, right = sy * ex, inverse = 1 / (left - right);
    double turn = (tx * ex + ty * ey) * inverse;
    struct dt_point c = {sx - turn * sy, sy + turn * sx};
    double length = fabs(c.x) + fabs(c.y), flat = (fabs(left) + fabs(right)) * fabs(inverse);
    double error = flat * DT_U < 0x1p-10 ? DT_CENTRE_ERROR(flat) * length : HUGE_VAL;
    double square = c.x * c.x + c.y * c.y;
    k->corner = p[i];
    k->centre = c;
    k->inside = square - doubt(length, error);
    k->outside = square + doubt(length, error);
    k->error = error + 1.1 * DT_U * length;
}
