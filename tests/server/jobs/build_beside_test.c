/* build_beside_test.c - TRIANGULATE of points that one load has sorted: a worker builds beside the set, and the result is
 * installed when no thread is reading a piece of the set. */
#include "server/command/command.h"
#include "server/jobs/job.h"
#include "server/lifecycle.h"
#include "server/sets/dataset.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>

enum { POINTS = 20000 };

static void load(struct local *l)
{
    static char text[POINTS * 32];
    size_t at = (size_t)sprintf(text, "LOAD t\n");
    local_start(l, 2);
    for (int i = 0; i < POINTS; i++)
        at += (size_t)sprintf(text + at, "%.6f %.6f\n", test_uniform(), test_uniform());
    strcpy(text + at, ".\n");
    CHECK(strncmp(local_ask(l, text), "OK 0 first=0 added=20000 ", 25) == 0);
}

/* A worker begins to triangulate the set. */
static struct job *begin(struct local *l)
{
    static const char line[] = "TRIANGULATE t";
    struct request *q = &l->server.reactor->request;
    struct answer a = {.out = &l->out, .owner = 1, .client.role = ROLE_WRITE};
    CHECK(request_split(q, line, strlen(line)));
    command_run(&l->server, q, &a);
    CHECK(a.next == ANSWER_WORK && a.job == local_set(l, "t")->writer);
    return a.job;
}

static void deliver(void *ctx, struct job *j)
{
    server_finish_abandoned(ctx, j);
}

static void collect(struct local *l)
{
    struct pollfd event = {.fd = workers_event(l->server.workers), .events = POLLIN};
    CHECK(poll(&event, 1, 10000) == 1);
    server_collect(&l->server, deliver, &l->server);
}

TEST(loaded_points_are_read_while_they_are_triangulated_and_not_copied)
{
    struct local l;
    load(&l);
    struct dataset *set = local_set(&l, "t");
    struct version *v = set->current;
    uint64_t before = set->version;
    begin(&l);
    CHECK(!set->exclusive);
    CHECK(strncmp(local_ask(&l, "GET t 7\n"), "OK 1\n7 ", 7) == 0);
    while (set->writer != NULL)
        collect(&l);
    CHECK(set->current == v && v->sum.triangulated && v->sum.current && set->version > before);
    CHECK(strncmp(local_ask(&l, "CHECK t\n"), "OK 0 delaunay=yes points=20000 ", 31) == 0);
    local_stop(&l);
}

TEST(build_is_installed_when_the_reader_of_a_piece_has_finished)
{
    struct local l;
    load(&l);
    struct dataset *set = local_set(&l, "t");
    struct version *v = set->current;
    begin(&l);
    gate_visit(&v->gate); /* as a worker's query does */
    while (!set->exclusive)
        collect(&l);
    CHECK(set->writer != NULL && set->exclusive && !v->sum.triangulated);
    gate_end_visit(&v->gate);
    CHECK(strncmp(local_ask(&l, "CHECK t\n"), "OK 0 delaunay=yes points=20000 ", 31) == 0);
    CHECK(set->current == v && !set->exclusive);
    local_stop(&l);
}

TEST(build_that_is_cancelled_changes_nothing)
{
    struct local l;
    load(&l);
    struct dataset *set = local_set(&l, "t");
    uint64_t before = set->version;
    struct job *j = begin(&l);
    j->cancel = true;
    while (set->writer != NULL)
        collect(&l);
    CHECK(set->version == before ||
          set->current->sum.triangulated); /* it may have ended just before */
    CHECK(strncmp(local_ask(&l, "TRIANGULATE t\nCHECK t\n"), "OK 0 points=20000 ", 18) == 0);
    CHECK(budget_of(&l.server.budget, BUDGET_BUILDS) == 0);
    local_stop(&l);
}

TEST(server_may_stop_while_it_builds)
{
    struct local l;
    load(&l);
    begin(&l);
    local_stop(&l);
}
