/* listing.h - replies that list sets, clients or slow requests: made a piece per turn of the loop, sorted by a
 * worker if necessary, and sent as fast as the socket accepts them.
 *
 *     pieces, one per turn        a worker        at the rate of the socket
 *     [ 256 ][ 256 ] ... [ 40 ] -> sort by name -> status line, rows
 *
 * Each piece shows the state at its own moment: what is created or removed while the listing is made may be
 * in it or not; what exists all the time is in it once. The text of the rows counts as memory of replies. */
#ifndef SERVER_LISTING_H
#define SERVER_LISTING_H

#include "server/jobs/answer.h"
#include "server/jobs/server.h"

struct listing;

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

/* Answers with a listing from `at` to `end`, whose rows take about `bytes`. If one piece is enough, the reply is
 * complete on return, else a->next is ANSWER_LISTING. */
void listing_answer(struct server *s, struct answer *a, listing_piece *piece, bool sorted,
                    uint64_t at, uint64_t end, size_t bytes);

/* The same, framed for RESP. */
void listing_answer_framed(struct server *s, struct answer *a, listing_piece *piece,
                           enum listing_frame frame, uint64_t at, uint64_t end, size_t bytes);

/* The same from the beginning, with a copy of the pattern in the rows. */
void listing_answer_matching(struct server *s, struct answer *a, listing_piece *piece,
                             enum listing_frame frame, const struct word *pattern, size_t bytes);

/* Makes a piece, or appends about 64 KiB of the rows to a->out; a->next is not ANSWER_LISTING any more when the
 * listing has ended. If nothing was appended, `ready` is called when the listing can continue. */
void listing_refill(struct server *s, struct answer *a);

/* Sets the callback ready(ctx), on the I/O thread, for when the listing can continue. */
void listing_notify(struct listing *l, void (*ready)(void *ctx), void *ctx);

/* Its framing, and whether its first byte has been appended. */
enum listing_frame listing_frame(const struct listing *l);
bool listing_has_begun(const struct listing *l);

/* If a worker has the listing, it is freed when that is done. */
void listing_free(struct listing *l);

#endif
