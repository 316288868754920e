/* constraint_rows.c - see constraint_rows.h. */
#include "server/rows/constraint_rows.h"

#include "core/delaunay_constraints.h"
#include "server/changes/constraint.h"
#include "server/rows/rows.h"

#include <stdlib.h>
#include <string.h>

/* Appends the words of n constraints, without those of other numbers unless that is DT_NONE. */
static enum dt_status append(const struct dt_constraint *c, size_t n, uint32_t number,
                             struct dt_ids *ids)
{
    size_t words = ids->n + n * ROW_CONSTRAINT_WORDS;
    size_t cap = words <= ids->cap ? ids->cap : words + words / 2;
    uint32_t *v = cap == ids->cap ? ids->v : realloc(ids->v, cap * sizeof *v);
    if (v == NULL)
        return n == 0 ? DT_OK : DT_NOMEM;
    ids->v = v;
    ids->cap = cap;
    for (size_t i = 0; i < n; i++) {
        if (number != DT_NONE && c[i].number != number)
            continue;
        v[ids->n++] = c[i].a;
        v[ids->n++] = c[i].b;
        v[ids->n++] = constraint_what(c[i].border, c[i].number);
    }
    return DT_OK;
}

static int by_words(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    for (int i = 0; i < 2; i++)
        if (x[i] != y[i])
            return x[i] < y[i] ? -1 : 1;
    bool border = (x[2] & 1) != 0;
    if (border != ((y[2] & 1) != 0))
        return border ? 1 : -1;
    return (x[2] > y[2]) - (x[2] < y[2]);
}

/* Sorts rows, and removes repeated ones. */
static void sort(struct dt_ids *ids)
{
    enum { WORDS = ROW_CONSTRAINT_WORDS };
    size_t n = 0;
    if (ids->n > 0)
        qsort(ids->v, ids->n / WORDS, WORDS * sizeof *ids->v, by_words);
    for (size_t i = 0; i < ids->n; i += WORDS) {
        if (i > 0 && by_words(ids->v + i, ids->v + n - WORDS) == 0)
            continue;
        memmove(ids->v + n, ids->v + i, WORDS * sizeof *ids->v);
        n += WORDS;
    }
    ids->n = n;
}

enum dt_status constraint_rows_at(const struct dt *dt, const struct dt_options *opt,
                                  struct dt_ids *ids)
{
    struct dt_ids words = {0};
    enum dt_status status = DT_OK;
    for (size_t i = 0; i < ids->n && status == DT_OK; i++) {
        struct dt_constraint *c;
        size_t n, most = opt->steps == 0 ? SIZE_MAX : opt->steps;
        if (dt_constraints_at(dt, ids->v[i], most) + words.n / ROW_CONSTRAINT_WORDS >= most)
            status = DT_TOOLONG;
        if (status == DT_OK)
            status = dt_constraints(dt, NULL, ids->v[i], &c, &n);
        if (status != DT_OK)
            break;
        status = append(c, n, DT_NONE, &words);
        free(c);
    }
    if (status != DT_OK) {
        free(words.v);
        return status;
    }
    sort(&words);
    free(ids->v);
    *ids = words;
    return DT_OK;
}

enum dt_status constraint_rows_read(const struct dt *dt, const struct dt_view *view,
                                    uint32_t number, uint32_t *from, size_t steps,
                                    struct dt_ids *ids)
{
    struct dt_constraint_list list = {.n = 0};
    enum dt_status status = dt_constraints_read(dt, view, from, steps, &list);
    if (status == DT_OK)
        status = append(list.v, list.n, number, ids);
    free(list.v);
    return status;
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
