/* listing.h - streams that list sets, clients or slow requests. They are made a piece per turn of the loop, sorted by a
 * worker if necessary, and sent as fast as the socket accepts them.
 *
 *     pieces, one per turn        a worker        at the rate of the socket
 *     [ 256 ][ 256 ] ... [ 40 ] -> sort by name -> status line, rows
 *
 * Each piece shows the state at its own moment. An item that is created or removed while the listing is made may be
 * in it or not; an item that exists all the time is in it once. The text of the rows counts as memory of replies. */
#pragma once

#include "server/rows/stream.h"

/* The rows that have been made. */
struct listing_rows {
    struct buf text; /* owns */
    uint64_t n;
    uint64_t shown;      /* the last change that they show; 0: none */
    const char *pattern; /* borrows: what the rows have to match; NULL: nothing */
    size_t pattern_len;
};

enum { LISTING_PATTERN = 256 }; /* bytes of a pattern, at most */

/* Appends the rows of the piece that begins at position *at, whose meaning is the function's own, and advances
 * *at. False: it was the last piece. */
typedef bool listing_piece(struct server *s, uint64_t *at, uint64_t end, struct listing_rows *rows);

enum listing_frame {
    LISTING_LINES, /* a status line and rows */
    LISTING_BULK,  /* for RESP: one bulk string of all rows */
    LISTING_ARRAY  /* for RESP: the rows are elements of an array, framed already */
};

struct listing_plan {
    listing_piece *piece;
    uint64_t at, end;
    bool sorted; /* the rows are sorted by their first words */
    enum listing_frame frame;
    const struct word *pattern; /* borrows: the rows get a copy; NULL: none */
    size_t bytes;               /* of all rows, about */
};

/* Answers with a listing. If one piece is enough, the reply is complete on return, else a->next is ANSWER_STREAM. */
void listing_answer(struct server *s, struct answer *a, const struct listing_plan *plan);
