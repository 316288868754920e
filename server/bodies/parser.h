/* parser.h - a long text of points, parsed by workers in blocks of whole lines.
 *
 *     received    [ filling ] [ in work ] [ in work ] [ parsed ] -> appended to the body, in order
 *
 * The owner receives into a block, where only the ends of lines are searched. The line that ends the body, and all that follows
 * it, goes back to the owner (parser_rest), who feeds it to the body when the blocks have been appended. A block whose lines have
 * a fault is fed to the body, too, so faults are the same as in a body that has been fed all the text.
 *
 * Text and points of the blocks are in the memory budget. Without memory for a block the parser ends, and the owner goes on
 * with the rest of the text. */
#pragma once

#include "proto/body.h"
#include "server/jobs/server.h"

struct parser;

enum parser_step {
    PARSER_MOVED,  /* lines have been appended, or fed */
    PARSER_WAITS,  /* for input, or a worker: then ready is called */
    PARSER_BROKEN, /* body_feed has returned -1 */
};

/* Parses the rest of the body b, which is a text without a fault, in blocks of about `bytes` bytes, at least PARSER_LEAST.
 * Calls ready(ctx) when a block has been parsed. NULL: out of memory. There must be workers. */
enum { PARSER_LEAST = 128 * 1024, PARSER_MOST = 512 * 1024 };
struct parser *parser_new(struct server *s, struct body *b, size_t bytes, void (*ready)(void *ctx),
                          void *ctx);

/* Workers may still have blocks: then they are freed later. */
void parser_free(struct parser *p);

/* Returns the place at which the next bytes of the text are to be received: *n at most. NULL: a block is to be submitted, all
 * blocks are in work, or the parser has ended. */
char *parser_room(struct parser *p, size_t *n);

/* n bytes have been received at parser_room's place. */
void parser_received(struct parser *p, size_t n);

/* Whether a block is full: then parser_submit gives it to the workers. Only a reactor that is alone (loop.h) submits, and frees a
 * parser. */
bool parser_is_full(const struct parser *p);
void parser_submit(struct parser *p);

/* There is no more text. */
void parser_end(struct parser *p);

/* Of a parser that is done: the bytes that it has received and not parsed, *n of them. */
const char *parser_rest(const struct parser *p, size_t *n);

/* Appends the next block, or feeds a piece of the block. */
enum parser_step parser_step(struct parser *p);

/* Whether all lines are in the body, and the parser has ended. */
bool parser_is_done(const struct parser *p);

/* Whether it receives nothing for now, because workers have blocks. */
bool parser_is_busy(const struct parser *p);
