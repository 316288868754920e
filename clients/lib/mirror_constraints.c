/* mirror_constraints.c - see mirror_constraints.h. */
#include "clients/lib/mirror_constraints.h"

#include <stdlib.h>
#include <string.h>

#include "clients/lib/array.h"

#define MANY 16384 /* rows of an event: more are not kept for the next one */

/* ---- growing arrays ---- */

static bool make_room(struct constraint_list *l, size_t n)
{
    return array_reserve((void **)&l->at, &l->cap, l->n + n, sizeof *l->at);
}

static bool add(struct constraint_list *l, const struct delaunay_segment *c)
{
    if (!make_room(l, 1))
        return false;
    l->at[l->n++] = *c;
    return true;
}

void constraints_free(struct constraints *s)
{
    free(s->rows.at);
    free(s->slot);
    free(s->said);
    free(s->added.at);
    free(s->released.at);
}

void constraints_forget(struct constraints *s)
{
    s->n_said = 0;
    if (s->said_room <= MANY)
        return;
    free(s->said);
    s->said = NULL;
    s->said_room = 0;
}

bool constraints_gather(struct constraints *s, const struct delaunay_segment *c, bool declared)
{
    if (!array_reserve((void **)&s->said, &s->said_room, s->n_said + 1, sizeof *s->said))
        return false;
    s->said[s->n_said] = (struct constraint_said){*c, declared, s->n_said};
    s->n_said++;
    return true;
}

/* ---- order ---- */

static int compare(const void *p, const void *q)
{
    const struct delaunay_segment *a = p, *b = q;
    if (a->a != b->a)
        return a->a < b->a ? -1 : 1;
    if (a->b != b->b)
        return a->b < b->b ? -1 : 1;
    if (a->border != b->border)
        return a->border ? 1 : -1;
    return (a->number > b->number) - (a->number < b->number);
}

static int compare_said(const void *p, const void *q)
{
    const struct constraint_said *a = p, *b = q;
    int sign = compare(&a->what, &b->what);
    return sign != 0 ? sign : (a->number > b->number) - (a->number < b->number);
}

/* Sorts the statements; for each constraint the last one counts. */
static void sort_said(struct constraints *s)
{
    size_t n = 0;
    if (s->n_said > 1)
        qsort(s->said, s->n_said, sizeof *s->said, compare_said);
    for (size_t i = 0; i < s->n_said; i++)
        if (i + 1 == s->n_said || compare(&s->said[i].what, &s->said[i + 1].what) != 0)
            s->said[n++] = s->said[i];
    s->n_said = n;
}

/* ---- the table ---- */

static size_t home_of(const struct constraints *s, const struct delaunay_segment *c)
{
    uint64_t key = ((uint64_t)c->a << 32 | c->b) * 0x9e3779b97f4a7c15u;
    key = (key ^ key >> 32 ^ (uint64_t)c->number << 1 ^ c->border) * 0xd6e8feb86659fd93u;
    return (size_t)(key >> 32) & (s->slots - 1);
}

/* The slot of a constraint, or a free one where it could be; there are slots. */
static size_t slot_of(const struct constraints *s, const struct delaunay_segment *c)
{
    size_t i = home_of(s, c);
    while (s->slot[i] != 0 && compare(&s->rows.at[s->slot[i] - 1], c) != 0)
        i = (i + 1) & (s->slots - 1);
    return i;
}

/* The constraint as the copy has it; NULL: it has not. */
static struct delaunay_segment *find(const struct constraints *s, const struct delaunay_segment *c)
{
    size_t i = s->slots == 0 ? 0 : slot_of(s, c);
    return s->slots == 0 || s->slot[i] == 0 ? NULL : &s->rows.at[s->slot[i] - 1];
}

/* Enters all rows into the table, which is empty. */
static void fill_slots(struct constraints *s)
{
    for (size_t i = 0; i < s->rows.n; i++)
        s->slot[slot_of(s, &s->rows.at[i])] = (uint32_t)i + 1;
}

/* Makes room for n more. */
static bool reserve(struct constraints *s, size_t n)
{
    size_t slots = s->slots == 0 ? 16 : s->slots;
    while (slots / 4 * 3 < s->rows.n + n)
        slots *= 2;
    if (!make_room(&s->rows, n) || s->rows.n + n >= UINT32_MAX)
        return false;
    uint32_t *slot = slots > s->slots ? calloc(slots, sizeof *slot) : s->slot;
    if (slot == NULL || slot == s->slot)
        return slot != NULL;
    free(s->slot);
    s->slot = slot;
    s->slots = slots;
    fill_slots(s);
    return true;
}

void constraints_sort(struct constraints *s)
{
    if (s->is_sorted || s->rows.n == 0)
        return;
    qsort(s->rows.at, s->rows.n, sizeof *s->rows.at, compare);
    memset(s->slot, 0, s->slots * sizeof *s->slot);
    fill_slots(s);
    s->is_sorted = true;
}

static void enter(struct constraints *s, const struct delaunay_segment *c)
{
    size_t i = slot_of(s, c);
    if (s->slot[i] != 0) {
        s->rows.at[s->slot[i] - 1] = *c; /* other places of its ends */
        return;
    }
    s->rows.at[s->rows.n++] = *c;
    s->slot[i] = (uint32_t)s->rows.n;
}

/* Frees a slot, and moves entries after it that would not be found any more [Knuth, TAOCP 3, sec. 6.4, algorithm R]. */
static void free_slot(struct constraints *s, size_t hole)
{
    size_t mask = s->slots - 1, i = hole;
    s->slot[hole] = 0;
    while (s->slot[i = (i + 1) & mask] != 0) {
        size_t home = home_of(s, &s->rows.at[s->slot[i] - 1]);
        if (((i - home) & mask) < ((i - hole) & mask))
            continue;
        s->slot[hole] = s->slot[i];
        s->slot[i] = 0;
        hole = i;
    }
}

static void leave(struct constraints *s, const struct delaunay_segment *c)
{
    size_t i = slot_of(s, c), at = s->slot[i] - 1, last = s->rows.n - 1;
    free_slot(s, i);
    if (at != last) {
        s->slot[slot_of(s, &s->rows.at[last])] = (uint32_t)at + 1;
        s->rows.at[at] = s->rows.at[last];
    }
    s->rows.n = last;
}

/* ---- changes ---- */

static bool are_equal(const double a[4], const double b[4])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2] && a[3] == b[3];
}

static bool compare_one(struct constraints *s, const struct constraint_said *said)
{
    const struct delaunay_segment *old = find(s, &said->what);
    if (!said->declared)
        return old == NULL || add(&s->released, old);
    bool same = old != NULL && are_equal(old->places, said->what.places);
    return same || add(&s->added, &said->what);
}

/* Releases the constraints that no row names, in their order. */
static bool release_others(struct constraints *s)
{
    constraints_sort(s);
    for (size_t i = 0; i < s->rows.n; i++)
        if ((s->n_said == 0 ||
             bsearch(&s->rows.at[i], s->said, s->n_said, sizeof *s->said, compare) == NULL) &&
            !add(&s->released, &s->rows.at[i]))
            return false;
    return true;
}

bool constraints_compare(struct constraints *s, bool reset)
{
    bool ok = true;
    s->added.n = s->released.n = 0;
    sort_said(s);
    if (reset)
        ok = release_others(s);
    for (size_t i = 0; i < s->n_said && ok; i++)
        ok = compare_one(s, &s->said[i]);
    return ok && (s->added.n == 0 || reserve(s, s->added.n));
}

void constraints_apply(struct constraints *s)
{
    for (size_t i = 0; i < s->released.n; i++)
        leave(s, &s->released.at[i]);
    for (size_t i = 0; i < s->added.n; i++)
        enter(s, &s->added.at[i]);
    s->is_sorted = s->is_sorted && s->added.n == 0 && s->released.n == 0;
}
