/* constraints.h - what a set has if it has constraints: those declared, and scratch memory of edits. */
#pragma once

#include "core/constraints/declared.h"
#include "core/constraints/enforce.h"
#include "core/constraints/history.h"
#include "core/constraints/regions.h"

struct dt_constraints {
    struct dt_declared declared;
    struct dt_enforcer enforcer;
    struct dt_history history; /* of those declared, for views */
    struct dt_regions regions; /* of those declared; empty after a change of borders */
    struct dt_crossed crossed; /* see dt_crossed */
};

/* None are declared; its large arrays come from the keeper, which may be NULL. NULL: out of memory. The caller owns it. */
struct dt_constraints *dt_constraints_new(struct dt_pages *pages);

/* NULL is allowed, also as what is copied. */
void dt_constraints_free(struct dt_constraints *c);
size_t dt_constraints_memory(const struct dt_constraints *c);

/* Copies the declared constraints into a new *copy. */
enum dt_status dt_constraints_copy(const struct dt_constraints *c, struct dt_constraints **copy);
