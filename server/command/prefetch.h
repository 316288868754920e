/* prefetch.h - prefetching for pipelines. Requests that have arrived together are parsed together, before the first one is
 * carried out. Queries and edits of single points among them will read data, which is prefetched into the
 * caches for all of them in parallel (core/query/prefetch.c).
 *
 * This is only for short requests that have arrived completely; the session parses all others, and reports
 * errors. */
#pragma once

#include "core/delaunay.h"
#include "proto/request.h"

struct server;
struct reactor;
struct command;
struct answer;

enum { PREFETCH_WORDS = 6 }; /* of a short request */

struct prefetch_request {
    const char *text;                 /* its position in the input */
    size_t len;                       /* its bytes there, with the end of line */
    struct word word[PREFETCH_WORDS]; /* borrow the input */
    size_t n;
    const struct command *command; /* NULL: unknown, or the request is one word */
    bool placed;                   /* `place` has been parsed */
    struct dt_place place;
};

struct prefetch {
    struct prefetch_request of[DT_AHEAD];
    unsigned next, n;             /* the next one, and their number */
    const struct dt_place *place; /* of the request taken last; NULL: not parsed */
};

/* Drops all requests: the input may have moved. */
static inline void prefetch_forget(struct prefetch *a)
{
    a->next = a->n = 0;
    a->place = NULL;
}

/* Whether there are parsed requests that have not been taken yet. */
static inline bool prefetch_has_more(const struct prefetch *a)
{
    return a->next < a->n;
}

/* Moves the request at the front of bytes[n] into r->request and returns its length; 0, with the words undefined,
 * if it cannot be parsed here. Between two calls without prefetch_forget the input may only lose bytes at its
 * front. Cost: amortised linear in the request. */
size_t prefetch_take(const struct server *s, struct reactor *r, const char *bytes, size_t n);

/* Reads the place in the third and fourth word of the current request, with a hint if it has been prefetched. False: the ERR line
 * has been written. */
bool read_place(struct answer *a, const struct request *q, struct dt_place *p);
