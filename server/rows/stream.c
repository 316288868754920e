/* stream.c - see stream.h. */
#include "server/rows/stream.h"

#include <stdlib.h>

void stream_refill(struct server *s, struct answer *a)
{
    if (a->stream->kind->refill(s, a->stream, a))
        return;
    a->next = ANSWER_DONE;
    stream_free(s, a->stream);
}

void stream_notify(struct stream *st, void (*ready)(void *ctx), void *ctx)
{
    st->ready = ready;
    st->ctx = ctx;
}

void stream_wake(struct stream *st)
{
    if (st->ready != NULL)
        st->ready(st->ctx);
}

void stream_job_ended(struct server *s, struct stream *st)
{
    st->jobs--;
    if (st->abandoned)
        stream_free(s, st);
    else
        stream_wake(st);
}

void stream_free(struct server *s, struct stream *st)
{
    st->abandoned = true;
    if (st->jobs > 0 && st->kind->cancel != NULL)
        st->kind->cancel(st);
    if (st->jobs > 0)
        return;
    st->kind->clear(s, st);
    reservation_set(&st->memory, 0);
    free(st);
}
