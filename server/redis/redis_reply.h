/* redis_reply.h - pieces of replies in RESP, and replies of our own commands from which they are made. */
#ifndef SERVER_REDIS_REPLY_H
#define SERVER_REDIS_REPLY_H

#include "proto/reply_read.h"
#include "server/command/command.h"

typedef void redis_handler(struct server *s, const struct request *q, struct answer *a);

/* A simple string or another element of one line, with its mark. */
void redis_simple(struct answer *a, const char *text);
/* An error, which is the whole reply: a code of Redis's or ours, and a message. */
void redis_error(struct answer *a, const char *text);
void redis_bulk_text(struct answer *a, const char *text);
void redis_integer(struct answer *a, int64_t v);
void redis_usage(struct answer *a, const char *text);

/* The header of a map; in RESP 2 of an array of keys and values. */
void redis_map(struct answer *a, size_t n);

/* Null; in RESP 2 the missing bulk string. */
void redis_null(struct answer *a);

/* A reply in lines. */
struct line_reply {
    struct buf lines;         /* owns */
    struct reply_part status; /* borrows lines */
    struct buf rows;          /* owns; each row with an end of line */
};

void line_reply_clear(struct line_reply *t);

/* The number of a key of the status line; 0: it has none. */
uint64_t line_reply_number(const struct line_reply *t, const char *key);

/* Splits t->lines into status and rows, each with `eol`; an error is copied to the reply. False: that is all, and t
 * has been cleared. */
bool line_reply_split(struct line_reply *t, struct answer *a, const char *eol);

/* The value of a fact `key:value` among rows of INFO, up to the end of its line; NULL: there is none. */
const char *redis_fact(const struct buf *rows, const char *key, size_t *len);

/* Carries out q as a line. False: it has been answered with an error, or waits as *a says. */
bool redis_ask(struct server *s, const struct request *q, struct answer *a, const char *eol,
               struct line_reply *t);

#endif
