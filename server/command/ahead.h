/* ahead.h - reading ahead in a pipeline. Requests that have come at once are taken apart all together,
 * before the first is carried out: what the queries and the edits of single points among them will
 * look at is fetched into the caches for all of them side by side (core/ahead.c), and each is ready
 * when its turn comes.
 *
 * Only requests that have arrived whole and are short are kept; the session reads the others itself,
 * and tells what is wrong with them. */
#ifndef SERVER_AHEAD_H
#define SERVER_AHEAD_H

#include "core/delaunay.h"
#include "proto/request.h"

struct server;

enum { AHEAD_WORDS = 6 }; /* of a request that is kept */

struct ahead_request {
    const char *text;              /* where in the input it begins */
    size_t len;                    /* its bytes there, its end included */
    struct word word[AHEAD_WORDS]; /* borrow the input */
    size_t n;
    bool placed; /* it is about a place, and that has been read */
    struct dt_place place;
};

struct ahead {
    struct ahead_request of[DT_AHEAD];
    unsigned next, n;             /* the next one, and how many there are */
    const struct dt_place *place; /* of the request taken last; NULL: it has not been read */
};

/* Forgets what has been read: the input may have moved. */
static inline void ahead_forget(struct ahead *a)
{
    a->next = a->n = 0;
    a->place = NULL;
}

/* Whether requests that have been read are still to be taken. */
static inline bool ahead_has_more(const struct ahead *a)
{
    return a->next < a->n;
}

/* Takes the request at the front of bytes[n] into s->request and returns its length; 0, with the
 * words undefined, if it is not among those that can be read ahead. Between two calls without
 * ahead_forget the input may only lose bytes at its front. Cost: amortised linear in the request. */
size_t ahead_take(struct server *s, const char *bytes, size_t n);

#endif
