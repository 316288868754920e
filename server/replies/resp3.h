/* resp3.h - typed replies in RESP 3, for connections that have asked for them with HELLO 3.
 *
 * Commands answer in lines. In RESP 2 each row is one string (resp.h); in RESP 3 a row is an array of numbers and texts,
 * and the facts of a status line are a map:
 *
 *     OK 0 points=4 tol=0 triangulated=yes     %3 points :4 tol ,0 triangulated #t
 *     OK 1                                     *1
 *     7 4 0.5                                  *3 :7 ,4 ,0.5
 *
 * The types depend on the command, never on the values: a coordinate is a double also where it is whole.
 * Specification: github.com/redis/redis-specifications, protocol/RESP3.md. */
#pragma once

#include "proto/buf.h"
#include "proto/reply_read.h"

/* As resp_reframe, typed. Each word of a row has a letter, and the last letter is for all words that follow. The letter i is an id or a
 * count, d a double, s a text, and w is typed by what it looks like. Or one of these alone: t the row is one text, m it is a name and its
 * facts. If there are two kinds of rows, a | separates their letters; the kinds differ in which words are texts. NULL: replies usually
 * have no rows; the words of those that have some are typed as by w. */
bool resp3_reframe(struct reply_reader *r, const char *types, const char *bytes, size_t n,
                   struct buf *out);

/* An event (server/watch/event_text.h) in lines, its first line and its n rows, as a push: `event`, a map of facts, and
 * the rows. */
void resp3_push(struct buf *out, const char *head, size_t head_len, const char *rows,
                size_t rows_len, size_t n);

/* The header of a map of n pairs, and null. */
void resp3_map(struct buf *out, size_t n);
void resp3_null(struct buf *out);
