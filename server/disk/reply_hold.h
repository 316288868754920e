/* reply_hold.h - the ack gate: delays replies until the log is durable.
 *
 * Two kinds of replies are delayed. A reply that acknowledges a change would, if sent too early, promise
 * something that may be lost. A reply that shows the result of a change, of any client, could lead another
 * client to act on a change that is lost later.
 *
 * The bytes of a connection's output are numbered from 0. A group of a hold says: bytes from this number
 * on must not be sent before that lsn is durable. A connection has at most two groups, one behind the
 * other: while the first one waits, later requests raise the lsn of the second one. So a client that goes
 * on editing never postpones the first group, and a hold has a fixed size.
 *
 * With --min-followers N a change must also be on the disks of N followers (holders_follow).
 *
 * When the disk fails permanently, or followers are missing, the fate of the changes is unknown. Clients that wait for an
 * acknowledgement get an error; replies that only show changes are released, because there will be
 * no other state until the disk works again. */
#pragma once

#include "server/system/list.h"

#include <stdint.h>

enum { HOLD_REACTORS = 64 };

struct hold {
    struct list_link link; /* first */
    unsigned reactor;      /* of the connection */
    unsigned groups;       /* 0: nothing is held */
    struct hold_group {
        uint64_t lsn, from;
        bool acknowledges;
    } group[2];
};

/* All holds that wait, in no particular order. Each reactor has a list of its own, because it adds to the list while it shares
 * the world (loop.h). */
struct holders {
    struct list holds[HOLD_REACTORS];
    /* replies about changes up to this lsn may be sent: the lesser of the next two */
    uint64_t durable;
    uint64_t saved;       /* changes up to this lsn are durable here, */
    uint64_t followed;    /* and up to this one they are on enough followers, */
    bool needs_followers; /* if any are needed */
    unsigned failing;     /* enum hold_cause: if there is any, only acknowledgements wait */
    void (*released)(struct hold *h);  /* more output may be sent than before */
    void (*not_saved)(struct hold *h); /* the changes may be lost: must call hold_clear */
};

/* Why changes cannot be acknowledged. */
enum hold_cause { HOLD_DISK = 1, HOLD_FOLLOWERS = 2 };

/* Delays output from byte `from` on until lsn is durable, because it acknowledges that change, or shows it.
 * `from` must not be less than in the previous call. */
void hold_acknowledgement(struct holders *in, struct hold *h, uint64_t lsn, uint64_t from);
void hold_view(struct holders *in, struct hold *h, uint64_t lsn, uint64_t from);

/* Removes the hold. */
void hold_clear(struct hold *h);

/* Returns how many of the bytes from..to may be sent now. */
static inline size_t hold_free(const struct hold *h, uint64_t from, uint64_t to)
{
    uint64_t end = h->groups > 0 && h->group[0].from < to ? h->group[0].from : to;
    return end > from ? (size_t)(end - from) : 0;
}

/* Changes up to lsn are durable now. */
void holders_release(struct holders *in, uint64_t lsn);

/* Changes up to lsn are on enough followers. A lesser lsn than before is ignored. */
void holders_follow(struct holders *in, uint64_t lsn);

/* No followers are needed. */
void holders_follow_none(struct holders *in);

/* Changes cannot be acknowledged: releases the replies that only show changes, and calls not_saved for all others. */
void holders_fail(struct holders *in, enum hold_cause cause);

/* The cause has ended. */
void holders_recover(struct holders *in, enum hold_cause cause);
