/* constraint.c - see constraint.h. */
#include "server/changes/constraint.h"

#include <stdlib.h>

struct dt_constraint *constraint_listed(const struct record_constraint *c, size_t n)
{
    struct dt_constraint *to = malloc((n + 1) * sizeof *to);
    for (size_t i = 0; to != NULL && i < n; i++)
        to[i] = constraint_of(&c[i]);
    return to;
}

enum dt_status constraint_declare(struct dt *dt, const struct record_constraint *c, size_t n,
                                  const struct dt_options *opt, size_t *added, uint32_t *missing)
{
    struct dt_constraint *v = constraint_listed(c, n);
    enum dt_status status = v == NULL ? DT_NOMEM : dt_constrain(dt, v, n, opt, added, missing);
    free(v);
    return status;
}

/* Takes v over. */
static enum dt_status release(struct dt *dt, struct dt_constraint *v, size_t n,
                              const struct dt_options *opt, size_t *released,
                              struct dt_constraint *missing)
{
    size_t at = 0;
    enum dt_status status = v == NULL ? DT_NOMEM : dt_release(dt, v, n, opt, released, &at);
    if (status == DT_NOCONSTRAINT)
        *missing = v[at];
    free(v);
    return status;
}

enum dt_status constraint_release(struct dt *dt, const struct record_constraint *c, size_t n,
                                  const struct dt_options *opt, size_t *released,
                                  struct dt_constraint *missing)
{
    return release(dt, constraint_listed(c, n), n, opt, released, missing);
}

enum dt_status constraint_release_of(struct dt *dt, bool all, uint32_t what,
                                     const struct dt_options *opt, size_t *released,
                                     struct dt_constraint *missing)
{
    struct dt_constraint *v;
    size_t n, kept = 0;
    enum dt_status status = dt_constraints(dt, NULL, DT_NONE, &v, &n);
    if (status != DT_OK)
        return status;
    for (size_t i = 0; i < n; i++)
        if (all || constraint_what(v[i].border, v[i].number) == what)
            v[kept++] = v[i];
    if (kept > 0 || all)
        return release(dt, v, kept, opt, released, missing);
    free(v);
    *missing = (struct dt_constraint){DT_NONE, DT_NONE, what & 1, what >> 1};
    return DT_NOCONSTRAINT;
}

size_t constraint_declare_memory(const struct dt *dt, uint32_t n)
{
    size_t row = sizeof(struct dt_constraint) + sizeof(struct record_constraint);
    return n * row + dt_constrain_memory(dt, n);
}

size_t constraint_release_memory(const struct dt *dt, uint32_t n)
{
    size_t rows = n == DT_NONE ? dt_constraints_count(dt) : n;
    size_t row = sizeof(struct dt_constraint) + sizeof(struct record_constraint);
    return rows * (row + sizeof(uint32_t));
}
