/* stats.h - how often each command was carried out and how long it took: the time at work, and separately
 * the time in queues for a set or a worker.
 *
 * Reading the clock is expensive compared with requests that take half a microsecond. It is read once when a request
 * ends, which is when the next request of the batch begins. For a run of the quickest requests
 * (PING) it is read only once, and they share the time equally. */
#pragma once

#include "server/ops/histogram.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    STATS_COMMANDS = 80,             /* more than the number of commands */
    STATS_OTHER = STATS_COMMANDS - 1 /* all unknown commands */
};

struct command_stats {
    uint64_t calls, errors;
    /* ns from the start of a request to the start of its reply, without `wait` */
    struct histogram work;
    struct histogram wait; /* ns in queues; only of requests that had to wait */
};

struct stats {
    struct command_stats *of; /* owns; by index in the table of commands */
    int64_t mark_ns;          /* when the clock was last read: when the current request began */
    unsigned quick;           /* the command of the run of quick requests */
    uint64_t run;             /* the length of that run; its time is not counted yet */
};

/* A request that is not answered at once; part of its session. All zero: there is none. */
struct stats_pause {
    int64_t began_ns; /* when the request began; 0: it has not paused */
    int64_t since_ns; /* in a queue since then; 0: it is not in one */
    int64_t waited_ns;
};

/* Adds the counts of another one. */
void command_stats_join(struct command_stats *of, const struct command_stats *other);

/* The times of a request. */
struct stats_outcome {
    int64_t work_ns, wait_ns;
};

/* False when out of memory. */
bool stats_init(struct stats *st);
void stats_clear(struct stats *st);

/* Reads the clock, counts the time of the run of quick requests, and returns the clock. */
int64_t stats_look(struct stats *st);

/* A request of this command is about to be carried out: ends a run of another command. */
static inline void stats_begin(struct stats *st, unsigned command)
{
    if (st->run > 0 && st->quick != command)
        stats_look(st);
}

/* The current request pauses, in a queue (in_line) or with a worker. */
void stats_pause(struct stats *st, struct stats_pause *p, bool in_line);

/* It continues. */
void stats_resume(struct stats *st, struct stats_pause *p);

/* It has been answered; `quick`: the clock need not be read. *p is empty afterwards. */
struct stats_outcome stats_end(struct stats *st, struct stats_pause *p, unsigned command,
                               bool quick, bool error);
