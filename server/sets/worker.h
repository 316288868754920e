/* worker.h - threads for work that would block the I/O thread.
 *
 * Work is submitted to a queue and collected from a list; an eventfd signals that the list is not empty.
 * Between workers_submit and workers_collect a piece of work belongs to the workers.
 *
 * Long work (a build) and short work (a piece of a reply) have separate queues, and one thread does only
 * short work, so that replies make progress while builds occupy all other threads. */
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

/* Starts `threads` threads for all work and one for short work. NULL: the system refuses. */
struct workers *workers_new(unsigned threads);

/* Runs all queued work, then ends the threads. Does not free any work. */
void workers_free(struct workers *w);

/* Becomes readable when there is work to collect. */
int workers_event(const struct workers *w);

/* The number of long works that are queued and not running yet. */
unsigned workers_backlog(struct workers *w);

void workers_submit(struct workers *w, enum work_kind kind, struct work *work);

/* Takes all finished work, in order of completion; NULL if there is none. */
struct work *workers_collect(struct workers *w);

/* The core's thread pool: the caller of run does the jobs itself, and idle workers help. So it terminates
 * even if all workers are busy. Valid as long as the workers. */
const struct dt_pool *workers_pool(const struct workers *w);

#endif
