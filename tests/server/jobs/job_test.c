/* job_test.c - which jobs may wait for a worker, and what happens to the result of a job. */
#include "server/jobs/job.h"

#include "server/bodies/load.h"
#include "server/command/command.h"
#include "server/lifecycle.h"
#include "server/ops/limits.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <poll.h>
#include <stdatomic.h>
#include <string.h>

static atomic_bool begun, released;

static void run_until_released(struct job *j)
{
    struct pollfd none = {.fd = -1};
    (void)j;
    begun = true;
    while (!released)
        poll(&none, 1, 1);
}

static void finished(struct server *s, struct job *j, struct answer *a)
{
    (void)s, (void)j, (void)a;
}

/* The reply to a job that reads the set, when it begins; empty: none yet. */
static const char *begin(struct local *l, enum job_weight weight)
{
    struct answer a = {.out = &l->out};
    struct job *j = job_new(sizeof *j, run_until_released, finished);
    CHECK(j != NULL);
    j->memory = server_reservation(&l->server, BUDGET_BUILDS);
    reservation_set(&j->memory, 1000);
    buf_consume(&l->out, buf_len(&l->out));
    job_read(&l->server, &a, j, local_set(l, "t")->current, weight);
    buf_append_char(&l->out, '\0');
    return buf_head(&l->out);
}

static void deliver(void *ctx, struct job *j)
{
    server_finish_abandoned(ctx, j);
}

TEST(long_jobs_that_wait_for_a_worker_are_limited_and_short_ones_are_not)
{
    struct pollfd none = {.fd = -1};
    struct local l;
    local_start(&l, 1);
    local_ask(&l, "ADD t 1 1\n");
    CHECK_STR(begin(&l, JOB_LONG), "");
    while (!begun)
        poll(&none, 1, 1);
    for (int i = 0; i < LIMIT_QUEUED_JOBS; i++)
        CHECK_STR(begin(&l, JOB_LONG), "");
    CHECK_STR(begin(&l, JOB_LONG),
              "ERR BUSY too many requests are waiting for a worker; try again\n");
    /* A refused job releases what it had reserved. */
    CHECK(budget_of(&l.server.budget, BUDGET_BUILDS) == 1000 * (LIMIT_QUEUED_JOBS + 1));
    CHECK_STR(begin(&l, JOB_SHORT), "");
    released = true;
    while (!list_is_empty(&l.server.jobs)) {
        struct pollfd event = {.fd = workers_event(l.server.workers), .events = POLLIN};
        CHECK(poll(&event, 1, 10000) == 1);
        server_collect(&l.server, deliver, &l.server);
    }
    CHECK(budget_of(&l.server.budget, BUDGET_BUILDS) == 0);
    local_stop(&l);
}

static void reserve_until_released(struct job *j)
{
    begun = true;
    for (size_t bytes = 1000; !released; bytes = 3000 - bytes)
        (void)job_reserve(j, bytes);
}

/* For the thread sanitizer. */
TEST(limit_of_memory_is_set_while_a_worker_reserves_some)
{
    struct pollfd none = {.fd = -1};
    struct local l;
    local_start(&l, 1);
    local_ask(&l, "ADD t 1 1\n");
    struct buf out = {0};
    struct answer a = {.out = &out};
    struct job *j = job_new(sizeof *j, reserve_until_released, finished);
    CHECK(j != NULL);
    j->memory = server_reservation(&l.server, BUDGET_BUILDS);
    job_read(&l.server, &a, j, local_set(&l, "t")->current, JOB_SHORT);
    while (!begun)
        poll(&none, 1, 1);
    for (int i = 0; i < 100; i++)
        CHECK_STR(
            local_ask(&l, i % 2 == 0 ? "CONFIG SET max-memory 1m\n" : "CONFIG SET max-memory 1g\n"),
            "OK 0\n");
    CHECK(l.server.budget.limit == (size_t)1 << 30);
    released = true;
    local_collect_all(&l);
    CHECK(budget_of(&l.server.budget, BUDGET_BUILDS) == 0);
    local_stop(&l);
}

TEST(edit_that_fails_gives_the_set_no_new_version)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, "ADD t 1 1\n");
    uint64_t version = local_set(&l, "t")->version;
    CHECK_STR(local_ask(&l, "MOVE t 1 5 5\n"), "ERR NOPOINT there is no point 1\n");
    CHECK(local_set(&l, "t")->version == version);
    CHECK_STR(local_ask(&l, "MOVE t 0 5 5\n"), "OK 0\n");
    CHECK(local_set(&l, "t")->version > version);
    local_stop(&l);
}

/* ---- requests for a set that another client is creating or editing ---- */

TEST(set_that_is_about_to_be_created_does_not_exist_for_readers)
{
    struct local l;
    local_start(&l, 0);
    CHECK(registry_create(&l.server.sets, &(struct word){"t", 1}, 0) != NULL);
    CHECK_STR(local_ask(&l, "POINTS t\n"), "ERR NOSET there is no set t\n");
    CHECK_STR(local_ask(&l, "DROP u\n"), "ERR NOSET there is no set u\n");
    local_stop(&l);
}

static struct load *begin_load(struct local *l, const char *line)
{
    struct request *q = &l->server.reactor->request;
    struct answer a = {.out = &l->out, .owner = 1, .client.role = ROLE_WRITE};
    CHECK(request_split(q, line, strlen(line)));
    command_run(&l->server, q, &a);
    CHECK(a.next == ANSWER_BODY);
    return a.load;
}

TEST(load_whose_points_have_arrived_waits_for_its_turn)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, "ADD t 1 1\n");
    struct dataset *set = local_set(&l, "t");
    set->writer = (struct job *)(void *)&l; /* only compared with NULL */
    struct load *load = begin_load(&l, "LOAD t 1");
    struct answer a = {.out = &l.out, .owner = 1, .client.role = ROLE_WRITE};
    CHECK(load_feed(load, "2 2\n", 4, false) == 4 && load->body.complete);
    command_run_body(&l.server, load, &a);
    CHECK(a.next == ANSWER_WAIT && a.wait == &set->queue && set->current->sum.points == 1);
    set->writer = NULL;
    a.next = ANSWER_DONE;
    command_run_body(&l.server, load, &a);
    CHECK(a.next == ANSWER_DONE && set->current->sum.points == 2);
    load_free(&l.server, load);
    local_stop(&l);
}

TEST(load_that_is_refused_releases_its_memory_at_once)
{
    struct local l;
    local_start(&l, 0);
    struct load *load = begin_load(&l, "LOAD t 3");
    CHECK(load_feed(load, "2 2\n", 4, false) == 4);
    CHECK(budget_of(&l.server.budget, BUDGET_LOADS) > 0);
    CHECK(load_feed(load, "2 x\n", 4, false) == 4 && !load->body.complete);
    CHECK(budget_of(&l.server.budget, BUDGET_LOADS) == 0);
    load_free(&l.server, load);
    local_stop(&l);
}
