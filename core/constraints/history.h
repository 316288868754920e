/* history.h - how the constraints of a set have changed while views are open: so that these read them as they were.
 *
 * Changes have numbers. A view knows the number of the next change when it began; what a constraint was then follows
 * from the first change of it since. The changes of an id, of constraints whose smaller end it is, are a list:
 *
 *      last: id -> its last change          change   before: the one before it of the same id */
#pragma once

#include "core/constraints/declared.h"

struct dt_history_change {
    struct dt_constraint what;
    bool added;      /* else removed */
    uint32_t before; /* the place in the array of the change of the same id before it; or DT_NONE */
};

/* Start with {0}. */
struct dt_history {
    struct dt_history_change *change; /* owns `cap` */
    size_t n, cap;
    uint64_t first;       /* number of change[0] */
    struct dt_idmap last; /* id -> the place of its last change */
};

void dt_history_clear(struct dt_history *h);

/* Forgets the changes before the number. */
void dt_history_trim(struct dt_history *h, uint64_t from);

/* Makes room for n changes, and for changes of an id. */
enum dt_status dt_history_reserve(struct dt_history *h, size_t n);
enum dt_status dt_history_reserve_id(struct dt_history *h, uint32_t id);

size_t dt_history_memory(const struct dt_history *h);

/* There must be room. */
void dt_history_note(struct dt_history *h, struct dt_constraint what, bool added);

static inline uint64_t dt_history_now(const struct dt_history *h)
{
    return h->first + h->n;
}

/* The smallest id >= from that has changes, DT_NONE if none. */
static inline uint32_t dt_history_next(const struct dt_history *h, uint32_t from)
{
    return h->n == 0 ? DT_NONE : dt_idmap_next(&h->last, from);
}

/* Replaces the constraints from list->v[first] on, those whose smaller end is id now, by those when the number was the next; in no
 * order. Cost: the changes of the id since, and for these, and for the constraints if there are any, their logarithm. */
enum dt_status dt_history_undo(const struct dt_history *h, uint64_t moment, uint32_t id,
                               struct dt_constraint_list *list, size_t first);
