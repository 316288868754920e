/* shelling.h - the paper's triangulation: grid, third-point search and circular edge list put
 * together. */
#pragma once

#include "core/mesh/mesh.h"
#include "core/shelling/front.h"
#include "core/shelling/grid.h"

/* Triangulates n >= 0 distinct points. The caller's arrays p[n] and from[n] are filled: vertex v of the mesh is
 * p[v] = in[from[v]], in the order of the grid. The mesh must be zeroed, cleared or have reserved room. It is complete on
 * return: 2n - 2 records, ghosts included (none for n < 2). opt may be NULL; its pool is not used. DT_NOMEM,
 * DT_CANCELLED and DT_TOOBIG leave *m cleared.
 *
 * Cost: linear expected on evenly spread points, 40 bytes a point besides the mesh. If very many points are nearly on
 * one line or circle, or on very many scales, the grid does not help and searches look at most points. It returns
 * DT_TOOBIG when the searches have cost about 30 ms and 8 us a point. */
enum dt_status dt_shelling(const struct dt_point *in, uint32_t n, struct dt_point *p,
                           uint32_t *from, struct dt_mesh *m, const struct dt_options *opt);

/* The same before an observer, to whom places are reported: the index of a point in in[] is from[place]. It
 * never gives up. */
enum dt_status dt_shelling_observed(const struct dt_point *in, uint32_t n, struct dt_point *p,
                                    uint32_t *from, struct dt_mesh *m, const struct dt_options *opt,
                                    const struct dt_observer *observer);

/* ---- its parts, for tests ---- */

struct dt_shell {
    struct dt_stop stop;
    struct dt_grid grid;                /* owns */
    struct dt_front front;              /* owns */
    struct dt_mesh *mesh;               /* borrows */
    const struct dt_observer *observer; /* borrows; NULL: none */
};

/* Does all of the above, except the links between ghosts, for n >= 2 points. In p[], points that have left the grid are
 * NaN. If *line, all points are on one line, and the mesh has no records yet. *s must be zeroed. Call dt_shell_clear in
 * any case. */
enum dt_status dt_shell_grow(struct dt_shell *s, const struct dt_point *in, uint32_t n,
                             struct dt_point *p, uint32_t *from, struct dt_mesh *m,
                             const struct dt_options *opt, bool *line);
void dt_shell_clear(struct dt_shell *s);

/* Links the ghosts along the convex hull, which is walked by the grid-structure-based method of the
 * paper: from any point that remains in the grid along the pointers to the next one. */
void dt_shell_close(struct dt_shell *s);
