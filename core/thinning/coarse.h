/* coarse.h - in which sector of a star points are, and about how far they are off its plane: in floats, four points at a time, with
 * bounds of the errors. Doubles decide what floats cannot decide.
 *
 * The star is seen from its centre p; an edge of it leads to s, a point is at q. All are in the units of struct dt_rounded. Let u = 2^-24,
 * and r the largest coordinate of any s; then the coordinates of q are at most r, too.
 *
 * 1. Rounded coordinates err by 0.51 u. So q errs by E = 1.25 u (1 + r), and s, from doubles, by 1.01 u of itself.
 * 2. s.x q.y - s.y q.x errs by (|s.x| + |s.y|) (E + 3.1 u (r + E)): from q, and from s, products and their difference.
 * 3. A value errs by 0.51 u, the difference of two by 3.1 u. The slopes a and b, from doubles, err by 1.01 u of themselves.
 * 4. |a q.x + b q.y - z| errs by (|a| + |b|) (E + 4.1 u (r + E)) + 5.3 u beside that of these slopes. The latter differs from what
 *    dt_plane_off gives by less than 4 of the plane's `doubt`.
 *
 * The bounds below are 1.2 times that. The least float covers underflow. */
#ifndef DT_COARSE_H
#define DT_COARSE_H

#include "core/exact/lanes.h"
#include "core/thinning/plane.h"

enum { DT_COARSE_SECTORS = 16, DT_COARSE_POINTS = 64 };

struct dt_coarse {
    uint32_t n;
    uint32_t half;        /* as in struct dt_share */
    struct dt_rounded at; /* the centre */
    double reach;         /* r */
    float x[DT_COARSE_SECTORS], y[DT_COARSE_SECTORS], doubt[DT_COARSE_SECTORS];   /* of edges */
    float dx[DT_COARSE_SECTORS], dy[DT_COARSE_SECTORS], error[DT_COARSE_SECTORS]; /* of planes */
    /* of the points of each sector, in four parts: how far the worst one is off, and how many they are, negative */
    dt_floats most[DT_COARSE_SECTORS];
    dt_floats_holds count[DT_COARSE_SECTORS];
};

/* Points as seen from the centre. */
struct dt_coarse_points {
    uint32_t n;
    _Alignas(16) float x[DT_COARSE_POINTS];
    _Alignas(16) float y[DT_COARSE_POINTS];
    _Alignas(16) float z[DT_COARSE_POINTS];
    _Alignas(16) uint32_t sector[DT_COARSE_POINTS]; /* DT_NONE: in doubt */
    _Alignas(16) float off[DT_COARSE_POINTS];
};

/* Starts with a star without edges around the sample. */
void dt_coarse_begin(struct dt_coarse *c, const struct dt_samples *s, uint32_t centre);

/* The next edge, which is (x, y), and the plane of the sector that begins there. There are less than DT_COARSE_SECTORS. */
void dt_coarse_add(struct dt_coarse *c, const struct dt_samples *s, double x, double y,
                   const struct dt_plane *p);

/* All edges are there. */
void dt_coarse_end(struct dt_coarse *c, uint32_t half);

/* Finds the sectors of all points. */
void dt_coarse_find(const struct dt_coarse *c, struct dt_coarse_points *p);

/* Finds how far the points are off the planes of their sectors; results err by at most c->error[sector]. Points without a sector are
 * left out. Adds to c->most and c->count. */
void dt_coarse_measure(struct dt_coarse *c, struct dt_coarse_points *p);

/* The distance of the worst point of a sector from the surface, and the number of its points. */
static inline float dt_coarse_most(const struct dt_coarse *c, uint32_t sector)
{
    const dt_floats m = c->most[sector];
    const float a = m[0] > m[1] ? m[0] : m[1], b = m[2] > m[3] ? m[2] : m[3];
    return a > b ? a : b;
}

static inline uint32_t dt_coarse_count(const struct dt_coarse *c, uint32_t sector)
{
    const dt_floats_holds n = c->count[sector];
    return (uint32_t) - (n[0] + n[1] + n[2] + n[3]);
}

static inline void dt_coarse_see(const struct dt_coarse *c, struct dt_coarse_points *p,
                                 const struct dt_rounded *q)
{
    uint32_t i = p->n++;
    p->x[i] = q->x - c->at.x;
    p->y[i] = q->y - c->at.y;
    p->z[i] = q->z - c->at.z;
}

/* The plane of a sector alone. */
struct dt_coarse_plane {
    struct dt_rounded at;
    float dx, dy;
    double error, per_value;
};

static inline struct dt_coarse_plane dt_coarse_plane(const struct dt_coarse *c, uint32_t sector,
                                                     const struct dt_samples *s)
{
    return (struct dt_coarse_plane){c->at, c->dx[sector], c->dy[sector], (double)c->error[sector],
                                    s->per_value};
}

static inline float dt_coarse_plane_off(const struct dt_coarse_plane *p, const struct dt_rounded *q)
{
    return fabsf(p->dx * (q->x - p->at.x) + p->dy * (q->y - p->at.y) - (q->z - p->at.z));
}

/* A point that is off by at least `off` is off by at least that. */
static inline float dt_coarse_least(const struct dt_coarse_plane *p, double off)
{
    return (float)(off * p->per_value * (1 - 0x1p-20) - p->error);
}

#endif
