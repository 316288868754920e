/* stream.h - the rows of a reply, made as they are sent.
 *
 * A stream pins the version it reads, at one moment of it, and keeps a place in its rows. A few pieces of
 * those of a large set are made ahead of the socket, side by side, by workers, and sent in order:
 *
 *      rows                   piece 3    piece 2    piece 1    piece 0     out
 *      [ not cut yet ... ]    [ made ]   [in work]  [in work]  [ made ] -> [ being sent ] -> socket
 *
 * A piece is begun only when another one has gone to `out`, and that takes no more than the socket
 * does. So a reader who stops costs a few pieces of memory, whatever was asked for. They are reserved,
 * as are the ids of a list, which there may be many of. */
#ifndef SERVER_STREAM_H
#define SERVER_STREAM_H

#include "server/jobs/answer.h"
#include "server/jobs/server.h"
#include "server/sets/rows.h"

struct stream;

/* Answers with *rows, whose version is not pinned yet: writes them at once if they are few, else
 * leaves ANSWER_STREAM, whose stream takes *ids over (and leaves it empty). ids is NULL for a
 * table. The status line must have been written before. rows->view, unless it is NULL, is ended
 * when the rows have been sent; without one, the rows are those of this moment. If there is no memory
 * for its pieces, the answer is undone (answer_busy). */
void stream_answer(struct server *s, struct answer *a, struct rows *rows, struct dt_ids *ids);

/* Answers with a whole table of the version: the status line, then its rows. */
void stream_answer_table(struct server *s, struct answer *a, struct version *v, enum dt_table table,
                         bool cw, bool binary);

/* Appends what there is of the stream that a owns, about a piece, to a->out, and has more made; what
 * is left of the stream is in a->stream. If nothing was appended, workers are at it, and the stream
 * calls `ready`. */
void stream_refill(struct server *s, struct answer *a);

/* Has the stream call ready(ctx) on the I/O thread whenever a worker has made a piece. */
void stream_tell(struct stream *st, void (*ready)(void *ctx), void *ctx);

/* The workers may still be at it: then it goes when they are done. */
void stream_free(struct registry *r, struct stream *st);

#endif
