/* constrain.h - constraints and the mesh: what the edits of a set with constraints share. */
#pragma once

#include "core/set/set.h"

/* Enforces the constraints of t in its mesh, which has just been built. DT_CROSSES: dt_crossed names the first constraint,
 * in their order, that crosses an earlier one, and the least of these. After a failure the mesh must be built again. */
enum dt_status dt_constrain_all(struct dt *t, struct dt_stop *stop);

/* The constraint of the row, between vertices a and b, becomes a chain of edges, or is released; the mesh is current.
 * DT_CROSSES names nothing. */
enum dt_status dt_constrain_row(struct dt *t, uint32_t row, uint32_t a, uint32_t b,
                                struct dt_stop *work);
void dt_release_row(struct dt *t, uint32_t row);

/* The constraints of all live rows from `from` on become chains of edges. done, unless NULL, gets the *made rows that have
 * become chains, also on a failure. Fails as dt_constrain_row does. */
enum dt_status dt_constrain_in_order(struct dt *t, uint32_t from, uint32_t *done, size_t *made,
                                     struct dt_stop *stop);

/* Looks at the constraints at id, and at those that they would cross as the mesh is. Returns DT_CROSSES, or fails. dt_crossed
 * will name the first of them, in their order, that crosses an earlier one, and the least of these. Cost: the
 * constraints, for each one at id. */
enum dt_status dt_name_crossed(struct dt *t, uint32_t id, struct dt_stop *work);

/* Whether the constraints can be declared, as dt_constrain says, even if they cross others. */
enum dt_status dt_constrainable(const struct dt *t, const struct dt_constraint *c, size_t n,
                                uint32_t *missing);

/* To be called when the vertex of id has moved with its constraints. */
void dt_forget_regions(struct dt *t, uint32_t id);

/* Whether id is an end of a constraint. */
static inline bool dt_is_end(const struct dt *t, uint32_t id)
{
    return t->constraints != NULL && dt_declared_first(&t->constraints->declared, id) != DT_NONE;
}

/* To be called after constraints have been removed: without any the set is as if there had been none. */
void dt_constraints_tidy(struct dt *t);

/* dt_update_delete and dt_update_move of a set with constraints that is triangulated; the ids of the former are no
 * ends. */
enum dt_status dt_constrained_delete(struct dt *t, const uint32_t *ids, size_t n,
                                     const struct dt_options *opt);
enum dt_status dt_constrained_move(struct dt *t, uint32_t id, struct dt_point to,
                                   const struct dt_options *opt);
