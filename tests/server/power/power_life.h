/* power_life.h - a daemon whose power is cut repeatedly. A life is one run with clients. After it, the test
 * examines many of the directories that a power cut may leave: each must hold what was promised to the
 * clients. The next life begins with one of them. A story is a sequence of lives. */
#pragma once

#include "tests/faults/tree.h"
#include "tests/server/power/power_client.h"

/* A kind of disk, and how a daemon runs on it. Shares are per mille. */
struct circumstances {
    const char *policy;     /* of --fsync */
    const char *compact_at; /* NULL: the default */
    unsigned sync_fails, write_fails, stall_us;
    unsigned long space; /* bytes; 0: any number */
    bool large;          /* some loads do not fit into one record of the log */
    unsigned ms;         /* the longest time of a life */
    unsigned states;     /* how many are examined after a life */
};

/* Counts of events, which show whether a test covers anything. */
struct tally {
    unsigned lives, operations, snapshots, removals, failed_syncs;
    unsigned acknowledged, refused, unknown, loads; /* changes; loads of several records */
    unsigned cuts, torn;                            /* power cuts; those with a torn end */
};

struct story {
    struct states history;
    struct client client[CLIENTS];
    struct workload work;
    struct tree before; /* what the life begins with */
    char dir[64];       /* for its files */
    size_t first;       /* operations of this life that earlier daemons have done */
    struct tally tally;
};

/* Begins a story; the tally is kept. */
void story_begin(struct story *s);

/* Runs one life and examines the directories that it may leave. */
void story_live(struct story *s, const struct circumstances *c);

void story_end(struct story *s);
