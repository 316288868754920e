/* refined.c - a mesh to order, as the arrays of which it can be made. */
#include <stdlib.h>
#include <string.h>

#include "core/arrays/arrays.h"
#include "core/arrays/workers.h"

/* The constraints that there are, without those that are released, and those that are added. */
static enum dt_status list_constraints(const struct dt *t, const struct dt_split *s,
                                       struct dt_arrays_refined *out)
{
    struct dt_constraint *all;
    size_t n, kept = 0;
    enum dt_status status = dt_constraints(t, NULL, DT_NONE, &all, &n);
    if (status != DT_OK)
        return status;
    out->constraint = malloc((n + s->n_added + 1) * sizeof *all);
    for (size_t i = 0; out->constraint != NULL && i < n; i++)
        if (!dt_constraint_among(s->released, s->n_released, &all[i]))
            out->constraint[kept++] = all[i];
    free(all);
    if (out->constraint == NULL)
        return DT_NOMEM;
    if (s->n_added > 0)
        memcpy(out->constraint + kept, s->added, s->n_added * sizeof *s->added);
    out->constraints = kept + s->n_added;
    qsort(out->constraint, out->constraints, sizeof *out->constraint, dt_constraint_compare);
    return DT_OK;
}

static enum dt_status list_points(const struct dt *t, const struct dt_split *s,
                                  struct dt_arrays_refined *out)
{
    const uint32_t n = dt_next_id(t);
    out->point = malloc((n + s->n_points + 1) * sizeof *out->point);
    if (out->point == NULL)
        return DT_NOMEM;
    for (uint32_t id = 0; id < n; id++)
        (void)dt_get(t, id, &out->point[id]);
    if (s->n_points > 0)
        memcpy(out->point + n, s->point, s->n_points * sizeof *s->point);
    out->points = n + s->n_points;
    return DT_OK;
}

enum dt_status dt_arrays_refine(const struct dt_arrays *a, const struct dt_quality *q,
                                struct dt_arrays_refined *out)
{
    fenv_t caller = dt_call_begin();
    struct dt_refined r;
    struct dt_quality quality = *q;
    quality.reserve = NULL;
    memset(out, 0, sizeof *out);
    enum dt_status status = dt_plan_refine(a->t, &quality, NULL, &r);
    if (status == DT_OK)
        status = list_points(a->t, &r.change, out);
    if (status == DT_OK)
        status = list_constraints(a->t, &r.change, out);
    out->added = r.change.n_points;
    out->split = r.change.split;
    out->unrefined = r.unrefined;
    out->hull = r.hull;
    out->angle = r.angle;
    dt_split_clear(&r.change);
    if (status != DT_OK) {
        free(out->point);
        free(out->constraint);
        memset(out, 0, sizeof *out);
    }
    dt_call_end(&caller);
    return status;
}
