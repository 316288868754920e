/* hold.h - replies that wait until the log is on the disk.
 *
 * Two kinds of replies do. One acknowledges a change: sent too early it would promise what may be
 * lost. The other shows what a change of any client has done: sent too early, another client could
 * act on what may never have been.
 *
 * The bytes of a connection's output are numbered from 0. A hold says: bytes from this number on
 * must not be sent before that lsn is durable. There are at most two of them, one behind the other:
 * while the first waits, all later requests of the connection move the second one's lsn. So the
 * first is never put off by a client that goes on editing, and a connection needs no memory for it.
 *
 * When the disk fails and stays so, nobody knows what becomes of the changes. Who waits for an
 * acknowledgement is told so; what replies show is not held back any more, since it is what there
 * is, and all there will be until the disk is good again. */
#ifndef SERVER_HOLD_H
#define SERVER_HOLD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct hold {
    struct hold *prev, *next;
    struct holders *in; /* NULL: nothing is held */
    unsigned groups;
    struct hold_group {
        uint64_t lsn, from;
        bool acknowledges;
    } group[2];
};

/* Everyone who waits, in no particular order. */
struct holders {
    struct hold *first;
    uint64_t durable;                  /* everything up to this lsn is */
    bool failing;                      /* the disk stays broken: only acknowledgements wait */
    void (*released)(struct hold *h);  /* it may send more than before */
    void (*not_saved)(struct hold *h); /* what it waits for may be lost: clear it */
};

/* Output from byte `from` on waits for lsn, if that is not durable yet: it acknowledges that change,
 * or shows what it has done. Never earlier than the output of the call before. */
void hold_acknowledgement(struct holders *in, struct hold *h, uint64_t lsn, uint64_t from);
void hold_view(struct holders *in, struct hold *h, uint64_t lsn, uint64_t from);

/* Waits no more, whatever is durable. */
void hold_clear(struct hold *h);

/* How many of the bytes from..to may be sent. */
static inline size_t hold_free(const struct hold *h, uint64_t from, uint64_t to)
{
    uint64_t end = h->groups > 0 && h->group[0].from < to ? h->group[0].from : to;
    return end > from ? (size_t)(end - from) : 0;
}

/* Everything up to lsn is durable. */
void holders_release(struct holders *in, uint64_t lsn);

/* The disk stays broken: lets go of what only shows changes, and calls not_saved for everybody else
 * who waits. */
void holders_fail(struct holders *in);

/* It is good again. */
void holders_recover(struct holders *in);

#endif
