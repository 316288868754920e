/* shelling.h - the paper's triangulation: grid, third-point search and circular edge list put
 * together. */
#ifndef DT_SHELLING_H
#define DT_SHELLING_H

#include "core/mesh/mesh.h"
#include "core/shelling/front.h"
#include "core/shelling/grid.h"

/* Triangulates n >= 0 distinct points. p[n] and from[n] are the caller's and are filled: vertex v
 * of the mesh is p[v] = in[from[v]], in the order of the grid. *m comes zeroed, cleared or with
 * reserved room, and is complete on return: 2n - 2 records, ghosts included (none for n < 2). opt
 * may be NULL; its pool is not used. DT_NOMEM, DT_CANCELLED and DT_TOOBIG leave *m cleared.
 *
 * Cost: linear expected on evenly spread points, 40 bytes a point besides the mesh. Where very many
 * points are nearly on one line or circle, or on very many scales, the grid does not help and searches look at
 * most of them: it returns DT_TOOBIG when that has cost about 30 ms and 8 us a point. */
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

/* All of the above but the links between ghosts, for n >= 2 points; in p[], those that no longer
 * remain in the grid are NaN. *line: all points are on one line, in which case the mesh
 * has no records yet. *s must be zeroed; dt_shell_clear it in any case. */
enum dt_status dt_shell_grow(struct dt_shell *s, const struct dt_point *in, uint32_t n,
                             struct dt_point *p, uint32_t *from, struct dt_mesh *m,
                             const struct dt_options *opt, bool *line);
void dt_shell_clear(struct dt_shell *s);

/* Links the ghosts along the convex hull, which is walked by the grid-structure-based method of the
 * paper: from any point that remains in the grid along the pointers to the next one. */
void dt_shell_close(struct dt_shell *s);

#endif
