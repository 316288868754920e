/* budget.c - see budget.h. */
#include "server/sets/budget.h"

#include "core/delaunay.h"
#include "server/system/machine.h"

#include <assert.h>
#include <malloc.h>

enum { ANSWERS_SHARE = 16 }; /* this fraction of the limit is for replies and clients alone */

void budget_init(struct budget *b, size_t limit, struct dt_pages *pages)
{
    *b = (struct budget){.limit = limit, .pages = pages};
}

static bool is_for_answers(enum budget_kind kind)
{
    return kind == BUDGET_REPLIES || kind == BUDGET_CLIENTS;
}

/* The rest of the share of replies and clients. */
static size_t answers_left(const struct budget *b)
{
    size_t share = b->limit / ANSWERS_SHARE;
    size_t taken = budget_of(b, BUDGET_REPLIES) + budget_of(b, BUDGET_CLIENTS);
    return share > taken ? share - taken : 0;
}

static bool fits(const struct budget *b, enum budget_kind kind, size_t used, size_t more)
{
    size_t limit = b->limit, left = answers_left(b);
    size_t room = limit > used ? limit - used : 0;
    if (is_for_answers(kind))
        return more <= room || more <= left;
    return room > left && more <= room - left;
}

bool budget_fits(const struct budget *b, enum budget_kind kind, size_t more)
{
    return fits(b, kind, budget_used(b), more);
}

bool budget_could_fit(const struct budget *b, size_t more)
{
    size_t limit = b->limit, sets = budget_of(b, BUDGET_SETS);
    limit -= limit / ANSWERS_SHARE;
    return sets < limit && more <= limit - sets;
}

static void note_peak(struct budget *b, size_t used)
{
    size_t peak = atomic_load_explicit(&b->peak, memory_order_relaxed);
    while (used > peak && !atomic_compare_exchange_weak(&b->peak, &peak, used))
        ;
}

/* Returns the kept pages that exceed the limit together with what is reserved and the pages in use. */
static void give_up_kept(const struct budget *b)
{
    struct dt_pages_summary now;
    if (b->pages == NULL)
        return;
    dt_pages_summary(b->pages, &now);
    if (now.kept == 0)
        return;
    size_t used = budget_used(b), large = now.held - now.kept, limit = b->limit;
    size_t all = now.kept + (used > large ? used : large);
    if (all > limit)
        (void)dt_pages_trim(b->pages, all - limit);
}

static void grow(struct reservation *r, size_t more)
{
    atomic_fetch_add(&r->budget->of[r->kind], more);
    r->bytes += more;
    give_up_kept(r->budget);
}

bool reservation_resize(struct reservation *r, size_t bytes)
{
    struct budget *b = r->budget;
    if (b == NULL || bytes <= r->bytes) {
        reservation_set(r, bytes);
        return true;
    }
    size_t more = bytes - r->bytes, used = budget_used(b);
    do {
        if (!fits(b, r->kind, used, more)) {
            b->short_of = true;
            return false;
        }
    } while (!atomic_compare_exchange_weak(&b->used, &used, used + more));
    note_peak(b, used + more);
    grow(r, more);
    return true;
}

void reservation_set(struct reservation *r, size_t bytes)
{
    struct budget *b = r->budget;
    if (bytes == r->bytes)
        return;
    if (b == NULL) {
        r->bytes = bytes;
    } else if (bytes > r->bytes) {
        size_t more = bytes - r->bytes;
        note_peak(b, atomic_fetch_add(&b->used, more) + more);
        grow(r, more);
    } else {
        size_t less = r->bytes - bytes;
        assert(budget_of(b, r->kind) >= less);
        atomic_fetch_sub(&b->of[r->kind], less);
        atomic_fetch_sub(&b->used, less);
        r->bytes = bytes;
    }
}

void reservation_move(struct reservation *to, struct reservation *from)
{
    size_t bytes = from->bytes;
    reservation_set(from, 0);
    reservation_set(to, to->bytes + bytes);
}

/* Only glibc keeps freed memory until it is asked to return it. */
void budget_trim_heap(void)
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

void reservation_trim_heap(const struct reservation *r)
{
    if (r->bytes == 0)
        return;
    size_t resident = machine_resident(), limit = r->budget->limit;
    if (resident > limit || r->bytes > limit - resident)
        budget_trim_heap();
}
