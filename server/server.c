/* server.c - see server.h. */
#include "server/server.h"

#include "server/durable.h"
#include "server/job.h"
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
    registry_init(&s->sets);
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
    if (a.stream != NULL)
        stream_free(&s->sets, a.stream);
    buf_free(&out);
}

void server_collect(struct server *s, void (*deliver)(void *ctx, struct job *j), void *ctx)
{
    struct work *work = workers_collect(s->workers);
    while (work != NULL) {
        struct work *next = work->next;
        deliver(ctx, (struct job *)work);
        work = next;
    }
}

static void deliver_unheard(void *ctx, struct job *j)
{
    server_finish_unheard(ctx, j);
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

bool server_lacks_memory(const struct server *s, size_t more)
{
    size_t used = s->sets.memory + s->loading;
    return used > s->config->max_memory || more > s->config->max_memory - used;
}
