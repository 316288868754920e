/* linear.c - linear values in doubles, two triangles or two cells at a time.
 *
 * A triangle's plane is computed from its corners, counterclockwise from the smallest id, where rounding begins. The
 * ratio of the weights' sum is 1, so only differences to that corner's value matter.
 *
 * Slopes are exact enough unless the triangle is thin. Let z be the range of its values, m the longer side from the
 * corner, D twice its area, f = m^2 / D and u = 2^-53.
 *
 * 1. The numerator of a slope errs by less than 4 u of 2 z m. The quotient adds (1 + 4 f) u of itself.
 * 2. So the products of both slopes with sides err by 16 f u z, and by 4 f u of their sum, which is at most z.
 * 3. Together that is less than 40 f u z, which is less than DT_WEIGHTS_ERROR z. */
#include "core/exact/lanes.h"
#include "core/surface/value.h"

#include <math.h>

#define PLANE_FLAT 128.0

/* Products may lose bits at the least doubles, 2^-1074. Let s be the sum of both slopes.
 * 1. A side is at least 2^-195, so an area is at least 2^-397.
 * 2. If s is this steep, the products in the numerators of the slopes add up to 2^-997 or more, and z is 2^-795 or more.
 * 3. So the lost bits are less than 2^-60 z. */
#define PLANE_STEEP 0x1p-600

/* The corners of two triangles and their values. */
struct corners {
    dt_lanes ax, ay, bx, by, cx, cy, az, bz, cz;
};

struct planes {
    dt_lanes x, y, z, dx, dy; /* of the first corner, and the slopes there */
    dt_lanes least, most;     /* values at the corners */
    dt_lanes_holds sure;      /* doubles are exact enough */
};

/* The places of the corners of a triangle, and of their values. */
struct places {
    const struct dt_point *a, *b, *c;
    const double *az, *bz, *cz;
};

static inline struct places places_of(const struct dt_valuer *v, uint32_t half)
{
    static const uint8_t next[] = {1, 2, 0}, previous[] = {2, 0, 1};
    const uint32_t *corner = v->t->mesh.half + dt_base(half), *id = v->t->points.id;
    const struct dt_point *xy = v->t->points.xy;
    uint32_t i = id[corner[0]], j = id[corner[1]], k = id[corner[2]], least = i < j ? i : j;
    uint32_t third = k < least, first = third << 1 | ((j < i) & (third ^ 1));
    uint32_t a = corner[first], b = corner[next[first]], c = corner[previous[first]];
    return (struct places){&xy[a],
                           &xy[b],
                           &xy[c],
                           dt_value_place(v->s, id[a]),
                           dt_value_place(v->s, id[b]),
                           dt_value_place(v->s, id[c])};
}

static inline void read_corner(const struct dt_point *p, const struct dt_point *q, dt_lanes *x,
                               dt_lanes *y)
{
    dt_lanes at = dt_lanes_load(&p->x), other = dt_lanes_load(&q->x);
    *x = dt_lanes_first(at, other);
    *y = dt_lanes_second(at, other);
}

static inline struct corners corners_of(const struct places *p, const struct places *q)
{
    struct corners k = {.az = {*p->az, *q->az}, .bz = {*p->bz, *q->bz}, .cz = {*p->cz, *q->cz}};
    read_corner(p->a, q->a, &k.ax, &k.ay);
    read_corner(p->b, q->b, &k.bx, &k.by);
    read_corner(p->c, q->c, &k.cx, &k.cy);
    return k;
}

static inline struct planes planes_of(const struct corners *k)
{
    struct planes p = {.x = k->ax, .y = k->ay, .z = k->az};
    dt_lanes bx = k->bx - k->ax, by = k->by - k->ay, bz = k->bz - k->az;
    dt_lanes cx = k->cx - k->ax, cy = k->cy - k->ay, cz = k->cz - k->az;
    dt_lanes area = bx * cy - by * cx, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
    p.dx = (bz * cy - cz * by) / area;
    p.dy = (cz * bx - bz * cx) / area;
    p.least = dt_lanes_least(k->cz, dt_lanes_least(k->az, k->bz));
    p.most = dt_lanes_most(k->cz, dt_lanes_most(k->az, k->bz));
    dt_lanes_holds known = dt_lanes_known(k->az) & dt_lanes_known(k->bz) & dt_lanes_known(k->cz);
    dt_lanes_holds fat = dt_lanes_most(bb, cc) < dt_lanes_both(PLANE_FLAT) * area;
    dt_lanes steep = dt_lanes_abs(p.dx) + dt_lanes_abs(p.dy);
    dt_lanes_holds fits = (steep >= dt_lanes_both(PLANE_STEEP)) & (steep < dt_lanes_both(HUGE_VAL));
    dt_lanes_holds level = (bz == dt_lanes_both(0)) & (cz == dt_lanes_both(0));
    p.sure = ~known | (fat & (fits | level));
    return p;
}

/* The values in planes at x; rise: what dy adds. */
static inline dt_lanes values_at(const struct planes *p, dt_lanes x, dt_lanes rise)
{
    dt_lanes value = p->z + (p->dx * (x - p->x) + rise);
    value = dt_lanes_least(p->most, dt_lanes_most(p->least, value));
    return dt_lanes_choose(dt_lanes_known(value), value, dt_lanes_both((double)NAN));
}

bool dt_plane_value(const struct dt_valuer *v, struct dt_point q, uint32_t half, double *out)
{
    struct places at = places_of(v, half);
    struct corners k = corners_of(&at, &at);
    struct planes p = planes_of(&k);
    *out = values_at(&p, dt_lanes_both(q.x), p.dy * (dt_lanes_both(q.y) - p.y))[0];
    return p.sure[0] != 0;
}

/* ---- cells of a row ---- */

/* The planes of different triangles along a row. */
struct row_planes {
    double x[DT_ROOM], z[DT_ROOM], dx[DT_ROOM], rise[DT_ROOM], least[DT_ROOM], most[DT_ROOM];
    uint32_t of[DT_ROOM]; /* the triangle */
    uint64_t doubtful;    /* doubles are not exact enough, or a cell may be on an edge */
};

/* Numbers the triangles of n cells. Returns how many they are. */
static inline uint32_t number_triangles(struct row_planes *r, const uint32_t *half, uint32_t n,
                                        uint8_t *number)
{
    uint32_t last = dt_base(half[0]), k = 0;
    r->of[0] = last;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t base = dt_base(half[i]);
        k += base != last;
        r->of[k] = last = base;
        number[i] = (uint8_t)k;
    }
    return k + 1;
}

/* Returns the lanes whose triangle has an edge at y, on which a cell may be. */
static inline dt_lanes_holds level(const struct corners *k, dt_lanes y)
{
    dt_lanes_holds a = k->ay == y, b = k->by == y, c = k->cy == y;
    return (a & b) | (b & c) | (c & a);
}

/* The values of all triangles are fetched before the first is read: their ids may be in any order. */
static inline void make_planes(const struct dt_valuer *v, struct row_planes *r, double y,
                               uint32_t n)
{
    struct places place[DT_ROOM + 1];
    dt_lanes at = dt_lanes_both(y);
    r->doubtful = 0;
    for (uint32_t i = 0; i <= n; i++) { /* the last one twice, since they are computed in pairs */
        place[i] = places_of(v, r->of[i < n ? i : n - 1]);
        dt_fetch(place[i].az);
        dt_fetch(place[i].bz);
        dt_fetch(place[i].cz);
    }
    for (uint32_t i = 0; i < n; i += 2) {
        struct corners k = corners_of(&place[i], &place[i + 1]);
        struct planes p = planes_of(&k);
        dt_lanes_store(&r->x[i], p.x);
        dt_lanes_store(&r->z[i], p.z);
        dt_lanes_store(&r->dx[i], p.dx);
        dt_lanes_store(&r->rise[i], p.dy * (at - p.y));
        dt_lanes_store(&r->least[i], p.least);
        dt_lanes_store(&r->most[i], p.most);
        r->doubtful |= (uint64_t)dt_lanes_bits(~p.sure | level(&k, at)) << i;
    }
}

static inline dt_lanes two_values(const struct row_planes *r, uint8_t i, uint8_t k, dt_lanes x)
{
    struct planes p = {.x = {r->x[i], r->x[k]},
                       .z = {r->z[i], r->z[k]},
                       .dx = {r->dx[i], r->dx[k]},
                       .least = {r->least[i], r->least[k]},
                       .most = {r->most[i], r->most[k]}};
    return values_at(&p, x, (dt_lanes){r->rise[i], r->rise[k]});
}

uint64_t dt_plane_values(const struct dt_valuer *v, const uint32_t *half, const double *x, double y,
                         uint32_t n, double *out)
{
    struct row_planes r;
    uint8_t number[DT_ROOM];
    uint64_t doubtful = 0;
    make_planes(v, &r, y, number_triangles(&r, half, n, number));
    for (uint32_t i = 0; i + 1 < n; i += 2)
        dt_lanes_store(&out[i], two_values(&r, number[i], number[i + 1], dt_lanes_load(&x[i])));
    if (n % 2 != 0) {
        uint8_t last = number[n - 1];
        out[n - 1] = two_values(&r, last, last, dt_lanes_both(x[n - 1]))[0];
    }
    for (uint32_t i = 0; r.doubtful != 0 && i < n; i++)
        doubtful |= (r.doubtful >> number[i] & 1) << i;
    return doubtful;
}
