/* server.c - see server.h. */
#include "server/server.h"

#include "server/durable.h"
#include "server/job.h"
#include "server/keep.h"
#include "server/loop.h"
#include "server/notice.h"
#include "server/stream.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>

static void discard(void *ctx, struct dt *dt)
{
    job_discard(ctx, dt);
}

bool server_init(struct server *s, struct config *config)
{
    *s = (struct server){.config = config, .started_ms = clock_ms()};
    budget_init(&s->budget, &config->max_memory);
    registry_init(&s->sets);
    s->sets.memory = server_reservation(s, BUDGET_SETS);
    s->queued = server_reservation(s, BUDGET_LOG);
    s->pages = dt_pages_new(config->max_memory);
    s->sets.pages = s->pages;
    s->sets.discard = discard;
    s->sets.discard_ctx = s;
    if (config->auth_file != NULL && !auth_load(&s->auth, config->auth_file))
        return false;
    if (s->pages == NULL || !stats_init(&s->stats) ||
        !slowlog_init(&s->slowlog, config->slowlog_len)) {
        notice(NOTICE_ERROR, "out of memory");
        return false;
    }
    if (config->threads == 0)
        return true;
    s->workers = workers_new(config->threads);
    if (s->workers == NULL) {
        notice(NOTICE_ERROR, "cannot start %u threads", config->threads + 1);
        auth_clear(&s->auth);
    }
    return s->workers != NULL;
}

void server_finish_unheard(struct server *s, struct job *j)
{
    struct buf out = {0};
    struct answer a = {.out = &out};
    job_finish(s, j, &a);
    if (a.next == ANSWER_STREAM)
        stream_free(&s->sets, a.stream);
    buf_free(&out);
}

static void deliver_all(struct server *s, struct work *work,
                        void (*deliver)(void *ctx, struct job *j), void *ctx)
{
    for (struct work *next; work != NULL; work = next) {
        next = work->next;
        if (job_is_early(s, (struct job *)work)) {
            work->next = s->early;
            s->early = work;
        } else {
            deliver(ctx, (struct job *)work);
        }
    }
}

void server_collect(struct server *s, void (*deliver)(void *ctx, struct job *j), void *ctx)
{
    deliver_all(s, workers_collect(s->workers), deliver, ctx);
    struct work *early = s->early;
    s->early = NULL;
    deliver_all(s, early, deliver, ctx);
}

static void deliver_unheard(void *ctx, struct job *j)
{
    server_finish_unheard(ctx, j);
}

void server_drain(struct server *s)
{
    s->draining = true;
    for (struct job *j = s->jobs; j != NULL; j = j->next)
        job_drain(j);
}

void server_clear(struct server *s)
{
    s->stopping = true;
    for (struct job *j = s->jobs; j != NULL; j = j->next)
        j->cancel = true;
    while (s->jobs != NULL) {
        struct pollfd event = {.fd = workers_event(s->workers), .events = POLLIN};
        poll(&event, 1, -1);
        server_collect(s, deliver_unheard, s);
    }
    if (s->workers != NULL)
        workers_free(s->workers);
    durable_stop(s);
    registry_clear(&s->sets);
    dt_pages_free(s->pages);
    auth_clear(&s->auth);
    request_free(&s->request);
    buf_free(&s->lines);
    stats_clear(&s->stats);
    slowlog_clear(&s->slowlog);
    free(s->scratch.v);
}

/* ---- memory ---- */

bool server_reserve(struct server *s, struct answer *a, struct reservation *r, size_t bytes)
{
    bool first = wait_is_first(&s->memory, a->turn);
    if (first && reservation_resize(r, bytes)) {
        keep_account(s);
        return true;
    }
    bool jobs = budget_of(&s->budget, BUDGET_BUILDS) + budget_of(&s->budget, BUDGET_EDITS) > 0;
    if ((jobs || !first) && budget_could_fit(&s->budget, bytes))
        answer_wait(a, &s->memory, false);
    else
        server_refuse(s, a, bytes);
    return false;
}

void server_refuse(const struct server *s, struct answer *a, size_t bytes)
{
    if (budget_could_fit(&s->budget, bytes))
        reply_err(a->out, ERR_BUSY, "others use the memory that this takes; try again");
    else
        reply_err(a->out, ERR_NOMEM, "the memory for sets is used up (--max-memory)");
}

void server_reserved_less(struct server *s)
{
    keep_account(s);
    wait_call(&s->memory);
}
