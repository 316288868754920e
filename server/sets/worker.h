/* worker.h - threads that do what would hold up the I/O thread.
 *
 * Work goes in through a queue and comes out through a list; an eventfd says that the list is not
 * empty. Between workers_submit and workers_collect a piece of work belongs to the workers. This
 * and the core's pool below are the only places of the server that lock.
 *
 * Long work (a build) and short work (a piece of a dump) wait in queues of their own, and one
 * thread does short work only, so that a dump of one set does not stand still while builds of
 * others occupy every other thread. */
#ifndef SERVER_WORKER_H
#define SERVER_WORKER_H

#include "core/delaunay.h"

#include <stdbool.h>

enum work_kind { WORK_SHORT, WORK_LONG };

struct work {
    struct work *next;
    void (*run)(struct work *w); /* on a worker */
};

struct workers;

/* Starts `threads` threads for all work and one for short work. NULL if the system refuses. */
struct workers *workers_new(unsigned threads);

/* Waits for the work that is running, drops none: what is queued is run too. Collected or not, no
 * work is freed. */
void workers_free(struct workers *w);

/* Becomes readable when there is something to collect. */
int workers_event(const struct workers *w);

/* Long work that is queued and not running yet. */
unsigned workers_backlog(struct workers *w);

void workers_submit(struct workers *w, enum work_kind kind, struct work *work);

/* Takes all finished work, in order of completion; NULL if there is none. */
struct work *workers_collect(struct workers *w);

/* The core's threads: whoever calls run takes part, and idle workers help. So it ends even if all
 * others are busy. Valid as long as the workers. */
const struct dt_pool *workers_pool(const struct workers *w);

#endif
