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

/* The bits in which two floats differ, in all lanes. */
static dt_floats_holds turn_of(float a, float b)
{
    return (dt_floats_holds)dt_floats_all(a) ^ (dt_floats_holds)dt_floats_all(b);
}

void dt_coarse_add(struct dt_coarse *c, const struct dt_samples *s, struct dt_point way,
                   const struct dt_plane *p)
{
    const double slope = s->per_value / s->per_length;
    const uint32_t i = c->n++, before = i > 0 ? i - 1 : 0;
    const double x = way.x * s->per_length, y = way.y * s->per_length;
    c->x[i] = dt_floats_all((float)x);
    c->y[i] = dt_floats_all((float)y);
    c->dx[i] = (float)(p->dx * slope);
    c->dy[i] = (float)(p->dy * slope);
    c->turn_dx[i] = turn_of(c->dx[i], c->dx[before]);
    c->turn_dy[i] = turn_of(c->dy[i], c->dy[before]);
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
        c->most[i] = 0;
        c->count[i] = 0;
        c->doubt[i] =
            (dt_floats_abs(c->x[i]) + dt_floats_abs(c->y[i])) * dt_floats_all(of_edge) + FLT_MIN;
        c->error[i] += (fabsf(c->dx[i]) + fabsf(c->dy[i])) * of_slope + (float)(ABOVE * 5.3 * U);
    }
}

/* Four points as seen from the centre, and what the edges so far have shown. */
struct four {
    dt_floats x, y;
    dt_floats_holds sector, dx, dy; /* the sector, and the bits of its slopes */
    dt_floats_holds sure;           /* no side is in doubt */
};

/* Returns whether the points are to the left of an edge. */
static inline dt_floats_holds is_left(const struct dt_coarse *c, uint32_t edge, struct four *f)
{
    const dt_floats det = c->x[edge] * f->y - c->y[edge] * f->x;
    f->sure &= dt_floats_abs(det) > c->doubt[edge];
    return det > dt_floats_all(0);
}

/* Each edge from..end - 1 that a point of `half` is to the left of puts it into the next sector. */
static inline void pass(const struct dt_coarse *c, uint32_t from, uint32_t end,
                        dt_floats_holds half, struct four *f)
{
    for (uint32_t i = from; i < end; i++) {
        const dt_floats_holds left = is_left(c, i, f) & half;
        f->sector -= left;
        f->dx ^= left & c->turn_dx[i];
        f->dy ^= left & c->turn_dy[i];
    }
}

/* In each half of the star the edges that a point is to the left of are the first ones. */
void dt_coarse_find(const struct dt_coarse *c, const struct dt_rounded *point, uint32_t n,
                    uint32_t *sector, float *off)
{
    const uint32_t before = c->half - 1; /* the other half begins behind that sector */
    const dt_floats_holds none = {0, 0, 0, 0}, jump = none + (int32_t)before;
    const dt_floats_holds dx = turn_of(c->dx[0], 0), jump_dx = turn_of(c->dx[0], c->dx[before]);
    const dt_floats_holds dy = turn_of(c->dy[0], 0), jump_dy = turn_of(c->dy[0], c->dy[before]);
    for (uint32_t k = 0; k < n; k += 4) {
        const struct dt_rounded *p = point + k;
        struct four f = {(dt_floats){p[0].x, p[1].x, p[2].x, p[3].x} - c->at.x,
                         (dt_floats){p[0].y, p[1].y, p[2].y, p[3].y} - c->at.y,
                         none,
                         dx,
                         dy,
                         ~none};
        const dt_floats z = (dt_floats){p[0].z, p[1].z, p[2].z, p[3].z} - c->at.z;
        const dt_floats_holds other = c->half < c->n ? ~is_left(c, 0, &f) : none;
        f.sector = other & jump;
        f.dx ^= other & jump_dx;
        f.dy ^= other & jump_dy;
        pass(c, 1, c->half, ~other, &f);
        pass(c, c->half, c->n, other, &f);
        f.sector |= ~f.sure;
        __builtin_memcpy(sector + k, &f.sector, sizeof f.sector);
        dt_floats_store(off + k, dt_floats_abs((dt_floats)f.dx * f.x + (dt_floats)f.dy * f.y - z));
    }
}

void dt_coarse_tally(struct dt_coarse *c, uint32_t n, const uint32_t *sector, const float *off)
{
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = sector[k];
        if (i == DT_NONE)
            continue;
        c->count[i]++;
        if (off[k] > c->most[i])
            c->most[i] = off[k];
    }
}
