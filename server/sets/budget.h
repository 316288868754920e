/* budget.h - the memory budget (--max-memory): everything large reserves its bytes here before it allocates
 * them, and returns them when it is freed.
 *
 *      limit  +-------------------------------------------------------------------------+
 *             | sets | copies | builds | edits | loads | log | replies | clients | free |
 *             +-------------------------------------------------------------------------+
 *
 * A reservation is a number of bytes of one kind, embedded in the object that uses them. A size that is
 * known before the allocation is requested (reservation_resize), and may be refused. A size that is known
 * only afterwards is recorded (reservation_set): that cannot fail, and if it exceeds the limit, other
 * requests are refused.
 *
 * A sixteenth of the limit is for replies and clients alone, so that a server full of sets still
 * answers. Free bytes may be pages in the page cache (page_cache.h). A reservation that needs them returns them to the
 * system before it succeeds, so pages and reservations together stay within the limit.
 *
 * Any thread may use a budget; a reservation belongs to one thread at a time. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

struct dt_pages;

enum budget_kind {
    BUDGET_SETS,    /* all versions of all sets */
    BUDGET_COPIES,  /* copies of sets without some points, which can be made again (skip_copy.h) */
    BUDGET_BUILDS,  /* triangulations and grids that are being built */
    BUDGET_EDITS,   /* batches that are being added, copies for edits, sets that are being freed */
    BUDGET_LOADS,   /* points that are being received */
    BUDGET_LOG,     /* changes that are not written to the log yet, those of a leader included */
    BUDGET_REPLIES, /* results and rows of replies that are being sent */
    BUDGET_CLIENTS, /* connections and their buffers, those of followers included */
    BUDGET_KINDS
};

struct budget {
    atomic_size_t limit;    /* any thread may set it */
    struct dt_pages *pages; /* borrows: the page cache; NULL: there is none */
    atomic_size_t used, peak;
    atomic_size_t of[BUDGET_KINDS]; /* their sum is `used` */
    atomic_bool short_of; /* bytes were refused: copies that are not in use are to be freed */
};

/* budget NULL: it only counts. */
struct reservation {
    struct budget *budget; /* borrows */
    enum budget_kind kind;
    size_t bytes;
};

void budget_init(struct budget *b, size_t limit, struct dt_pages *pages);

static inline size_t budget_used(const struct budget *b)
{
    return atomic_load_explicit(&b->used, memory_order_relaxed);
}

static inline size_t budget_of(const struct budget *b, enum budget_kind kind)
{
    return atomic_load_explicit(&b->of[kind], memory_order_relaxed);
}

/* Whether `more` bytes of that kind are available now; whether they would be if only sets had any. */
bool budget_fits(const struct budget *b, enum budget_kind kind, size_t more);
bool budget_could_fit(const struct budget *b, size_t more);

/* Changes the reservation to `bytes` in all. False if that is more than before and does not fit; then it is
 * unchanged. */
bool reservation_resize(struct reservation *r, size_t bytes);

/* Sets the reservation to `bytes` in all, whether or not that fits. */
void reservation_set(struct reservation *r, size_t bytes);

/* Moves the bytes of `from` to `to`. */
void reservation_move(struct reservation *to, struct reservation *from);

/* Returns the free memory of malloc's heap to the system. Cost: its size, so only workers call it. */
void budget_trim_heap(void);

/* To be called by a worker before it allocates memory that it has reserved. If the resident memory of the process
 * would exceed the budget, the free memory of malloc's heap is returned to the system. */
void reservation_trim_heap(const struct reservation *r);
