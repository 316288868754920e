/* page_cache_test.c - pages of dropped sets: reused, within --max-memory, and returned to the system. */
#include "server/jobs/page_cache.h"

#include "core/memory/pages.h"
#include "server/jobs/job.h"
#include "server/lifecycle.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <poll.h>
#include <semaphore.h>
#include <string.h>

enum { POINTS = 200000, ROW = 16 }; /* the coordinates take more than 3 MiB */

/* LOAD SET with distinct points in no particular order; the caller frees it. */
static char *load_of(const char *set)
{
    size_t size = 64 + POINTS * (size_t)ROW, at;
    char *text = malloc(size);
    CHECK(text != NULL);
    at = (size_t)snprintf(text, size, "LOAD %s %d\n", set, POINTS);
    for (uint32_t i = 0; i < POINTS; i++)
        at += (size_t)snprintf(text + at, size - at, "%u %u\n", i * 2654435761u >> 12, i);
    return text;
}

static struct dt_pages_summary facts(const struct local *l)
{
    struct dt_pages_summary f;
    dt_pages_summary(l->server.pages, &f);
    return f;
}

static void tick(struct local *l, unsigned times)
{
    while (times-- > 0)
        page_cache_tick(&l->server);
}

TEST_TIMEOUT(sets_and_loads_reuse_the_pages_of_earlier_ones, 60)
{
    struct local l;
    char *load = load_of("t");
    uint64_t fresh = 0;
    local_start(&l, 0);
    for (int i = 0; i < 2; i++) {
        CHECK(strncmp(local_ask(&l, load), "OK 0 first=0 added=200000 coincident=0", 38) == 0);
        CHECK(strstr(local_ask(&l, "TRIANGULATE t\n"), "points=200000") != NULL);
        CHECK(facts(&l).held > facts(&l).kept);
        local_ask(&l, "DROP t\n");
        CHECK(facts(&l).held == facts(&l).kept && facts(&l).kept > POINTS * (size_t)80);
        CHECK(i == 0 || facts(&l).fresh == fresh);
        fresh = facts(&l).fresh;
    }
    CHECK(strstr(local_ask(&l, "INFO memory\n"), "\nmemory_kept:0\n") == NULL);
    free(load);
    local_stop(&l);
}

static void deliver(void *ctx, struct job *j)
{
    server_finish_abandoned(ctx, j);
}

/* Waits for all jobs of workers. */
static void finish_jobs(struct local *l)
{
    while (!list_is_empty(&l->server.jobs)) {
        struct pollfd event = {.fd = workers_event(l->server.workers), .events = POLLIN};
        CHECK(poll(&event, 1, 10000) == 1);
        server_collect(&l->server, deliver, &l->server);
    }
}

TEST_TIMEOUT(pages_that_are_unused_for_ten_seconds_return_to_the_system, 60)
{
    struct local l;
    char *load = load_of("t");
    local_start(&l, 1);
    for (int i = 0; i < 2; i++) {
        local_ask(&l, load);
        local_ask(&l, "DROP t\n");
        finish_jobs(&l);
        tick(&l, 10);
        CHECK(facts(&l).kept > 0 && list_is_empty(&l.server.jobs));
    }
    tick(&l, 1);
    finish_jobs(&l);
    CHECK(facts(&l).kept == 0 && facts(&l).held == 0);
    tick(&l, 30); /* there is nothing to return */
    CHECK(list_is_empty(&l.server.jobs));
    free(load);
    local_stop(&l);
}

static sem_t go_on;

static void wait_to_go_on(struct job *j)
{
    (void)j;
    CHECK(sem_wait(&go_on) == 0);
}

static void nothing(struct server *s, struct job *j, struct answer *a)
{
    (void)s, (void)j, (void)a;
}

/* The worker is busy with another job first. */
TEST_TIMEOUT(pages_that_are_reused_before_they_return_to_the_system_are_kept, 60)
{
    struct local l;
    char *load = load_of("t");
    struct job *before = job_new(sizeof *before, wait_to_go_on, nothing);
    CHECK(before != NULL && sem_init(&go_on, 0, 0) == 0);
    local_start(&l, 1);
    local_ask(&l, load);
    local_ask(&l, "DROP t\n");
    finish_jobs(&l);
    tick(&l, 10);
    CHECK(facts(&l).kept > 0 && list_is_empty(&l.server.jobs));
    job_aside(&l.server, NULL, before, JOB_SHORT);
    tick(&l, 1);
    void *region = dt_region_take(l.server.pages, DT_HUGE_PAGE);
    CHECK(region != NULL && l.server.releasing);
    dt_region_give(l.server.pages, region, DT_HUGE_PAGE);
    CHECK(sem_post(&go_on) == 0);
    finish_jobs(&l);
    CHECK(facts(&l).kept > 0 && !l.server.releasing);
    free(load);
    local_stop(&l);
}

TEST_TIMEOUT(pages_are_prefaulted_while_points_arrive, 60)
{
    struct local l;
    char *load = load_of("t");
    for (int room = 1; room >= 0; room--) {
        local_start(&l, 1);
        local_limit(&l, room ? l.config.max_memory : 12 << 20);
        server_limit_pages(&l.server);
        bool loaded = strstr(local_ask(&l, load), "added=200000") != NULL;
        finish_jobs(&l);
        CHECK(loaded == (room == 1) && l.server.count.jobs >= 1u + loaded);
        CHECK(l.server.expected == 0 && !l.server.preparing);
        CHECK(room || facts(&l).held <= 12 << 20);
        local_stop(&l);
    }
    free(load);
}

TEST_TIMEOUT(no_more_pages_are_prefaulted_than_a_load_and_its_triangulation_use, 60)
{
    enum { PIECE = 16 << 20 }; /* prefaulted at a time */
    struct local l;
    char *load = load_of("t");
    local_start(&l, 1);
    for (int i = 0; i < 3; i++) {
        CHECK(strstr(local_ask(&l, load), "added=200000") != NULL);
        finish_jobs(&l);
        CHECK(strstr(local_ask(&l, "TRIANGULATE t\n"), "points=200000") != NULL);
        CHECK(facts(&l).kept < PIECE);
        local_ask(&l, "DROP t\n");
    }
    free(load);
    local_stop(&l);
}

TEST_TIMEOUT(kept_and_used_pages_together_stay_below_max_memory, 60)
{
    struct local l;
    char *load = load_of("t");
    local_start(&l, 0);
    local_ask(&l, load);
    size_t used = budget_of(&l.server.budget, BUDGET_SETS);
    local_ask(&l, "TRIANGULATE t\n");
    CHECK(facts(&l).kept > 0);
    local_limit(&l, facts(&l).held - facts(&l).kept + (5 << 20));
    tick(&l, 1); /* more than that is kept */
    CHECK(facts(&l).held <= l.config.max_memory && facts(&l).kept > 0);
    CHECK(strstr(local_ask(&l, "ADD t 1 1\n"), "ERR") == NULL);
    local_ask(&l, "DROP t\n");
    CHECK(facts(&l).held <= l.config.max_memory && facts(&l).kept > used);
    local_limit(&l, 3 << 20);
    CHECK(strstr(local_ask(&l, load), "ERR NOMEM") != NULL);
    tick(&l, 1);
    CHECK(facts(&l).held <= 2 << 20);
    free(load);
    local_stop(&l);
}
