/* delaunay_constraints.h - the core's public header for constraints: straight segments between points that the
 * triangulation keeps; see delaunay.h.
 *
 * A constraint is a pair of ids, a kind and a number. It stands between the representatives of its ids; if both have
 * the same, it has no edges. The triangulation of a set with constraints is the constrained Delaunay triangulation:
 * every constraint is an edge, or a chain of edges through the vertices that lie exactly on it; every other edge is
 * locally Delaunay under the symbolic perturbation (delaunay.h). It is the only such triangulation, so it depends on
 * the representatives' coordinates and the constraints alone [Agarwal, Arge & Yi 2005; Shewchuk & Brown 2015].
 *
 * Constraints may share ends, touch, overlap, and run through vertices. Two that cross where no vertex is are refused
 * (DT_CROSSES), by every function that would make them cross; dt_crossed names them. In a set that has not been
 * triangulated, constraints are recorded, and dt_triangulate refuses those that cross.
 *
 * A set without constraints pays nothing for them. With constraints, cells, areas, alpha shapes and natural neighbours
 * are refused (DT_NOTDELAUNAY). */
#ifndef DT_DELAUNAY_CONSTRAINTS_H
#define DT_DELAUNAY_CONSTRAINTS_H

#include "core/delaunay.h"

#ifdef __cplusplus
extern "C" {
#endif

#define DT_MAX_CONSTRAINTS (1u << 28) /* of one set */
#define DT_MAX_NUMBER (INT32_MAX)     /* of a constraint */

struct dt_constraint {
    uint32_t a, b;   /* ids */
    bool border;     /* it is a part of the border of a region; else a line */
    uint32_t number; /* of the line or region, at most DT_MAX_NUMBER */
};

/* Two constraints that cross, each a < b. */
struct dt_crossed {
    struct dt_constraint one, other;
};

/* Declares n constraints, all or none. The same one again changes nothing; *added counts the others. In a set that is
 * triangulated they are kept from now on. DT_NOPOINT puts an id that is missing into *missing, and DT_NOEDGE one that
 * is both ends; DT_RANGE: a number is too large; DT_TOOBIG: too many constraints; DT_CROSSES: of the first, in the
 * order of c[], that crosses one before it or an existing one, and the least of these. A set whose triangulation
 * awaits dt_refresh gets that first. opt may be NULL: steps and its flag. Cost of each: the edges that it crosses, and
 * their logarithm. */
enum dt_status dt_constrain(struct dt *t, const struct dt_constraint *c, size_t n,
                            const struct dt_options *opt, size_t *added, uint32_t *missing);

/* Releases n constraints, all or none; one named twice is released once, *released counts distinct ones.
 * DT_NOCONSTRAINT puts the index of the first that is not there into *missing. */
enum dt_status dt_release(struct dt *t, const struct dt_constraint *c, size_t n,
                          const struct dt_options *opt, size_t *released, size_t *missing);

/* An upper bound of the bytes that dt_constrain of n constraints touches at its peak beyond dt_summary.memory. */
size_t dt_constrain_memory(const struct dt *t, size_t n);

/* How many there are. */
uint32_t dt_constraints_count(const struct dt *t);

/* All constraints, or those with the end `id` unless that is DT_NONE, now or at the moment of a view, in an array that
 * *rows is set to and the caller frees: a < b, sorted by a, b, lines before borders, number. */
enum dt_status dt_constraints(const struct dt *t, const struct dt_view *v, uint32_t id,
                              struct dt_constraint **rows, size_t *n);

/* Appends the pairs a < b, sorted, of the edges that are parts of constraints. */
enum dt_status dt_constrained_edges(const struct dt *t, struct dt_ids *out);

/* The constraints that the last DT_CROSSES was about. */
void dt_crossed(const struct dt *t, struct dt_crossed *out);

/* dt_delete_many of points that may be ends of constraints, which are released. (dt_delete_many refuses such an id:
 * DT_CONSTRAINED, and puts it into *missing.) */
enum dt_status dt_delete_cascade(struct dt *t, const uint32_t *ids, size_t n,
                                 const struct dt_options *opt, uint32_t *deleted,
                                 uint32_t *missing);

/* Moves n points with distinct ids, all or none, judged as a whole. DT_NOPOINT puts an id that is missing, or named
 * twice, into *missing. Cost: as dt_move of each; where constraints are in the way, up to two builds. */
enum dt_status dt_move_many(struct dt *t, const uint32_t *ids, const struct dt_point *to, size_t n,
                            const struct dt_options *opt, uint32_t *missing);

#ifdef __cplusplus
}
#endif

#endif
