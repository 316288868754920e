/* scope.h - the part of a set that a watcher wants to know: the points in a box or all of them, the values of some fields.
 * Constraints belong to it if they meet the box, or without a box all of them. */
#pragma once

#include "core/delaunay_constraints.h"
#include "core/delaunay_fields.h"

/* Start with {0}: all points, no values. */
struct scope {
    char *names; /* owns; of fields, separated by commas; NULL: none */
    bool constraints;
    bool boxed;
    struct dt_point lo, hi; /* the closed box */
    /* The fields as they were found last; NULL: there is none of that name. */
    uint32_t fields;
    const struct dt_field *field[DT_MAX_FIELDS]; /* borrowed from the set until its next edit */
    uint32_t number[DT_MAX_FIELDS];              /* DT_NONE: there was none */
};

void scope_clear(struct scope *s);

/* Whether both ask for the same. */
bool scope_equal(const struct scope *a, const struct scope *b);

/* Finds the fields in the set. */
void scope_find(struct scope *s, const struct dt *dt);

/* Whether a key of dt_touched_take_values is about one of its fields. */
bool scope_has_value(const struct scope *s, uint64_t key);

/* Whether a point belongs to it: it is there, and if there is a box, it is a representative in it, as for WITHIN. */
bool scope_has_point(const struct scope *s, const struct dt *dt, uint32_t id, struct dt_point *p);

/* Whether a constraint between these places belongs to it. */
static inline bool scope_has_segment(const struct scope *s, const struct dt_point at[2])
{
    return !s->boxed || dt_segment_meets_box(at[0], at[1], s->lo, s->hi);
}
