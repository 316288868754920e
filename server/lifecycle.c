/* lifecycle.c - see lifecycle.h. */
#include "server/lifecycle.h"

#include "server/command/prefetch.h"
#include "server/commands.h"
#include "server/follow/follower.h"
#include "server/follow/leader.h"
#include "server/info.h"
#include "server/jobs/durable.h"
#include "server/jobs/job.h"
#include "server/rows/stream.h"
#include "server/sets/skip_copy.h"
#include "server/system/loop.h"
#include "server/system/notice.h"
#include "server/watch/watch.h"

#include <poll.h>
#include <stdlib.h>

static void discard(void *ctx, struct dt *dt)
{
    job_discard(ctx, dt);
}

static bool start_reactor(struct server *s, unsigned i)
{
    struct reactor *r = &s->reactor[i];
    r->number = i;
    r->server = s;
    r->push = (struct task){.run = durable_push, .shares = true};
    r->prefetch = calloc(1, sizeof *r->prefetch);
    return r->prefetch != NULL && stats_init(&r->stats) && loop_init(&r->loop, s->world, i);
}

/* Makes the gates of the world and of sets, which several reactors need. */
static bool init_gates(struct server *s, unsigned n)
{
    s->world = malloc(sizeof *s->world);
    if (s->world == NULL || !lanes_init(&s->in_world, n) || !lanes_init(&s->sets.lanes, n))
        return false;
    gate_init(s->world, &s->in_world);
    s->sets.world = s->world;
    return true;
}

static bool start_reactors(struct server *s, unsigned n)
{
    s->reactor = calloc(n, sizeof *s->reactor);
    if (s->reactor == NULL || (n > 1 && !init_gates(s, n)))
        return false;
    while (s->reactors < n)
        if (!start_reactor(s, s->reactors++))
            return false;
    loop_enter(&s->reactor->loop);
    loop_alone(&s->reactor->loop);
    return true;
}

static void end_reactor(struct reactor *r)
{
    loop_clear(&r->loop);
    request_free(&r->request);
    free(r->prefetch);
    buf_free(&r->lines);
    stats_clear(&r->stats);
    free(r->scratch.v);
}

static void end_reactors(struct server *s)
{
    for (unsigned i = 0; i < s->reactors; i++)
        end_reactor(&s->reactor[i]);
    free(s->reactor);
    lanes_clear(&s->in_world);
    lanes_clear(&s->sets.lanes);
    free(s->world);
}

bool server_init(struct server *s, struct config *config)
{
    *s = (struct server){.config = config, .started_ms = clock_ms()};
    s->commands = commands;
    s->command_count = command_count;
    s->info = info_section;
    s->pages = dt_pages_new(config->max_memory);
    budget_init(&s->budget, config->max_memory, s->pages);
    registry_init(&s->sets);
    registry_begin_life_in_memory(&s->sets); /* with --data until that has been read */
    s->sets.budget = &s->budget;
    s->queued = server_reservation(s, BUDGET_LOG);
    s->sets.pages = s->pages;
    s->sets.discard = discard;
    s->sets.discard_ctx = s;
    s->sets.forget = skip_copy_forget;
    s->sets.changed = watch_changed;
    s->sets.dropped = watch_dropped;
    if (config->auth_file != NULL && !auth_load(&s->auth, config->auth_file))
        return false;
    if (s->pages == NULL || !start_reactors(s, config->reactors) ||
        !slowlog_init(&s->slowlog, config->slowlog_len))
        return notice_error("out of memory");
    if (config->threads == 0)
        return true;
    s->workers = workers_new(config->threads);
    if (s->workers == NULL) {
        notice_error("cannot start %u threads", config->threads + 1);
        auth_clear(&s->auth);
    }
    return s->workers != NULL;
}

void server_finish_abandoned(struct server *s, struct job *j)
{
    struct buf out = {0};
    struct answer a = {.out = &out};
    job_finish(s, j, &a);
    if (a.next == ANSWER_STREAM)
        stream_free(s, a.stream);
    buf_free(&out);
}

void server_collect(struct server *s, void (*deliver)(void *ctx, struct job *j), void *ctx)
{
    struct list done = {0};
    workers_collect(s->workers, &done);
    for (struct job *j; (j = list_pop(&done)) != NULL;)
        deliver(ctx, j);
}

static void deliver_abandoned(void *ctx, struct job *j)
{
    server_finish_abandoned(ctx, j);
}

void server_drain(struct server *s)
{
    s->draining = true;
    for (struct job *j = job_first(s); j != NULL; j = job_next(s, j))
        job_drain(j);
}

void server_clear(struct server *s)
{
    s->stopping = true;
    for (struct job *j = job_first(s); j != NULL; j = job_next(s, j))
        j->cancel = true;
    while (!list_is_empty(&s->jobs)) {
        struct pollfd event = {.fd = workers_event(s->workers), .events = POLLIN};
        poll(&event, 1, -1);
        server_collect(s, deliver_abandoned, s);
    }
    if (s->workers != NULL)
        workers_free(s->workers);
    follower_stop(s);
    leader_stop(s);
    durable_stop(s);
    free(s->loading.set);
    registry_clear(&s->sets);
    watch_clear(s);
    dt_pages_free(s->pages);
    auth_clear(&s->auth);
    slowlog_clear(&s->slowlog);
    end_reactors(s);
}
