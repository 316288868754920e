/* constraint_rows.c - the constraints of a set, now or at an earlier moment, in their order; see
 * core/delaunay_constraints.h. */
#include "core/set/set.h"

#include <stdlib.h>

uint32_t dt_constraints_count(const struct dt *t)
{
    return t->constraints == NULL ? 0 : t->constraints->declared.rows;
}

bool dt_constraint_has(const struct dt *t, const struct dt_constraint *c)
{
    return dt_is_constrained(t) && dt_declared_find(&t->constraints->declared, c) != DT_NONE;
}

/* ---- those of an id ---- */

size_t dt_constraints_at(const struct dt *t, uint32_t id, size_t most)
{
    size_t n = 0;
    const struct dt_declared *d = t->constraints == NULL ? NULL : &t->constraints->declared;
    uint32_t row = d == NULL ? DT_NONE : dt_declared_first(d, id);
    for (; row != DT_NONE && n < most; row = dt_declared_next(d, row, id))
        n++;
    return n;
}

/* Sorts the list from the place on. */
static void sort(struct dt_constraint_list *list, size_t first)
{
    if (list->n > first + 1)
        qsort(list->v + first, list->n - first, sizeof *list->v, dt_constraint_compare);
}

/* Appends the constraints that end at the id now, or whose smaller end it is, in no order. *steps grows by 1 for each one
 * that ends at the id. */
static enum dt_status append_now(const struct dt_declared *d, uint32_t id, bool smaller,
                                 struct dt_constraint_list *out, size_t *steps)
{
    enum dt_status status = DT_OK;
    for (uint32_t row = dt_declared_first(d, id); row != DT_NONE && status == DT_OK;
         row = dt_declared_next(d, row, id)) {
        ++*steps;
        if (!smaller || d->row[row].end[0] == id)
            status = dt_constraint_append(out, dt_declared_get(d, row));
    }
    return status;
}

/* Appends the constraints whose smaller end is the id. */
static enum dt_status append_sorted(const struct dt *t, const struct dt_view *v, uint32_t id,
                                    struct dt_constraint_list *out, size_t *steps)
{
    size_t first = out->n;
    enum dt_status status = append_now(&t->constraints->declared, id, true, out, steps);
    if (status == DT_OK && v != NULL)
        status = dt_history_undo(&t->constraints->history, v->constraints, id, out, first);
    sort(out, first);
    return status;
}

/* ---- one id after the other ---- */

/* The smallest id >= from that is an end now or has changed. */
static uint32_t next_end(const struct dt *t, const struct dt_view *v, uint32_t from)
{
    const struct dt_declared *d = &t->constraints->declared;
    uint32_t now = d->rows == 0 ? DT_NONE : dt_idmap_next(&d->first, from);
    uint32_t changed = v == NULL ? DT_NONE : dt_history_next(&t->constraints->history, from);
    return now < changed ? now : changed;
}

enum dt_status dt_constraints_read(const struct dt *t, const struct dt_view *v, uint32_t *from,
                                   size_t steps, struct dt_constraint_list *out)
{
    enum dt_status status = DT_OK;
    uint32_t id = t->constraints == NULL ? DT_NONE : next_end(t, v, *from);
    for (size_t taken = 0; id != DT_NONE && taken < steps && status == DT_OK; taken++) {
        status = append_sorted(t, v, id, out, &taken);
        id = next_end(t, v, id + 1);
    }
    *from = id;
    return status;
}

/* ---- all ---- */

/* Removes those that do not end at the id. */
static void keep_those_at(struct dt_constraint_list *list, uint32_t id)
{
    size_t kept = 0;
    for (size_t i = 0; i < list->n; i++)
        if (list->v[i].a == id || list->v[i].b == id)
            list->v[kept++] = list->v[i];
    list->n = kept;
}

enum dt_status dt_constraints(const struct dt *t, const struct dt_view *v, uint32_t id,
                              struct dt_constraint **rows, size_t *n)
{
    struct dt_constraint_list list = {NULL, 0, 0};
    uint32_t from = 0;
    size_t steps = 0;
    enum dt_status status = DT_OK;
    if (id != DT_NONE && v == NULL && dt_is_constrained(t)) {
        status = append_now(&t->constraints->declared, id, false, &list, &steps);
        sort(&list, 0);
    } else {
        status = dt_constraints_read(t, v, &from, SIZE_MAX, &list);
        if (id != DT_NONE)
            keep_those_at(&list, id);
    }
    if (status == DT_OK && list.v == NULL && (list.v = malloc(sizeof *list.v)) == NULL)
        status = DT_NOMEM;
    if (status != DT_OK)
        free(list.v);
    *rows = status == DT_OK ? list.v : NULL;
    *n = status == DT_OK ? list.n : 0;
    return status;
}
