/* hold.h - replies that wait until the log is on the disk.
 *
 * The bytes of a connection's output are numbered from 0. A hold says: bytes from this number on
 * must not be sent before that lsn is durable. There are at most two of them, one behind the other:
 * while the first waits, all later edits of the connection move the second one's lsn. So the first
 * is never put off by a client that goes on editing, and a connection needs no memory for it. */
#ifndef SERVER_HOLD_H
#define SERVER_HOLD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct hold {
    struct hold *prev, *next;
    struct holders *in; /* NULL: nothing is held */
    unsigned groups;
    struct {
        uint64_t lsn, from;
    } group[2];
};

/* Everyone who waits, in no particular order. */
struct holders {
    struct hold *first;
    void (*released)(struct hold *h);  /* it may send more than before */
    void (*not_saved)(struct hold *h); /* what it waits for may be lost: clear it */
};

/* Output from byte `from` on waits for lsn. */
void hold_add(struct holders *in, struct hold *h, uint64_t lsn, uint64_t from);

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

/* Nothing that anybody waits for is going to be durable. */
void holders_fail(struct holders *in);

#endif
