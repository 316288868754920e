/* gate.h - a lock that threads share almost all the time. Now and then one of the threads closes the lock.
 *
 * Each thread has a lane, which is a cache line of its own. A thread that enters a gate notes that in its lane and writes
 * nothing else, so threads that share the gate never write the same line. Who closes the gate waits until it is in no
 * lane. The idea comes from BRAVO (Dice & Kogan, USENIX ATC 2019). Many gates may have the same lanes, if a thread is
 * inside one of them at a time.
 *
 *     lane 0   lane 1   lane 2        gates a, b
 *     [ a  ]   [    ]   [ b  ]        open:       lanes enter and leave
 *     [    ]   [    ]   [ b  ]        a closed:   by lane 1, which is alone in a
 *
 * Threads without a lane are visitors, which the gate counts.
 *
 * A thread that finds the gate closed, or wants to close it, takes a ticket; tickets are served in order. So neither threads that
 * close the gate often nor threads that share it can keep others out. Waiting threads spin for a few microseconds, then sleep.
 * All operations are sequentially consistent: the store of a lane must not pass the load of `closed`. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

enum { GATE_LINE = 64 };

struct gate;

struct lane {
    /* The gate that its thread shares; NULL: none. */
    _Alignas(GATE_LINE) _Atomic(const struct gate *) inside;
    atomic_uint left; /* how often it has left a gate that was closed */
};

struct lanes {
    struct lane *of; /* owns n, one for each thread */
    unsigned n;
};

struct gate {
    struct lanes *lanes;  /* borrows */
    atomic_uint visitors; /* threads without a lane that are inside, or look whether they may be */
    atomic_uint closed;
    atomic_uint next;   /* ticket */
    atomic_uint served; /* the ticket whose turn it is */
};

/* That many empty lanes; false when out of memory. */
bool lanes_init(struct lanes *l, unsigned n);
void lanes_clear(struct lanes *l);

/* An open gate. It needs no end. */
void gate_init(struct gate *g, struct lanes *lanes);

/* Shares the gate; waits while it is closed. The lane must not be inside any gate. */
void gate_enter(struct gate *g, unsigned lane);
void gate_leave(struct gate *g, unsigned lane);

/* The same without waiting; false: the gate is closed. */
bool gate_try_enter(struct gate *g, unsigned lane);

/* The same for a thread without a lane. */
void gate_visit(struct gate *g);
void gate_end_visit(struct gate *g);
bool gate_try_visit(struct gate *g);

/* Closes the gate: on return no thread is inside, and none will be until gate_open. The caller must not be inside. Cost: a
 * look at each lane. */
void gate_close(struct gate *g);
/* The same without waiting for visitors, or for anybody. False: a thread is inside, or closes it. */
bool gate_close_unvisited(struct gate *g);
bool gate_try_close(struct gate *g);
/* Opens it; `lane` shares it from then on, without a moment in which another thread could close it. */
void gate_open_and_enter(struct gate *g, unsigned lane);
void gate_open(struct gate *g);

/* Whether a thread has closed the gate, or is closing it and waits until all others have left. */
static inline bool gate_is_closed(const struct gate *g)
{
    return atomic_load_explicit(&g->closed, memory_order_relaxed) != 0;
}
