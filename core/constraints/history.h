/* history.h - how the constraints of a set have changed while views are open: so that these read them as they were.
 *
 * Changes have numbers. A view knows the number of the next change when it began; what a constraint was then follows
 * from the first change of it since. */
#ifndef DT_HISTORY_H
#define DT_HISTORY_H

#include "core/constraints/declared.h"

struct dt_history_change {
    struct dt_constraint what;
    bool added; /* else removed */
};

/* Start with {0}. */
struct dt_history {
    struct dt_history_change *change; /* owns `cap` */
    size_t n, cap;
    uint64_t first; /* number of change[0] */
};

void dt_history_clear(struct dt_history *h);

/* Forgets the changes before the number. */
void dt_history_trim(struct dt_history *h, uint64_t from);

/* Makes room for n changes. */
enum dt_status dt_history_reserve(struct dt_history *h, size_t n);

/* There must be room. */
void dt_history_note(struct dt_history *h, struct dt_constraint what, bool added);

static inline uint64_t dt_history_now(const struct dt_history *h)
{
    return h->first + h->n;
}

/* Replaces rows[*n], sorted, the constraints now, by those when the number was the next, sorted; the array is the
 * caller's and may move. */
enum dt_status dt_history_undo(const struct dt_history *h, uint64_t moment,
                               struct dt_constraint **rows, size_t *n);

#endif
