/* gate.c - see gate.h. */
#include "server/system/gate.h"

#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { SPINS = 200 }; /* about 4 us, which is what a request takes */

/* Those of linux/futex.h, which not every C library has. */
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

bool gate_init(struct gate *g, unsigned lanes)
{
    memset(g, 0, sizeof *g);
    g->lane = aligned_alloc(GATE_LINE, lanes * sizeof *g->lane);
    if (g->lane == NULL)
        return false;
    memset(g->lane, 0, lanes * sizeof *g->lane);
    g->lanes = lanes;
    return true;
}

void gate_clear(struct gate *g)
{
    free(g->lane);
    g->lane = NULL;
    g->lanes = 0;
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

static void pass_turn(struct gate *g)
{
    unsigned served = atomic_fetch_add(&g->served, 1) + 1;
    if (atomic_load(&g->next) != served)
        wake_all(&g->served);
}

/* ---- sharing ---- */

void gate_enter(struct gate *g, unsigned lane)
{
    atomic_uint *inside = &g->lane[lane].inside;
    atomic_store(inside, 1);
    if (atomic_load(&g->closed) == 0)
        return;
    gate_leave(g, lane);
    take_turn(g); /* only who has the turn closes the gate: it is open now */
    atomic_store(inside, 1);
    pass_turn(g);
}

void gate_leave(struct gate *g, unsigned lane)
{
    atomic_store(&g->lane[lane].inside, 0);
    if (atomic_load(&g->closed) != 0)
        wake_all(&g->lane[lane].inside);
}

/* ---- closing ---- */

static void await_lane(atomic_uint *inside)
{
    for (int i = 0; i < SPINS; i++) {
        if (atomic_load(inside) == 0)
            return;
        spin();
    }
    while (atomic_load(inside) != 0)
        sleep_while(inside, 1);
}

void gate_close(struct gate *g)
{
    take_turn(g);
    atomic_store(&g->closed, 1);
    for (unsigned i = 0; i < g->lanes; i++)
        await_lane(&g->lane[i].inside);
}

void gate_open_and_enter(struct gate *g, unsigned lane)
{
    atomic_store(&g->lane[lane].inside, 1);
    gate_open(g);
}

void gate_open(struct gate *g)
{
    atomic_store(&g->closed, 0);
    pass_turn(g);
}
