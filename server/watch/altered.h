/* altered.h - the constraints that have changed lately: edits have declared or released them, or have moved one of their
 * ends. They are numbered from 0; the oldest ones are forgotten. */
#pragma once

#include "core/delaunay_constraints.h"

enum { ALTERED_MOST = 16384 }; /* 0.9 MB */

/* Start with {0}. */
struct altered {
    struct dt_touched_constraint *row; /* owns: those with the numbers `first` to end - 1 */
    size_t cap;
    uint64_t first, end;
};

/* These have changed. If there is no memory for them, everything is forgotten. */
void altered_put(struct altered *r, const struct dt_touched_constraint *c, size_t n);

/* Any constraint may have changed: all rows with a number before the end are forgotten. */
void altered_forget(struct altered *r);

/* Returns a constraint that is remembered. */
static inline const struct dt_touched_constraint *altered_at(const struct altered *r, uint64_t n)
{
    return &r->row[n - r->first];
}

static inline size_t altered_memory(const struct altered *r)
{
    return r->cap * sizeof *r->row;
}

void altered_clear(struct altered *r);
