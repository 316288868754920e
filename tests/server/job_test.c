/* job_test.c - which jobs may wait for a worker, and what is done with the result of one. */
#include "server/job.h"

#include "server/limits.h"
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

static struct dataset *set_of(struct local *l)
{
    return registry_find(&l->server.sets, &(struct word){"t", 1});
}

/* What a job that reads the set is answered when it begins; empty: nothing yet. */
static const char *begin(struct local *l, unsigned how)
{
    struct answer a = {.out = &l->out};
    struct job *j = job_new(sizeof *j, run_until_released, finished);
    CHECK(j != NULL);
    j->memory = server_reservation(&l->server, BUDGET_BUILDS);
    reservation_set(&j->memory, 1000);
    buf_consume(&l->out, buf_len(&l->out));
    job_read(&l->server, &a, j, set_of(l)->current, how);
    buf_append_char(&l->out, '\0');
    return buf_head(&l->out);
}

static void deliver(void *ctx, struct job *j)
{
    server_finish_unheard(ctx, j);
}

TEST(so_many_long_jobs_wait_for_a_worker_and_short_ones_in_any_number)
{
    struct pollfd none = {.fd = -1};
    struct local l;
    local_start(&l, 1);
    local_ask(&l, "ADD t 1 1\n");
    CHECK_STR(begin(&l, JOB_HEAVY), "");
    while (!begun)
        poll(&none, 1, 1);
    for (int i = 0; i < LIMIT_QUEUED_JOBS; i++)
        CHECK_STR(begin(&l, JOB_HEAVY), "");
    CHECK_STR(begin(&l, JOB_HEAVY), "ERR BUSY too many requests wait for a worker; try again\n");
    /* What was refused gives back what it had reserved. */
    CHECK(budget_of(&l.server.budget, BUDGET_BUILDS) == 1000 * (LIMIT_QUEUED_JOBS + 1));
    CHECK_STR(begin(&l, JOB_HEAVY | JOB_BRIEF), "");
    released = true;
    while (l.server.jobs != NULL) {
        struct pollfd event = {.fd = workers_event(l.server.workers), .events = POLLIN};
        CHECK(poll(&event, 1, 10000) == 1);
        server_collect(&l.server, deliver, &l.server);
    }
    CHECK(budget_of(&l.server.budget, BUDGET_BUILDS) == 0);
    local_stop(&l);
}

/* ---- the end of one that changes a set ---- */

static unsigned records;

static void note_record(struct server *s, struct job *j)
{
    (void)s, (void)j;
    records++;
}

static void run_and_fail(struct job *j)
{
    j->status = DT_NOMEM;
}

static void run_well(struct job *j)
{
    j->status = DT_OK;
}

static void edit(struct local *l, void (*run)(struct job *))
{
    struct answer a = {.out = &l->out};
    struct job *j = job_new(sizeof *j, run, finished);
    CHECK(j != NULL);
    j->record = note_record;
    job_write(&l->server, &a, j, set_of(l), 0);
}

TEST(edit_that_fails_is_not_written_down)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, "ADD t 1 1\n");
    edit(&l, run_and_fail);
    CHECK(records == 0);
    edit(&l, run_well);
    CHECK(records == 1);
    local_stop(&l);
}
