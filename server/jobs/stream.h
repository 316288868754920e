/* stream.h - the rows of a reply, made while they are sent.
 *
 * A stream pins a version, which it reads at one moment, and has a position in its rows. For a large set,
 * workers make a few pieces ahead of the socket, in parallel; they are sent in order:
 *
 *      rows                   piece 3    piece 2    piece 1    piece 0     out
 *      [ not cut yet ... ]    [ made ]   [in work]  [in work]  [ made ] -> [ being sent ] -> socket
 *
 * A piece is begun only when another one has been moved to `out`, at the rate of the socket. So a client that
 * stops reading costs the memory of a few pieces, however long the reply is. Pieces and ids of a list are
 * in the memory budget.
 *
 * Tables are read through the view. Values of a surface need the whole triangulation of its moment: when a piece finds
 * that the points have been edited since, a worker makes a copy of the set as it was (past.h), and the remaining pieces
 * are made from that. */
#ifndef SERVER_STREAM_H
#define SERVER_STREAM_H

#include "server/jobs/answer.h"
#include "server/jobs/server.h"
#include "server/sets/rows.h"

struct stream;

/* Answers with *rows, whose version need not be pinned: writes them at once if they are few, else creates a
 * stream (ANSWER_STREAM), to which *ids moves (it is empty then), and rows->made. ids is NULL for a table. The status
 * line must have been written before. rows->view, unless NULL, is ended when the rows have been sent; without a view,
 * the rows are those of now. If there is no memory for pieces: answer_busy. */
void stream_answer(struct server *s, struct answer *a, struct rows *rows, struct dt_ids *ids);

/* The same for rows of places, which it takes over: they are freed when their rows have been sent. */
void stream_answer_places(struct server *s, struct answer *a, struct rows *rows,
                          struct places *places);

/* Answers with a whole table of the version: the status line, then its rows. */
void stream_answer_table(struct server *s, struct answer *a, struct version *v, enum dt_table table,
                         bool cw, bool binary);

/* DT_POINTS with the values of fields after the coordinates; the array, from malloc, moves here, NULL: none. */
void stream_answer_points(struct server *s, struct answer *a, struct version *v, bool binary,
                          const struct dt_field **field, size_t fields);

/* Appends the finished pieces of a->stream to a->out, about one, and begins others; a->next is not ANSWER_STREAM
 * any more when the stream has ended. If nothing was appended, `ready` is called later. */
void stream_refill(struct server *s, struct answer *a);

/* Sets the callback ready(ctx), on the I/O thread, for when a worker has made a piece. */
void stream_notify(struct stream *st, void (*ready)(void *ctx), void *ctx);

/* Whether its rows are searched or computed, and not only read. */
bool stream_computes(const struct stream *st);

/* If workers are making pieces, the stream is freed when they are done. */
void stream_free(struct server *s, struct stream *st);

#endif
