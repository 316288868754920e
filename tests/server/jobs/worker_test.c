/* worker_test.c - worker threads: every piece of work is done once, and the core's pool never waits for
 * a free thread. */
#include "server/jobs/worker.h"
#include "server/system/priority.h"
#include "tests/test.h"

#include <poll.h>
#include <sched.h>
#include <string.h>
#include <sys/resource.h>

struct sum {
    struct work work; /* first */
    const struct dt_pool *pool;
    atomic_uint parts;
    unsigned rounds;
};

static void add_part(void *arg, unsigned i)
{
    atomic_fetch_add((atomic_uint *)arg, i + 1);
}

static void run_sum(struct work *w)
{
    struct sum *s = (struct sum *)w;
    for (unsigned i = 0; i < s->rounds; i++)
        s->pool->run(s->pool->ctx, 100, add_part, &s->parts);
}

/* Collects once; returns how much there was. */
static unsigned collect_some(struct workers *w)
{
    struct list done = {0};
    unsigned n = 0;
    workers_collect(w, &done);
    while (list_pop(&done) != NULL)
        n++;
    return n;
}

static unsigned collect(struct workers *w, unsigned n)
{
    unsigned got = 0;
    while (got < n) {
        struct pollfd event = {.fd = workers_event(w), .events = POLLIN};
        CHECK(poll(&event, 1, 10000) == 1);
        got += collect_some(w);
    }
    return got;
}

static void do_nothing(struct work *w)
{
    (void)w;
}

/* A turn of the loop collects some of it; the others come in later ones. */
TEST(very_much_finished_work_is_collected_in_parts_and_in_order)
{
    enum { JOBS = 1000, MOST = 100 };
    static struct work jobs[JOBS];
    unsigned got = 0;
    struct workers *w = workers_new(1);
    CHECK(w != NULL);
    for (int i = 0; i < JOBS; i++) {
        jobs[i].run = do_nothing;
        workers_submit(w, WORK_SHORT, &jobs[i]);
    }
    poll(NULL, 0, 50);
    while (got < JOBS) {
        struct pollfd event = {.fd = workers_event(w), .events = POLLIN};
        CHECK(poll(&event, 1, 10000) == 1);
        unsigned n = collect_some(w);
        CHECK(n <= MOST);
        got += n;
    }
    CHECK(got == JOBS && collect_some(w) == 0);
    workers_free(w);
}

TEST(work_is_done_and_the_pool_helps_even_if_all_threads_need_help)
{
    enum { JOBS = 40, ROUNDS = 50 };
    static struct sum sums[JOBS];
    for (unsigned threads = 1; threads <= 4; threads++) {
        struct workers *w = workers_new(threads);
        CHECK(w != NULL && workers_pool(w)->threads == threads);
        memset(sums, 0, sizeof sums);
        for (int i = 0; i < JOBS; i++) {
            sums[i].work.run = run_sum;
            sums[i].pool = workers_pool(w);
            sums[i].rounds = ROUNDS;
            workers_submit(w, i % 3 == 0 ? WORK_SHORT : WORK_LONG, &sums[i].work);
        }
        CHECK(collect(w, JOBS) == JOBS);
        for (int i = 0; i < JOBS; i++)
            CHECK(sums[i].parts == ROUNDS * 5050);
        workers_free(w);
    }
}

struct gate {
    struct work work; /* first */
    atomic_bool *open;
};

static void pass_gate(struct work *w)
{
    while (!*((struct gate *)w)->open)
        poll(NULL, 0, 1);
}

TEST(short_work_does_not_wait_for_long_work)
{
    enum { THREADS = 2, LONG = 6 };
    atomic_bool shut = false, open = true;
    struct gate busy[LONG], quick = {{.run = pass_gate}, &open};
    struct workers *w = workers_new(THREADS);
    CHECK(w != NULL);
    for (int i = 0; i < LONG; i++) {
        busy[i] = (struct gate){{.run = pass_gate}, &shut};
        workers_submit(w, WORK_LONG, &busy[i].work);
    }
    workers_submit(w, WORK_SHORT, &quick.work);
    CHECK(collect(w, 1) == 1);
    CHECK(workers_backlog(w) >= LONG - THREADS);
    shut = true;
    CHECK(collect(w, LONG) == LONG);
    workers_free(w);
}

TEST(short_work_never_keeps_long_work_waiting)
{
    enum { BUSY = 2, MORE = 4 };
    atomic_bool first = false, later = false, open = true;
    struct gate busy[BUSY], more[MORE], quick = {{.run = pass_gate}, &open};
    struct workers *w = workers_new(1);
    CHECK(w != NULL);
    for (int i = 0; i < BUSY; i++) { /* both threads have short work */
        busy[i] = (struct gate){{.run = pass_gate}, &first};
        workers_submit(w, WORK_SHORT, &busy[i].work);
    }
    for (int i = 0; i < MORE; i++) {
        more[i] = (struct gate){{.run = pass_gate}, &later};
        workers_submit(w, WORK_SHORT, &more[i].work);
    }
    workers_submit(w, WORK_LONG, &quick.work);
    first = true;
    CHECK(collect(w, BUSY + 1) == BUSY + 1);
    later = true;
    CHECK(collect(w, MORE) == MORE);
    workers_free(w);
}

struct slow {
    struct work work; /* first */
    atomic_uint *running, *most;
    atomic_bool *open;
};

static void run_slow(struct work *w)
{
    struct slow *s = (struct slow *)w;
    unsigned now = atomic_fetch_add(s->running, 1) + 1, most = atomic_load(s->most);
    while (now > most && !atomic_compare_exchange_weak(s->most, &most, now))
        continue;
    while (!*s->open)
        poll(NULL, 0, 1);
    atomic_fetch_sub(s->running, 1);
}

TEST(slow_work_never_occupies_the_last_thread)
{
    enum { SLOW = 9 };
    for (unsigned threads = 1; threads <= 3; threads++) {
        unsigned may = threads > 1 ? threads - 1 : 1;
        atomic_uint running = 0, most = 0;
        atomic_bool shut = false, open = true;
        struct slow slow[SLOW];
        struct gate quick = {{.run = pass_gate}, &open};
        struct workers *w = workers_new(threads);
        CHECK(w != NULL);
        for (int i = 0; i < SLOW; i++) {
            slow[i] = (struct slow){{.run = run_slow}, &running, &most, &shut};
            workers_submit(w, WORK_SLOW, &slow[i].work);
        }
        while (running < may)
            poll(NULL, 0, 1);
        workers_submit(w, threads > 1 ? WORK_LONG : WORK_SHORT, &quick.work);
        CHECK(collect(w, 1) == 1);
        CHECK(running == may);
        shut = true;
        CHECK(collect(w, SLOW) == SLOW);
        CHECK(most == may);
        workers_free(w);
    }
}

static void note_policy(struct work *w)
{
    *((struct gate *)w)->open = sched_getscheduler(0) == SCHED_BATCH;
}

/* Whether this process is scheduled as usual and may choose otherwise. */
static bool may_choose_policy(void)
{
    struct sched_param none = {0};
    return sched_getscheduler(0) == SCHED_OTHER && sched_setscheduler(0, SCHED_OTHER, &none) == 0;
}

TEST(long_work_has_a_lower_priority)
{
    atomic_bool batch = false;
    struct gate g = {{.run = note_policy}, &batch};
    if (!may_choose_policy())
        SKIP("this machine does not allow the choice of a scheduling policy");
    struct workers *w = workers_new(1);
    CHECK(w != NULL);
    workers_submit(w, WORK_LONG, &g.work);
    CHECK(collect(w, 1) == 1);
    CHECK(batch && sched_getscheduler(0) == SCHED_OTHER);
    workers_free(w);
}

TEST(thread_that_asks_for_short_slices_keeps_running)
{
    if (!may_choose_policy())
        SKIP("this machine does not allow the choice of a scheduling policy");
    priority_prompt();
    CHECK(sched_getscheduler(0) == SCHED_OTHER);
    priority_patient();
    CHECK(sched_getscheduler(0) == SCHED_BATCH);
    priority_prompt(); /* does not take that back */
    CHECK(sched_getscheduler(0) == SCHED_BATCH);
}

static long switches_so_far(void)
{
    struct rusage usage;
    CHECK(getrusage(RUSAGE_SELF, &usage) == 0);
    return usage.ru_nvcsw;
}

/* Each of two jobs waits until the other one has begun. */
static void meet(void *arg, unsigned i)
{
    atomic_uint *here = arg;
    (void)i;
    atomic_fetch_add(here, 1);
    while (atomic_load(here) < 2)
        sched_yield();
}

TEST(idle_worker_helps_with_a_call_of_the_pool)
{
    atomic_uint here = 0;
    struct workers *w = workers_new(1);
    CHECK(w != NULL);
    const struct dt_pool *pool = workers_pool(w);
    pool->run(pool->ctx, 2, meet, &here);
    CHECK(here == 2);
    workers_free(w);
}

TEST(one_piece_of_work_wakes_one_worker)
{
    enum { THREADS = 32, PIECES = 300, PER_PIECE = 10 };
    struct work work = {.run = do_nothing};
    struct workers *w = workers_new(THREADS);
    CHECK(w != NULL);
    for (int kind = WORK_SHORT; kind <= WORK_SLOW; kind++) {
        long before = switches_so_far();
        for (int i = 0; i < PIECES; i++) {
            workers_submit(w, (enum work_kind)kind, &work);
            CHECK(collect(w, 1) == 1);
        }
        long switches = switches_so_far() - before;
        CHECK(switches < (long)PIECES * PER_PIECE);
    }
    workers_free(w);
}

/* The thread that was woken for the long work may take the short work. The thread that was woken for the
 * short work may not do the long one, so it must not be the last thread to look at the queue. */
TEST(long_work_starts_while_a_worker_is_idle_whoever_took_the_short_work)
{
    enum { ROUNDS = 500 };
    struct workers *w = workers_new(2);
    CHECK(w != NULL);
    for (int i = 0; i < ROUNDS; i++) {
        atomic_bool open = false;
        struct gate shut = {{.run = pass_gate}, &open};
        struct work quick = {.run = do_nothing};
        workers_submit(w, i % 2 == 0 ? WORK_SHORT : WORK_LONG, i % 2 == 0 ? &shut.work : &quick);
        workers_submit(w, i % 2 == 0 ? WORK_LONG : WORK_SHORT, i % 2 == 0 ? &quick : &shut.work);
        CHECK(collect(w, 1) == 1);
        open = true;
        CHECK(collect(w, 1) == 1);
    }
    workers_free(w);
}
