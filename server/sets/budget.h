/* budget.h - the one budget of memory (--max-memory): whatever is large reserves its bytes here before
 * it takes them, and gives them back when it is gone.
 *
 *      limit  +-----------------------------------------------------------------------+
 *             | sets | builds | edits | loads | log | replies | clients |   free      |
 *             +-----------------------------------------------------------------------+
 *
 * A reservation is a number of bytes of one kind, part of whatever it is for. What is known before it
 * is taken asks (reservation_resize) and may be refused. What is known only afterwards is measured
 * (reservation_set): that cannot fail, and if it takes more than there is, nothing else gets any.
 *
 * A sixteenth of the limit is for replies and clients alone, so that a server full of sets still
 * answers. Free bytes may be pages that are kept to be used again (keep.h), which go back to the
 * system when somebody else reserves them.
 *
 * Any thread may use it; one reservation belongs to one thread at a time. */
#ifndef SERVER_BUDGET_H
#define SERVER_BUDGET_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

enum budget_kind {
    BUDGET_SETS,    /* all versions of all sets */
    BUDGET_BUILDS,  /* triangulations and grids that are being made */
    BUDGET_EDITS,   /* batches that are being added, copies made for edits, sets being freed */
    BUDGET_LOADS,   /* points that are being received */
    BUDGET_LOG,     /* changes that the log thread has not written yet */
    BUDGET_REPLIES, /* results and rows of replies that are being sent */
    BUDGET_CLIENTS, /* connections and their buffers */
    BUDGET_KINDS
};

struct budget {
    const size_t *limit; /* borrows: it may change */
    atomic_size_t used, peak;
    atomic_size_t of[BUDGET_KINDS]; /* their sum is `used` */
};

/* All zero but for the kind: one that is in no budget, which only counts. */
struct reservation {
    struct budget *budget; /* borrows */
    enum budget_kind kind;
    size_t bytes;
};

void budget_init(struct budget *b, const size_t *limit);

static inline size_t budget_used(const struct budget *b)
{
    return atomic_load_explicit(&b->used, memory_order_relaxed);
}

static inline size_t budget_of(const struct budget *b, enum budget_kind kind)
{
    return atomic_load_explicit(&b->of[kind], memory_order_relaxed);
}

/* Whether there are so many bytes more for that kind now; whether there could be, if only the sets
 * that are there had any. */
bool budget_fits(const struct budget *b, enum budget_kind kind, size_t more);
bool budget_could_fit(const struct budget *b, size_t more);

/* It is `bytes` in all from now on, unless that is more than before and does not fit: false, and it
 * is as it was. */
bool reservation_resize(struct reservation *r, size_t bytes);

/* It has turned out to be `bytes` in all. */
void reservation_set(struct reservation *r, size_t bytes);

/* The bytes of `from` become part of `to`. */
void reservation_move(struct reservation *to, struct reservation *from);

/* On a worker, before it takes what it has reserved: if the process would have more than the budget
 * then, what malloc keeps of freed memory goes back to the system. */
void reservation_trim_heap(const struct reservation *coming);

#endif
