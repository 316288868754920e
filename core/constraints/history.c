/* history.c - see history.h. */
#include "core/constraints/history.h"

#include <stdlib.h>
#include <string.h>

void dt_history_clear(struct dt_history *h)
{
    free(h->change);
    *h = (struct dt_history){.first = dt_history_now(h)};
}

void dt_history_trim(struct dt_history *h, uint64_t from)
{
    size_t gone = from <= h->first ? 0 : from - h->first < h->n ? (size_t)(from - h->first) : h->n;
    if (gone == h->n) {
        dt_history_clear(h);
    } else if (gone > h->n / 2) {
        memmove(h->change, h->change + gone, (h->n - gone) * sizeof *h->change);
        h->n -= gone;
        h->first += gone;
    }
}

enum dt_status dt_history_reserve(struct dt_history *h, size_t n)
{
    if (n <= h->cap - h->n)
        return DT_OK;
    size_t cap = h->n + n < 2 * h->cap ? 2 * h->cap : h->n + n;
    struct dt_history_change *change = realloc(h->change, cap * sizeof *change);
    if (change == NULL)
        return DT_NOMEM;
    h->change = change;
    h->cap = cap;
    return DT_OK;
}

void dt_history_note(struct dt_history *h, struct dt_constraint what, bool added)
{
    h->change[h->n++] = (struct dt_history_change){what, added};
}

/* A change of a constraint, and its place among all. */
struct numbered {
    struct dt_constraint what; /* first: dt_constraint_compare */
    bool added;
    size_t number;
};

static int compare_numbered(const void *a, const void *b)
{
    const struct numbered *p = a, *q = b;
    int sign = dt_constraint_compare(&p->what, &q->what);
    return sign != 0 ? sign : (p->number > q->number) - (p->number < q->number);
}

/* The first changes of every constraint since the moment, sorted: *k of them; the caller frees them. */
static struct numbered *first_changes(const struct dt_history *h, size_t from, size_t *k)
{
    struct numbered *c = malloc((h->n - from + 1) * sizeof *c);
    if (c == NULL)
        return NULL;
    for (size_t i = from; i < h->n; i++)
        c[i - from] = (struct numbered){h->change[i].what, h->change[i].added, i};
    qsort(c, h->n - from, sizeof *c, compare_numbered);
    *k = 0;
    for (size_t i = 0; i < h->n - from; i++)
        if (i == 0 || dt_constraint_compare(&c[i].what, &c[*k - 1].what) != 0)
            c[(*k)++] = c[i];
    return c;
}

enum dt_status dt_history_undo(const struct dt_history *h, uint64_t moment,
                               struct dt_constraint **rows, size_t *n)
{
    size_t from = moment > h->first ? (size_t)(moment - h->first) : 0, changes, kept = 0;
    if (from >= h->n)
        return DT_OK;
    struct numbered *c = first_changes(h, from, &changes);
    struct dt_constraint *r = c == NULL ? NULL : realloc(*rows, (*n + changes + 1) * sizeof *r);
    if (r == NULL) {
        free(c);
        return DT_NOMEM;
    }
    for (size_t i = 0; i < *n; i++)
        if (bsearch(&r[i], c, changes, sizeof *c, dt_constraint_compare) == NULL)
            r[kept++] = r[i];
    for (size_t i = 0; i < changes; i++)
        if (!c[i].added)
            r[kept++] = c[i].what;
    qsort(r, kept, sizeof *r, dt_constraint_compare);
    free(c);
    *rows = r;
    *n = kept;
    return DT_OK;
}
