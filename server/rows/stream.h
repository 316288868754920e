/* stream.h - the rest of a reply, or all of it, which is made while it is sent, at the rate of the socket.
 *
 * There are two kinds: the rows of a set (row_stream.h), and lists of sets, clients or slow requests (listing.h). The
 * structure of a kind begins with a struct stream. All functions are called on a reactor that is alone (loop.h). */
#pragma once

#include "server/jobs/answer.h"
#include "server/jobs/server.h"

struct stream {
    const struct stream_kind *kind;
    bool begun;     /* the reply has its first byte */
    bool framed;    /* it is made in RESP, not in lines */
    bool computes;  /* its rows are searched or computed, and not only read */
    bool abandoned; /* freed while workers use it */
    unsigned jobs;  /* of workers that use it */
    struct reservation memory;
    void (*ready)(void *ctx); /* see stream_notify */
    void *ctx;
};

struct stream_kind {
    /* Appends about one piece to a->out, or nothing if none is ready: then stream_wake is called later. False: the
     * reply has ended; a->broken: although it is not complete. */
    bool (*refill)(struct server *s, struct stream *st, struct answer *a);
    /* Cancels the jobs of the stream; NULL: they are short. */
    void (*cancel)(struct stream *st);
    /* Frees what the stream owns. */
    void (*clear)(struct server *s, struct stream *st);
};

/* Appends the next piece of a->stream, if it is ready; a->next is not ANSWER_STREAM any more when the reply has ended,
 * and the stream has been freed. If nothing was appended, `ready` is called later. */
void stream_refill(struct server *s, struct answer *a);

/* Sets the callback ready(ctx) for when the stream can continue. */
void stream_notify(struct stream *st, void (*ready)(void *ctx), void *ctx);

/* If workers use the stream, it is freed when they are done. */
void stream_free(struct server *s, struct stream *st);

/* ---- for the kinds ---- */

/* The stream can continue. */
void stream_wake(struct stream *st);

/* A job of the stream, which counted in st->jobs, has ended: the stream can continue, or is freed. */
void stream_job_ended(struct server *s, struct stream *st);
