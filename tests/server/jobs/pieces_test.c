/* pieces_test.c - jobs that a worker does in pieces: how far they are, and that a cancelled one has no result. */
#include "server/command/command.h"
#include "server/jobs/job.h"
#include "server/lifecycle.h"
#include "server/sets/dataset.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>

enum { POINTS = 40000 };

static void load(struct local *l, const char *last)
{
    static char text[POINTS * 24];
    size_t at = (size_t)sprintf(text, "LOAD t\n");
    local_start(l, 1);
    for (int i = 0; i < POINTS; i++)
        at += (size_t)sprintf(text + at, "%.6f %.6f\n", test_uniform(), test_uniform());
    sprintf(text + at, ".\n%s", last);
    CHECK(strncmp(local_ask(l, text), "OK 0 first=0 ", 13) == 0);
}

static struct job *begin(struct local *l, const char *line)
{
    struct request *q = &l->server.reactor->request;
    struct answer a = {.out = &l->out, .owner = 1, .client.role = ROLE_WRITE};
    CHECK(request_split(q, line, strlen(line)));
    command_run(&l->server, q, &a);
    CHECK(a.next == ANSWER_WORK && job_first(&l->server) == a.job);
    return a.job;
}

struct outcome {
    struct local *l;
    enum dt_status status;
};

static void deliver(void *ctx, struct job *j)
{
    struct outcome *o = ctx;
    o->status = j->status;
    server_finish_abandoned(&o->l->server, j);
}

static enum dt_status finish(struct local *l)
{
    struct outcome o = {.l = l};
    while (!list_is_empty(&l->server.jobs)) {
        struct pollfd event = {.fd = workers_event(l->server.workers), .events = POLLIN};
        CHECK(poll(&event, 1, 10000) == 1);
        server_collect(&l->server, deliver, &o);
    }
    return o.status;
}

/* Until a worker has been seen in the middle of its work. */
static void expect_progress(const char *line)
{
    struct local l;
    unsigned most = 0;
    load(&l, "TRIANGULATE t\n");
    for (int i = 0; i < 200 && most == 0; i++) {
        struct pollfd event = {.events = POLLIN};
        const struct job *j = begin(&l, line);
        event.fd = workers_event(l.server.workers);
        while (poll(&event, 1, 0) == 0) {
            unsigned now = atomic_load(&j->progress);
            CHECK(now <= 100);
            most = now > most ? now : most;
        }
        CHECK(finish(&l) == DT_OK);
    }
    CHECK_MSG(most > 0, "%s", line);
    local_stop(&l);
}

TEST_TIMEOUT(alpha_shape_says_how_far_it_is, 60)
{
    expect_progress("ALPHA t 0.01");
}

TEST_TIMEOUT(areas_say_how_far_they_are, 60)
{
    expect_progress("AREAS t BOX -1 -1 2 2");
}

/* The worker has begun, and waits for the set, when the job is cancelled. */
TEST(cancelled_search_of_an_untriangulated_set_has_no_result)
{
    static const char *const lines[] = {"WITHIN t -1 -1 2 2", "WITHIN t 0.5 0.5 9",
                                        "NEAREST t 0 0 30000"};
    struct local l;
    load(&l, "");
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        struct version *v = local_set(&l, "t")->current;
        gate_close(&v->gate);
        struct job *j = begin(&l, lines[i]);
        poll(NULL, 0, 10);
        atomic_store(&j->cancel, true);
        gate_open(&v->gate);
        CHECK_MSG(finish(&l) == DT_CANCELLED, "%s", lines[i]);
    }
    local_stop(&l);
}
