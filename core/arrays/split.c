/* split.c - constraints that would cross, in arrays: what gives them points in common. */
#include <string.h>

#include "core/arrays/workers.h"
#include "core/delaunay_arrays.h"

enum { CROSSINGS = 1 << 26 }; /* of a round, at most */

static enum dt_status plan(struct dt *t, const struct dt_point *p, const double *z, size_t n,
                           const struct dt_constraint *c, size_t constraints, struct dt_split *out,
                           uint32_t *wrong)
{
    static const char name[] = "z";
    struct dt_added added;
    uint32_t missing;
    enum dt_status s = dt_add_many(t, p, n, NULL, &added);
    if (s == DT_OK && z != NULL)
        s = dt_field_set_run(t, name, sizeof name - 1, 0, z, n, NULL, &missing);
    if (s == DT_OK)
        s = dt_plan_split(t, c, constraints, CROSSINGS, NULL, out, wrong);
    if (s == DT_CROSSES) {
        const struct dt_crossed *two = &out->crossed;
        memcpy(wrong, (uint32_t[]){two->one.a, two->one.b, two->other.a, two->other.b},
               4 * sizeof *wrong);
    }
    return s;
}

enum dt_status dt_arrays_split(const struct dt_point *p, const double *z, size_t n,
                               const struct dt_constraint *c, size_t constraints,
                               struct dt_split *out, uint32_t wrong[4])
{
    fenv_t caller = dt_call_begin();
    struct dt *t = dt_new(0);
    *out = (struct dt_split){0};
    enum dt_status s = t == NULL ? DT_NOMEM : plan(t, p, z, n, c, constraints, out, wrong);
    dt_free(t);
    dt_call_end(&caller);
    return s;
}
