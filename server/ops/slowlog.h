/* slowlog.h - the last requests that took long: a ring of --slowlog-len entries, each of bounded
 * size. What a client sent is kept in printable form only. */
#ifndef SERVER_SLOWLOG_H
#define SERVER_SLOWLOG_H

#include "proto/request.h"
#include "server/system/sock.h"

#include <stdint.h>

enum { SLOW_TEXT = 128 }; /* bytes of a request that are kept, the NUL included */

struct slow {
    uint64_t id;     /* counted from 0 since the start */
    int64_t at_s;    /* when it was answered, in seconds since 1970 */
    int64_t work_us; /* that it was worked on, */
    int64_t wait_us; /* and that it stood in line */
    uint64_t client; /* whose it was, and where that was */
    struct sock_peer peer;
    char text[SLOW_TEXT];
};

struct slowlog {
    struct slow *entry; /* owns; a ring */
    unsigned cap;
    uint64_t next;  /* the id of the next entry */
    uint64_t first; /* the ids before it have been forgotten by slowlog_reset */
};

/* A log of at most `cap` entries. False when out of memory. */
bool slowlog_init(struct slowlog *l, unsigned cap);
void slowlog_clear(struct slowlog *l);

/* Makes room for `cap` entries instead, of which the latest stay. False when out of memory. */
bool slowlog_resize(struct slowlog *l, unsigned cap);

/* Takes the entry, whose id it sets; the oldest one makes room. Cost: O(1). */
void slowlog_add(struct slowlog *l, const struct slow *entry);

/* How many there are. */
unsigned slowlog_len(const struct slowlog *l);

/* The one of that id; NULL: it has been forgotten, or there is none yet. */
const struct slow *slowlog_find(const struct slowlog *l, uint64_t id);

/* Forgets them all. */
void slowlog_reset(struct slowlog *l);

/* Writes the words of a request into text[SLOW_TEXT], separated by single spaces; what is not
 * printable, or a blank within a word, becomes '?', and "..." ends what has no room. */
void slowlog_quote(char *text, const struct word *word, size_t n);

#endif
