/* stats.h - how often each command was carried out and how long it took: the time at work and,
 * apart from it, the time in line for a set or for a worker.
 *
 * The clock is not free beside requests that take half a microsecond. It is read once when a
 * request ends, which is when the next one of the batch begins; and of a run of the quickest ones
 * (PING) only once for all, which then share the time equally. */
#ifndef SERVER_STATS_H
#define SERVER_STATS_H

#include "server/ops/histogram.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    STATS_COMMANDS = 48,             /* more than the table of commands has rows */
    STATS_OTHER = STATS_COMMANDS - 1 /* what is none of ours */
};

struct command_stats {
    uint64_t calls, errors;
    struct histogram work; /* ns from when a request was looked at until its reply began */
    struct histogram wait; /* ns in line, which `work` leaves out; only of those that had to */
};

struct stats {
    struct command_stats *of; /* owns; by place in the table of commands */
    int64_t mark_ns;          /* the last look at the clock: when the request at hand began */
    unsigned quick;           /* of which command the run of quick ones is */
    uint64_t run;             /* how many these are, not counted yet */
};

/* A request that is not answered at once; part of whoever waits for it. All zero: there is none. */
struct stats_pause {
    int64_t began_ns; /* when it was first looked at; 0: it has not paused */
    int64_t since_ns; /* in line since then; 0: it is not */
    int64_t waited_ns;
};

/* What became of a request. */
struct stats_outcome {
    int64_t work_ns, wait_ns;
};

/* False when out of memory. */
bool stats_init(struct stats *st);
void stats_clear(struct stats *st);

/* Looks at the clock, counts the run of quick requests that ends with it, and returns the time. */
int64_t stats_look(struct stats *st);

/* A request of this command is about to be carried out: ends a run of others. */
static inline void stats_begin(struct stats *st, unsigned command)
{
    if (st->run > 0 && st->quick != command)
        stats_look(st);
}

/* The request at hand pauses, in line for a set (in_line) or with a worker. */
void stats_pause(struct stats *st, struct stats_pause *p, bool in_line);

/* It goes on. */
void stats_resume(struct stats *st, struct stats_pause *p);

/* It has been answered; `quick`: the clock need not be looked at. *p is empty afterwards. */
struct stats_outcome stats_end(struct stats *st, struct stats_pause *p, unsigned command,
                               bool quick, bool error);

#endif
