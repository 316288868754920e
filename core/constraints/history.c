/* history.c - see history.h. */
#include "core/constraints/history.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/memory.h"

void dt_history_clear(struct dt_history *h)
{
    free(h->change);
    dt_idmap_clear(&h->last);
    *h = (struct dt_history){.first = dt_history_now(h)};
}

static void enter(struct dt_history *h, size_t at)
{
    uint32_t id = h->change[at].what.a;
    h->change[at].before = dt_idmap_get(&h->last, id);
    dt_idmap_set(&h->last, id, (uint32_t)at);
}

/* Removes the first changes. */
static void remove_first(struct dt_history *h, size_t gone)
{
    for (size_t i = 0; i < h->n; i++)
        if (dt_idmap_get(&h->last, h->change[i].what.a) != DT_NONE)
            dt_idmap_unset(&h->last, h->change[i].what.a);
    memmove(h->change, h->change + gone, (h->n - gone) * sizeof *h->change);
    h->n -= gone;
    h->first += gone;
    for (size_t i = 0; i < h->n; i++)
        enter(h, i);
    dt_idmap_trim(&h->last);
}

void dt_history_trim(struct dt_history *h, uint64_t from)
{
    size_t gone = from <= h->first ? 0 : from - h->first < h->n ? (size_t)(from - h->first) : h->n;
    if (gone == h->n)
        dt_history_clear(h);
    else if (gone > h->n / 2)
        remove_first(h, gone);
}

enum dt_status dt_history_reserve(struct dt_history *h, size_t n)
{
    return h->n + n >= DT_NONE ? DT_NOMEM
                               : dt_items_reserve(&h->change, h->n + n, &h->cap, sizeof *h->change);
}

enum dt_status dt_history_reserve_id(struct dt_history *h, uint32_t id)
{
    return dt_idmap_reserve(&h->last, id, 1);
}

void dt_history_note(struct dt_history *h, struct dt_constraint what, bool added)
{
    h->change[h->n] = (struct dt_history_change){.what = what, .added = added};
    enter(h, h->n++);
}

size_t dt_history_memory(const struct dt_history *h)
{
    return h->cap * sizeof *h->change + dt_idmap_memory(&h->last);
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

/* The first changes of every constraint of the id since the moment, sorted: *k of them; the caller frees them. NULL: none if *k is 0,
 * else out of memory. */
static struct numbered *first_changes(const struct dt_history *h, size_t from, uint32_t id,
                                      size_t *k)
{
    size_t n = 0, kept = 0;
    uint32_t last = h->n == 0 ? DT_NONE : dt_idmap_get(&h->last, id);
    for (uint32_t i = last; i != DT_NONE && i >= from; i = h->change[i].before)
        n++;
    *k = n;
    struct numbered *c = n == 0 ? NULL : malloc(n * sizeof *c);
    if (c == NULL)
        return NULL;
    for (size_t i = 0, at = last; i < n; i++, at = h->change[at].before)
        c[i] = (struct numbered){h->change[at].what, h->change[at].added, at};
    qsort(c, n, sizeof *c, compare_numbered);
    for (size_t i = 0; i < n; i++)
        if (i == 0 || dt_constraint_compare(&c[i].what, &c[kept - 1].what) != 0)
            c[kept++] = c[i];
    *k = kept;
    return c;
}

enum dt_status dt_history_undo(const struct dt_history *h, uint64_t moment, uint32_t id,
                               struct dt_constraint_list *list, size_t first)
{
    size_t from = moment > h->first ? (size_t)(moment - h->first) : 0, changes, kept = first;
    struct numbered *c = first_changes(h, from, id, &changes);
    if (c == NULL)
        return changes == 0 ? DT_OK : DT_NOMEM;
    enum dt_status status = DT_OK;
    for (size_t i = first; i < list->n; i++)
        if (bsearch(&list->v[i], c, changes, sizeof *c, dt_constraint_compare) == NULL)
            list->v[kept++] = list->v[i];
    list->n = kept;
    for (size_t i = 0; i < changes && status == DT_OK; i++)
        if (!c[i].added)
            status = dt_constraint_append(list, c[i].what);
    free(c);
    return status;
}
