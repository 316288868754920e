/* worker.h - threads for work that would block a reactor.
 *
 * Work is submitted to a queue and collected from a list; an eventfd signals that the list is not empty.
 * Between workers_submit and workers_collect a piece of work belongs to the workers.
 *
 * Each kind of work has a queue:
 *
 *     short   some milliseconds: a piece of a reply, a search
 *     long    one job of a client: a build, a check
 *     slow    a row of a reply that takes long by itself; one client may cause any number of them
 *
 * One thread does only short work, so replies make progress while builds occupy all other threads. The other threads
 * alternate between the kinds, so any amount of short work never keeps long work waiting. Slow work never
 * occupies the last thread, unless that is the only one. */
#pragma once

#include "core/delaunay.h"
#include "server/system/list.h"

enum work_kind { WORK_SHORT, WORK_LONG, WORK_SLOW };

struct work {
    struct list_link link;       /* first */
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

/* Moves finished work to the end of a list, in order of completion, some of it if there is very much: then the event
 * stays. */
void workers_collect(struct workers *w, struct list *to);

/* The core's thread pool: the caller of run does the jobs itself, and idle workers help. So it terminates
 * even if all workers are busy. Valid as long as the workers. */
const struct dt_pool *workers_pool(const struct workers *w);
