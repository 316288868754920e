/* gate.c - see gate.h. */
#include "server/system/gate.h"

#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { SPINS = 200 }; /* about 4 us, which is what a request takes */

/* FUTEX_WAIT_PRIVATE and FUTEX_WAKE_PRIVATE, whose header not every C library has. */
enum { FUTEX_WAIT_HERE = 0 | 128, FUTEX_WAKE_HERE = 1 | 128 };

static inline void spin(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("isb" ::: "memory");
#endif
}

/* Waits until *word is not `value` any more; a wake-up may come early. */
static void sleep_while(atomic_uint *word, unsigned value)
{
    syscall(SYS_futex, word, FUTEX_WAIT_HERE, value, NULL, NULL, 0);
}

static void wake_all(atomic_uint *word)
{
    syscall(SYS_futex, word, FUTEX_WAKE_HERE, INT32_MAX, NULL, NULL, 0);
}

bool lanes_init(struct lanes *l, unsigned n)
{
    *l = (struct lanes){.of = aligned_alloc(GATE_LINE, n * sizeof *l->of)};
    if (l->of == NULL)
        return false;
    memset(l->of, 0, n * sizeof *l->of);
    l->n = n;
    return true;
}

void lanes_clear(struct lanes *l)
{
    free(l->of);
    *l = (struct lanes){0};
}

void gate_init(struct gate *g, struct lanes *lanes)
{
    *g = (struct gate){.lanes = lanes};
}

/* ---- tickets ---- */

static void take_turn(struct gate *g)
{
    unsigned mine = atomic_fetch_add(&g->next, 1), now;
    for (int i = 0; i < SPINS; i++) {
        if (atomic_load(&g->served) == mine)
            return;
        spin();
    }
    while ((now = atomic_load(&g->served)) != mine)
        sleep_while(&g->served, now);
}

/* The same if no other thread has or awaits the turn. */
static bool try_turn(struct gate *g)
{
    unsigned mine = atomic_load(&g->served);
    return atomic_compare_exchange_strong(&g->next, &mine, mine + 1);
}

static void pass_turn(struct gate *g)
{
    unsigned served = atomic_fetch_add(&g->served, 1) + 1;
    if (atomic_load(&g->next) != served)
        wake_all(&g->served);
}

/* ---- sharing ---- */

bool gate_try_enter(struct gate *g, unsigned lane)
{
    atomic_store(&g->lanes->of[lane].inside, g);
    if (atomic_load(&g->closed) == 0)
        return true;
    gate_leave(g, lane);
    return false;
}

void gate_enter(struct gate *g, unsigned lane)
{
    if (gate_try_enter(g, lane))
        return;
    take_turn(g); /* only who has the turn closes the gate: it is open now */
    atomic_store(&g->lanes->of[lane].inside, g);
    pass_turn(g);
}

void gate_leave(struct gate *g, unsigned lane)
{
    struct lane *mine = &g->lanes->of[lane];
    atomic_store(&mine->inside, NULL);
    if (atomic_load(&g->closed) == 0)
        return;
    atomic_fetch_add(&mine->left, 1);
    wake_all(&mine->left);
}

/* ---- sharing without a lane ---- */

bool gate_try_visit(struct gate *g)
{
    atomic_fetch_add(&g->visitors, 1);
    if (atomic_load(&g->closed) == 0)
        return true;
    gate_end_visit(g);
    return false;
}

void gate_visit(struct gate *g)
{
    if (gate_try_visit(g))
        return;
    take_turn(g);
    atomic_fetch_add(&g->visitors, 1);
    pass_turn(g);
}

void gate_end_visit(struct gate *g)
{
    if (atomic_fetch_sub(&g->visitors, 1) == 1 && atomic_load(&g->closed) != 0)
        wake_all(&g->visitors);
}

/* ---- closing ---- */

static void await_lane(struct lane *lane, const struct gate *g)
{
    for (int i = 0; i < SPINS; i++) {
        if (atomic_load(&lane->inside) != g)
            return;
        spin();
    }
    for (;;) {
        unsigned left = atomic_load(&lane->left);
        if (atomic_load(&lane->inside) != g)
            return;
        sleep_while(&lane->left, left);
    }
}

static void await_visitors(struct gate *g)
{
    unsigned n;
    for (int i = 0; i < SPINS; i++) {
        if (atomic_load(&g->visitors) == 0)
            return;
        spin();
    }
    while ((n = atomic_load(&g->visitors)) != 0)
        sleep_while(&g->visitors, n);
}

/* Keeps new ones out, and waits until no lane is inside. */
static void close_to_lanes(struct gate *g)
{
    take_turn(g);
    atomic_store(&g->closed, 1);
    for (unsigned i = 0; i < g->lanes->n; i++)
        await_lane(&g->lanes->of[i], g);
}

void gate_close(struct gate *g)
{
    close_to_lanes(g);
    await_visitors(g);
}

/* Opens it again if a thread is inside. */
static bool stay_closed_if(struct gate *g, bool empty)
{
    if (!empty)
        gate_open(g);
    return empty;
}

bool gate_close_unvisited(struct gate *g)
{
    close_to_lanes(g);
    return stay_closed_if(g, atomic_load(&g->visitors) == 0);
}

bool gate_try_close(struct gate *g)
{
    if (!try_turn(g))
        return false;
    atomic_store(&g->closed, 1);
    bool empty = atomic_load(&g->visitors) == 0;
    for (unsigned i = 0; i < g->lanes->n; i++)
        empty = empty && atomic_load(&g->lanes->of[i].inside) != g;
    return stay_closed_if(g, empty);
}

void gate_open_and_enter(struct gate *g, unsigned lane)
{
    atomic_store(&g->lanes->of[lane].inside, g);
    gate_open(g);
}

void gate_open(struct gate *g)
{
    atomic_store(&g->closed, 0);
    pass_turn(g);
}
