/* gate.h - a lock that a few threads share almost all the time. Now and then one of the threads closes the lock.
 *
 * Each thread has a lane, which is a cache line of its own. A thread that enters writes only its lane, so threads that
 * share the gate never write the same line. Who closes the gate waits until all other lanes are empty. The idea is that of
 * BRAVO (Dice & Kogan, USENIX ATC 2019).
 *
 *     lane 0   lane 1   lane 2        gate
 *     [ in ]   [    ]   [ in ]        open:   lanes enter and leave
 *     [    ]   [    ]   [    ]        closed: by lane 1, which is alone
 *
 * Whoever finds the gate closed, or wants to close it, takes a ticket, and tickets are served in order. So neither threads that
 * close the gate often nor threads that share it can keep others out. Waiting threads spin for a few microseconds, then sleep.
 * All operations are sequentially consistent: the store of a lane must not pass the load of `closed`. */
#ifndef SERVER_GATE_H
#define SERVER_GATE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

enum { GATE_LINE = 64 };

struct lane {
    _Alignas(GATE_LINE) atomic_uint inside; /* 1: its thread shares the gate */
};

struct gate {
    struct lane *lane; /* owns */
    unsigned lanes;
    _Alignas(GATE_LINE) atomic_uint closed;
    _Alignas(GATE_LINE) atomic_uint next; /* ticket */
    atomic_uint served;                   /* the ticket whose turn it is */
};

/* A gate with that many lanes; false when out of memory. */
bool gate_init(struct gate *g, unsigned lanes);
void gate_clear(struct gate *g);

/* Shares the gate; waits while it is closed. The lane must not be inside. */
void gate_enter(struct gate *g, unsigned lane);
void gate_leave(struct gate *g, unsigned lane);

/* Closes the gate: on return no lane is inside, and none will be until gate_open. The caller's lane must not be inside. */
void gate_close(struct gate *g);
/* Opens it; `lane` shares it from then on, without a moment in which somebody else could close it. */
void gate_open_and_enter(struct gate *g, unsigned lane);
void gate_open(struct gate *g);

/* Whether somebody waits until this lane leaves. */
static inline bool gate_is_wanted(struct gate *g)
{
    return atomic_load_explicit(&g->closed, memory_order_relaxed) != 0;
}

#endif
