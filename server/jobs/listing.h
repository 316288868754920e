/* listing.h - replies about many sets, clients or slow requests: made a piece per turn of the loop,
 * sorted by a worker if need be, and sent as the socket takes them.
 *
 *     pieces, one per turn        a worker        as the socket takes it
 *     [ 256 ][ 256 ] ... [ 40 ] -> sort by name -> status line, rows
 *
 * A piece shows the state at its own moment: what comes or goes while the listing is made may be in
 * it or not, and what is there all the time is in it once. The text of the rows is reserved as memory
 * for replies. */
#ifndef SERVER_LISTING_H
#define SERVER_LISTING_H

#include "server/jobs/answer.h"
#include "server/jobs/server.h"

struct listing;

/* The rows that have been made. */
struct listing_rows {
    struct buf text; /* owns */
    uint64_t n;
    uint64_t shown; /* the last change that they may show; 0: none */
};

/* What is listed: the row after row `at`, which is anything. Appends the rows of a piece and moves
 * *at on; false: that was the last. */
typedef bool listing_piece(struct server *s, uint64_t *at, uint64_t end, struct listing_rows *rows);

enum listing_frame {
    LISTING_LINES, /* a status line and rows */
    LISTING_BULK,  /* for RESP: one bulk string of all rows */
    LISTING_ARRAY  /* for RESP: the rows are elements of an array, framed already */
};

/* Answers with a listing from `at` to `end`, whose rows take about so many bytes. If it is a piece
 * long, the reply is there on return, else the listing is left in a->listing. */
void listing_answer(struct server *s, struct answer *a, listing_piece *piece, bool sorted,
                    uint64_t at, uint64_t end, size_t bytes);

/* The same, framed for RESP. */
void listing_answer_framed(struct server *s, struct answer *a, listing_piece *piece,
                           enum listing_frame frame, uint64_t at, uint64_t end, size_t bytes);

/* Makes a piece, or appends about 64 KiB of what has been made to a->out; what is left is in
 * a->listing. If nothing was appended, the listing calls `ready` when it can go on. */
void listing_refill(struct server *s, struct answer *a);

/* Has the listing call ready(ctx) on the I/O thread when it can go on. */
void listing_tell(struct listing *l, void (*ready)(void *ctx), void *ctx);

/* How it is framed, and whether its first byte has been appended. */
enum listing_frame listing_frame(const struct listing *l);
bool listing_has_begun(const struct listing *l);

/* It may be with a worker: then it goes when that is done. */
void listing_free(struct listing *l);

#endif
