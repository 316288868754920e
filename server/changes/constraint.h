/* constraint.h - constraints as they are in records, declared and released. */
#pragma once

#include "core/delaunay_constraints.h"
#include "proto/records/record.h"

/* The `a` of a RECORD_RELEASE gives the kind of release. */
enum { RELEASE_LISTED, RELEASE_NUMBER, RELEASE_ALL };

/* As they are in records, and in the core. */
static inline uint32_t constraint_what(bool border, uint32_t number)
{
    return number << 1 | border;
}

static inline struct dt_constraint constraint_of(const struct record_constraint *r)
{
    return (struct dt_constraint){r->a, r->b, (r->what & 1) != 0, r->what >> 1};
}

static inline struct record_constraint constraint_record(const struct dt_constraint *c)
{
    return (struct record_constraint){c->a, c->b, constraint_what(c->border, c->number)};
}

/* As the core takes them, in an array from malloc; NULL: out of memory. */
struct dt_constraint *constraint_listed(const struct record_constraint *c, size_t n);

/* dt_constrain of these. */
enum dt_status constraint_declare(struct dt *dt, const struct record_constraint *c, size_t n,
                                  const struct dt_options *opt, size_t *added, uint32_t *missing);

/* dt_release of these. DT_NOCONSTRAINT: *missing is the first constraint that does not exist. */
enum dt_status constraint_release(struct dt *dt, const struct record_constraint *c, size_t n,
                                  const struct dt_options *opt, size_t *released,
                                  struct dt_constraint *missing);

/* Releases the constraints of a kind and a number, or all. DT_NOCONSTRAINT: there are none; *missing has both, and no ends (DT_NONE). */
enum dt_status constraint_release_of(struct dt *dt, bool all, uint32_t what,
                                     const struct dt_options *opt, size_t *released,
                                     struct dt_constraint *missing);

/* Upper bounds of the bytes that declaring n constraints takes at its peak beyond the set's memory, and releasing n, or of
 * DT_NONE, chosen ones. */
size_t constraint_declare_memory(const struct dt *dt, uint32_t n);
size_t constraint_release_memory(const struct dt *dt, uint32_t n);
