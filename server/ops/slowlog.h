/* slowlog.h - the slow log: a ring of the last --slowlog-len requests that took long, each of bounded size
 * and in printable form. */
#pragma once

#include "proto/request.h"
#include "server/system/sock.h"

#include <pthread.h>
#include <stdint.h>

enum { SLOW_TEXT = 128 }; /* bytes of a request that are kept, the NUL included */

struct slow {
    uint64_t id;     /* counted from 0 since the start */
    int64_t at_s;    /* when it was answered, in seconds since 1970 */
    int64_t work_us; /* time at work */
    int64_t wait_us; /* time in queues */
    uint64_t client; /* the id of the client, and its address */
    struct sock_peer peer;
    char text[SLOW_TEXT];
};

struct slowlog {
    pthread_mutex_t
        adding;         /* by threads that share the world (loop.h); for all else one is alone */
    struct slow *entry; /* owns; a ring */
    unsigned cap;
    uint64_t next;  /* the id of the next entry */
    uint64_t first; /* slowlog_reset has removed the entries before it */
};

/* A log of at most `cap` entries. False when out of memory. */
bool slowlog_init(struct slowlog *l, unsigned cap);
void slowlog_clear(struct slowlog *l);

/* Changes the capacity to `cap`; the latest entries stay. False when out of memory. */
bool slowlog_resize(struct slowlog *l, unsigned cap);

/* Adds a copy of the entry with a new id, in place of the oldest one if the ring is full. Several threads may add at once. Cost: O(1). */
void slowlog_add(struct slowlog *l, const struct slow *entry);

/* Returns the number of entries. */
unsigned slowlog_len(const struct slowlog *l);

/* The entry of that id; NULL: it has been removed, or does not exist yet. */
const struct slow *slowlog_find(const struct slowlog *l, uint64_t id);

/* Removes all entries. */
void slowlog_reset(struct slowlog *l);

/* Writes the words of a request into text[SLOW_TEXT], separated by single spaces. Blanks within a word and
 * characters that are not printable become '?'; a text that is too long is cut and ends in "...". */
void slowlog_quote(char *text, const struct word *word, size_t n);
