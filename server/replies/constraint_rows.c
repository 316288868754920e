/* constraint_rows.c - see constraint_rows.h. */
#include "server/replies/constraint_rows.h"

#include "core/delaunay_constraints.h"
#include "server/changes/constraint.h"
#include "server/sets/rows.h"

#include <stdlib.h>

static int by_id(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* ids ascending, or none. */
static bool is_chosen(const struct dt_constraint *c, uint32_t number, const struct dt_ids *ids)
{
    if (ids->n == 0)
        return number == DT_NONE || c->number == number;
    return bsearch(&c->a, ids->v, ids->n, sizeof *ids->v, by_id) != NULL ||
           bsearch(&c->b, ids->v, ids->n, sizeof *ids->v, by_id) != NULL;
}

enum dt_status constraint_rows(const struct dt *dt, uint32_t number, const struct dt_options *opt,
                               struct dt_ids *ids)
{
    struct dt_constraint *v;
    size_t n, words = 0;
    if (opt->steps > 0 && dt_constraints_count(dt) > opt->steps)
        return DT_TOOLONG;
    enum dt_status status = dt_constraints(dt, NULL, ids->n == 1 ? ids->v[0] : DT_NONE, &v, &n);
    uint32_t *to = status == DT_OK ? malloc((n + 1) * ROW_CONSTRAINT_WORDS * sizeof *to) : NULL;
    if (to == NULL) {
        free(v);
        return DT_NOMEM;
    }
    if (ids->n > 1)
        qsort(ids->v, ids->n, sizeof *ids->v, by_id);
    for (size_t i = 0; i < n; i++) {
        if (!is_chosen(&v[i], number, ids))
            continue;
        to[words++] = v[i].a;
        to[words++] = v[i].b;
        to[words++] = constraint_what(v[i].border, v[i].number);
    }
    free(v);
    free(ids->v);
    *ids = (struct dt_ids){to, words, (n + 1) * ROW_CONSTRAINT_WORDS};
    return DT_OK;
}

enum dt_status constraint_edges(const struct dt *dt, const struct dt_options *opt,
                                struct dt_ids *ids)
{
    struct dt_summary sum;
    dt_summary(dt, &sum);
    if (opt->steps > 0 && sum.edges > opt->steps)
        return DT_TOOLONG;
    return dt_constrained_edges(dt, ids);
}
