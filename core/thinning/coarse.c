/* coarse.c - see coarse.h. */
#include "core/thinning/coarse.h"

#include <float.h>

#define U 0x1p-24
#define ABOVE 1.2 /* bounds are larger than what they bound by this factor */

void dt_coarse_begin(struct dt_coarse *c, const struct dt_samples *s, uint32_t centre)
{
    c->n = 0;
    c->reach = 0;
    c->at = s->rounded[centre];
}

void dt_coarse_add(struct dt_coarse *c, const struct dt_samples *s, double x, double y,
                   const struct dt_plane *p)
{
    const double slope = s->per_value / s->per_length;
    uint32_t i = c->n++;
    x *= s->per_length;
    y *= s->per_length;
    c->x[i] = (float)x;
    c->y[i] = (float)y;
    c->dx[i] = (float)(p->dx * slope);
    c->dy[i] = (float)(p->dy * slope);
    c->error[i] = isinf(p->z) ? HUGE_VALF : (float)(4 * ABOVE * p->doubt * s->per_value);
    c->reach = fmax(c->reach, fmax(fabs(x), fabs(y)));
}

void dt_coarse_end(struct dt_coarse *c, uint32_t half)
{
    const double e = 1.25 * U * (1 + c->reach), r = c->reach + e;
    const float of_edge = (float)(ABOVE * (e + 3.1 * U * r));
    const float of_slope = (float)(ABOVE * (e + 4.1 * U * r));
    c->half = half;
    for (uint32_t i = 0; i < c->n; i++) {
        c->most[i] = dt_floats_all(0);
        c->count[i] = (dt_floats_holds){0, 0, 0, 0};
        c->doubt[i] = (fabsf(c->x[i]) + fabsf(c->y[i])) * of_edge + FLT_MIN;
        c->error[i] += (fabsf(c->dx[i]) + fabsf(c->dy[i])) * of_slope + (float)(ABOVE * 5.3 * U);
    }
}

/* Whether four points are to the left of an edge, and by how much their distance from its line exceeds the doubt. */
struct sides {
    dt_floats_holds left;
    dt_floats sure;
};

static inline struct sides sides_of(const struct dt_coarse *c, uint32_t edge, dt_floats x,
                                    dt_floats y)
{
    dt_floats det = dt_floats_all(c->x[edge]) * y - dt_floats_all(c->y[edge]) * x;
    return (struct sides){det > dt_floats_all(0),
                          dt_floats_abs(det) - dt_floats_all(c->doubt[edge])};
}

/* Counts the edges from..end - 1 that four points are on the left of; *sure: no side is in doubt. */
static inline dt_floats_holds count_edges(const struct dt_coarse *c, uint32_t from, uint32_t end,
                                          dt_floats x, dt_floats y, dt_floats_holds *sure)
{
    dt_floats_holds n = {0, 0, 0, 0};
    for (uint32_t i = from; i < end; i++) {
        struct sides s = sides_of(c, i, x, y);
        n -= s.left;
        *sure &= s.sure > dt_floats_all(0);
    }
    return n;
}

/* In each half of the star the edges that a point is on the left of are the first ones. */
void dt_coarse_find(const struct dt_coarse *c, struct dt_coarse_points *p)
{
    const int32_t before = (int32_t)c->half - 1;
    const dt_floats_holds first = {before, before, before, before};
    for (uint32_t k = p->n; k % 4 != 0; k++) /* up to a multiple of four */
        p->x[k] = p->y[k] = p->z[k] = 0;
    for (uint32_t k = 0; k < p->n; k += 4) {
        dt_floats x = dt_floats_load(p->x + k), y = dt_floats_load(p->y + k);
        dt_floats_holds sure = {-1, -1, -1, -1};
        dt_floats_holds sector = count_edges(c, 1, c->half, x, y, &sure);
        if (c->half < c->n) {
            struct sides s = sides_of(c, 0, x, y);
            dt_floats_holds other = first + count_edges(c, c->half, c->n, x, y, &sure);
            sure &= s.sure > dt_floats_all(0);
            sector = (s.left & sector) | (~s.left & other);
        }
        sector |= ~sure;
        __builtin_memcpy(p->sector + k, &sector, sizeof sector);
    }
}

void dt_coarse_measure(struct dt_coarse *c, struct dt_coarse_points *p)
{
    for (uint32_t k = p->n; k % 4 != 0; k++)
        p->sector[k] = DT_NONE;
    for (uint32_t k = 0; k < p->n; k += 4)
        dt_floats_store(p->off + k, dt_floats_all(0));
    for (uint32_t i = 0; i < c->n; i++) {
        const dt_floats dx = dt_floats_all(c->dx[i]), dy = dt_floats_all(c->dy[i]);
        const int32_t number = (int32_t)i;
        const dt_floats_holds same = {number, number, number, number};
        dt_floats most = c->most[i];
        dt_floats_holds count = c->count[i];
        for (uint32_t k = 0; k < p->n; k += 4) {
            dt_floats x = dt_floats_load(p->x + k), y = dt_floats_load(p->y + k);
            dt_floats off = dt_floats_abs(dx * x + dy * y - dt_floats_load(p->z + k));
            dt_floats_holds sector, in;
            __builtin_memcpy(&sector, p->sector + k, sizeof sector);
            in = sector == same;
            off = (dt_floats)((dt_floats_holds)off & in);
            dt_floats_holds before = (dt_floats_holds)dt_floats_load(p->off + k);
            dt_floats_store(p->off + k, (dt_floats)(before | (dt_floats_holds)off));
            most = dt_floats_most(off, most);
            count += in;
        }
        c->most[i] = most;
        c->count[i] = count;
    }
}
