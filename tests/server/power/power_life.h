/* power_life.h - a daemon whose power is cut, again and again: a life of it with clients at work, then
 * many of the directories that may be left, each of which must hold what the clients were promised;
 * the next life begins with one of these. */
#ifndef TESTS_SERVER_POWER_LIFE_H
#define TESTS_SERVER_POWER_LIFE_H

#include "tests/faults/tree.h"
#include "tests/server/power/power_client.h"

/* A kind of disk, and how a daemon lives with it. Shares are per mille. */
struct circumstances {
    const char *policy;     /* of --fsync */
    const char *compact_at; /* NULL: not */
    unsigned sync_fails, write_fails, stall_us;
    unsigned long space; /* bytes; 0: any number */
    bool large;          /* some loads do not fit into one record of the log */
    unsigned ms;         /* that a life takes at most */
    unsigned states;     /* that are looked at after a life */
};

/* What has happened, for those who want to know whether a test tests anything. */
struct tally {
    unsigned lives, operations, snapshots, removals, failed_syncs;
    unsigned acknowledged, refused, unknown, loads; /* changes; loads of several records */
    unsigned cuts, torn;                            /* power cuts; those with a torn end */
};

struct story {
    struct history history;
    struct client client[CLIENTS];
    struct workload work;
    struct tree before; /* what the life begins with */
    char dir[64];       /* for its files */
    size_t first;       /* operations of this life that earlier daemons have done */
    struct tally tally;
};

/* The tally goes on. */
void story_begin(struct story *s);

/* One life and its end. */
void story_live(struct story *s, const struct circumstances *c);

void story_end(struct story *s);

#endif
