/* redis_reply.h - pieces of replies in RESP, and requests that are carried out as commands of ours. */
#pragma once

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

/* Splits ADDR:PORT at its last colon: *len bytes are the address. Returns the port; without a colon it is empty. */
const char *redis_split_address(const char *text, size_t *len);

/* Carries out q as a command of ours. True: it has succeeded, and is to be answered in RESP. False: it waits or has been
 * refused; its answer is in lines (server.lines), which are converted to RESP. */
bool redis_run(struct server *s, const struct request *q, struct answer *a);
