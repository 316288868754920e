/* local.c - see local.h. */
#include "tests/server/local.h"

#include "proto/line.h"
#include "server/bodies/load.h"
#include "server/command/command.h"
#include "server/jobs/job.h"
#include "server/jobs/page_cache.h"
#include "server/lifecycle.h"
#include "server/rows/stream.h"
#include "tests/test.h"

#include <poll.h>
#include <string.h>

void local_start(struct local *l, unsigned threads)
{
    *l = (struct local){0};
    config_init(&l->config);
    l->config.threads = threads;
    CHECK(server_init(&l->server, &l->config));
}

void local_stop(struct local *l)
{
    server_clear(&l->server);
    buf_free(&l->out);
}

void local_limit(struct local *l, size_t bytes)
{
    l->config.max_memory = bytes;
    l->server.budget.limit = bytes;
}

struct delivery {
    struct server *server;
    struct answer *answer;
};

static bool has_job(const struct answer *a)
{
    return a->next == ANSWER_WORK || (a->next == ANSWER_WAIT && a->wait_for == WAIT_JOB);
}

static void deliver(void *ctx, struct job *j)
{
    struct delivery *to = ctx;
    if (!has_job(to->answer) || j != to->answer->job) {
        server_finish_abandoned(to->server, j);
        return;
    }
    to->answer->next = ANSWER_DONE;
    job_finish(to->server, j, to->answer);
}

/* Waits for the next completed work of the workers. */
static void collect(struct local *l, struct answer *a)
{
    struct delivery to = {&l->server, a};
    struct pollfd event = {.fd = workers_event(l->server.workers), .events = POLLIN};
    CHECK(poll(&event, 1, 60000) == 1);
    server_collect(&l->server, deliver, &to);
}

void local_collect_all(struct local *l)
{
    struct answer nobody = {.next = ANSWER_DONE};
    while (!list_is_empty(&l->server.jobs))
        collect(l, &nobody);
}

/* Waits until the answer's job has come back. */
static void wait_for_job(struct local *l, struct answer *a)
{
    while (has_job(a))
        collect(l, a);
}

struct answer local_run(struct local *l, const char *request)
{
    struct answer a = {.out = &l->out, .owner = 1, .client.role = ROLE_WRITE};
    buf_consume(&l->out, buf_len(&l->out));
    CHECK(request_split(&l->server.reactor->request, request, strlen(request)));
    command_run(&l->server, &l->server.reactor->request, &a);
    return a;
}

void local_wait(struct local *l, struct answer *a)
{
    wait_for_job(l, a);
    CHECK(a->next == ANSWER_STREAM);
}

struct answer local_begin(struct local *l, const char *request)
{
    struct answer a = local_run(l, request);
    local_wait(l, &a);
    return a;
}

/* Takes the available bytes of the answer's stream, or waits for the next piece. */
static void refill(struct local *l, struct answer *a)
{
    size_t before = buf_len(a->out);
    if (a->next == ANSWER_STREAM)
        stream_refill(&l->server, a);
    if (a->next == ANSWER_STREAM && buf_len(a->out) == before && !list_is_empty(&l->server.jobs))
        collect(l, a);
}

/* Everything that an answer leaves to come. True if the request is to be carried out again. */
static bool complete(struct local *l, struct answer *a)
{
    if (a->next == ANSWER_WAIT &&
        a->wait_for == WAIT_QUEUE) { /* its grid is being rebuilt: there is no other client */
        collect(l, a);
        return true;
    }
    do {
        wait_for_job(l, a);
        refill(l, a);
    } while (has_job(a) || a->next == ANSWER_STREAM);
    l->closed = l->closed || a->closes || a->broken;
    return a->next == ANSWER_WAIT;
}

static struct answer new_answer(struct local *l)
{
    return (struct answer){.out = &l->out, .owner = 1, .client.role = ROLE_WRITE};
}

static size_t load(struct local *l, struct load *load, const char *text, size_t n)
{
    ptrdiff_t took = load->body.complete ? 0 : load_feed(load, text, n, true);
    struct answer a;
    CHECK(took >= 0 && load->body.complete);
    load_settle(load);
    do {
        a = new_answer(l);
        command_run_body(&l->server, load, &a);
    } while (complete(l, &a));
    load_free(&l->server, load);
    return (size_t)took;
}

const char *local_ask(struct local *l, const char *lines)
{
    size_t at = 0, n = strlen(lines);
    struct request *q = &l->server.reactor->request;
    buf_consume(&l->out, buf_len(&l->out));
    l->out.failed = false;
    CHECK(buf_reserve(&l->out, 4096) != NULL);
    while (at < n) {
        struct line line;
        struct answer a = new_answer(l);
        at += (size_t)line_read(lines + at, n - at, true, &line);
        CHECK(request_split(q, line.text, line.len));
        command_run(&l->server, q, &a);
        while (complete(l, &a)) {
            a = new_answer(l);
            command_run(&l->server, q, &a);
        }
        if (a.next == ANSWER_BODY)
            at += load(l, a.load, lines + at, n - at);
        page_cache_turn_end(&l->server);
    }
    buf_append_char(&l->out, '\0');
    return buf_head(&l->out);
}

struct dataset *local_set(const struct local *l, const char *name)
{
    return registry_find(&l->server.sets, &(struct word){name, strlen(name)});
}
