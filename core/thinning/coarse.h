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
#pragma once

#include "core/exact/lanes.h"
#include "core/thinning/plane.h"

enum { DT_COARSE_SECTORS = 16 };

struct dt_coarse {
    uint32_t n;
    uint32_t half;                                        /* as in struct dt_share */
    struct dt_rounded at;                                 /* the centre */
    double reach;                                         /* r */
    dt_floats x[DT_COARSE_SECTORS], y[DT_COARSE_SECTORS]; /* of edges, the same in all lanes */
    dt_floats doubt[DT_COARSE_SECTORS];
    float dx[DT_COARSE_SECTORS], dy[DT_COARSE_SECTORS], error[DT_COARSE_SECTORS]; /* of planes */
    /* the bits in which the slopes differ from those of the sector before */
    dt_floats_holds turn_dx[DT_COARSE_SECTORS], turn_dy[DT_COARSE_SECTORS];
    /* of the points of each sector: how far the worst one is off, and how many they are */
    float most[DT_COARSE_SECTORS];
    uint32_t count[DT_COARSE_SECTORS];
};

/* Starts with a star without edges around the sample. */
void dt_coarse_begin(struct dt_coarse *c, const struct dt_samples *s, uint32_t centre);

/* The next edge, which leads to `way`, and the plane of the sector behind that edge. There are less than DT_COARSE_SECTORS. */
void dt_coarse_add(struct dt_coarse *c, const struct dt_samples *s, struct dt_point way,
                   const struct dt_plane *p);

/* All edges are there. */
void dt_coarse_end(struct dt_coarse *c, uint32_t half);

/* Finds the sectors of n points; DT_NONE: in doubt. Finds how far they are off the planes of these sectors, with errors of at most
 * c->error[sector]. Arrays are aligned to 16, and have items up to a multiple of four. */
void dt_coarse_find(const struct dt_coarse *c, const struct dt_rounded *point, uint32_t n,
                    uint32_t *sector, float *off);

/* Adds the points to c->most and c->count. Points without a sector are left out. */
void dt_coarse_tally(struct dt_coarse *c, uint32_t n, const uint32_t *sector, const float *off);
