/* row_stream.h - a stream of the rows of a set.
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
 * Tables are read through the view. Values of a surface need the whole triangulation of its moment. When a piece finds
 * that the points have been edited since, a worker makes a copy of the set as it was (past.h), and the remaining pieces
 * are made from that copy. */
#pragma once

#include "server/rows/rows.h"
#include "server/rows/stream.h"

/* Answers with a stream of *rows and pins their version. True: ANSWER_STREAM; what *rows owns, its fields, and *places
 * (NULL: none) move to the stream. False: answer_out_of_memory or answer_busy; then they are still the caller's.
 * `heavy`: workers make the rows. */
bool row_stream_begin(struct server *s, struct answer *a, const struct rows *rows, bool heavy,
                      const struct places *places);

void row_stream_free_places(struct server *s, struct places *places);
