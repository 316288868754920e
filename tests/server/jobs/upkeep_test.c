/* upkeep_test.c - a worker rebuilds the grid of a set while queries continue. */
#include "server/jobs/job.h"
#include "server/lifecycle.h"
#include "server/sets/dataset.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>

enum { POINTS = 10500, PIECE = 500 };

/* Adds n points, each by a request of its own. */
static void add_points(struct local *l, unsigned n)
{
    static char text[PIECE * 64];
    size_t at = 0;
    for (unsigned i = 0; i < n; i++)
        at += (size_t)sprintf(text + at, "ADD t %.6f %.6f\n", test_uniform(), test_uniform());
    local_ask(l, text);
}

/* A large set whose grid a worker is rebuilding or has rebuilt. */
static void start_renewal(struct local *l)
{
    local_start(l, 2);
    for (unsigned n = 0; n < POINTS; n += PIECE)
        add_points(l, PIECE);
    local_ask(l, "TRIANGULATE t\n");
    CHECK(local_set(l, "t")->writer == NULL);
    for (unsigned n = 0; local_set(l, "t")->writer == NULL; n++) {
        CHECK(n < 2 * POINTS);
        add_points(l, 1);
    }
}

static void finish(void *ctx, struct job *j)
{
    struct local *l = ctx;
    struct answer a = {.out = &l->out, .owner = j->owner, .client.role = ROLE_WRITE};
    job_finish(&l->server, j, &a);
}

TEST(queries_continue_while_a_worker_rebuilds_the_grid)
{
    struct local l;
    start_renewal(&l);
    struct dataset *set = local_set(&l, "t");
    struct job *j = set->writer;
    CHECK(!set->exclusive && dt_renew_due(set->current->dt));
    for (int i = 0; i < 50; i++)
        CHECK(strncmp(local_ask(&l, "NEAREST t 0.5 0.5\nLOCATE t 0.1 0.1\n"), "OK 1\n", 5) == 0);
    CHECK(set->writer == j && dt_renew_due(set->current->dt));
    CHECK(strncmp(local_ask(&l, "ADD t 0.25 0.25\n"), "OK 0 first=", 11) == 0); /* it waits */
    CHECK(set->writer == NULL && !dt_renew_due(set->current->dt));
    CHECK(strncmp(local_ask(&l, "CHECK t\n"), "OK 0 delaunay=yes", 17) == 0);
    local_stop(&l);
}

/* The exchange waits on a worker until the piece that is being read with the old grid is complete. */
TEST(grid_that_is_in_use_is_exchanged_when_its_reader_has_finished)
{
    struct local l;
    struct pollfd event;
    start_renewal(&l);
    struct dataset *set = local_set(&l, "t");
    struct version *v = set->current;
    gate_visit(&v->gate); /* as a worker's query does */
    event = (struct pollfd){.fd = workers_event(l.server.workers), .events = POLLIN};
    CHECK(poll(&event, 1, 10000) == 1);
    server_collect(&l.server, finish, &l);
    CHECK(set->writer != NULL && set->exclusive);
    CHECK(dt_renew_due(v->dt));
    gate_end_visit(&v->gate);
    CHECK(strncmp(local_ask(&l, "ADD t 0.25 0.25\n"), "OK 0 first=", 11) == 0);
    CHECK(set->current == v && !dt_renew_due(v->dt));
    CHECK(strncmp(local_ask(&l, "DEL t 0\n"), "OK 0 deleted=1 ", 15) == 0);
    CHECK(strncmp(local_ask(&l, "CHECK t\n"), "OK 0 delaunay=yes", 17) == 0);
    local_stop(&l);
}

TEST(set_may_be_dropped_while_its_grid_is_rebuilt)
{
    struct local l;
    start_renewal(&l);
    CHECK_STR(local_ask(&l, "DROP t\nSETS\n"), "OK 0\nOK 0\n");
    local_stop(&l);
    start_renewal(&l);
    local_stop(&l);
}

TEST(searches_work_without_a_grid_when_memory_is_out)
{
    struct local l;
    local_start(&l, 2);
    for (unsigned n = 0; n < POINTS; n += PIECE)
        add_points(&l, PIECE);
    local_ask(&l, "ADD t 0.5 0.5\nTRIANGULATE t\n");
    struct dataset *set = local_set(&l, "t");
    size_t plenty = l.config.max_memory;
    local_limit(&l, budget_of(&l.server.budget, BUDGET_SETS));
    CHECK(!set->current->sum.searchable);
    for (int i = 0; i < 3; i++)
        CHECK_STR(local_ask(&l, "NEAREST t 0.5 0.5\n"), "OK 1\n10500 0.5 0.5 0\n");
    CHECK(!set->current->sum.searchable);
    CHECK(strncmp(local_ask(&l, "ADD t 0.6 0.6\n"), "ERR NOMEM ", 10) == 0);
    CHECK_STR(local_ask(&l, "DEL t 0\n"),
              "OK 0 deleted=1\n"); /* changes that free memory are never refused */
    CHECK(set->current->sum.searchable && budget_of(&l.server.budget, BUDGET_BUILDS) == 0);
    local_limit(&l, plenty);
    CHECK(strncmp(local_ask(&l, "ADD t 0.6 0.6\n"), "OK 0 ", 5) == 0);
    local_stop(&l);
}
