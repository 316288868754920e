/* gate_test.c - a thread that has closed the gate is alone, and no thread waits for ever; loops that share a world. */
#include "server/system/gate.h"

#include "server/system/loop.h"
#include "tests/test.h"

#include <pthread.h>
#include <sched.h>
#include <unistd.h>

enum { THREADS = 4, ROUNDS = 20000 };

static struct lanes lanes;
static struct gate gate;

/* Two numbers that are equal whenever no thread is alone: plain memory, so the thread sanitizer sees every access that the gate does
 * not order. */
static struct {
    uint64_t a, b;
} shared;

static void begin_gate(unsigned threads)
{
    CHECK(lanes_init(&lanes, threads));
    gate_init(&gate, &lanes);
}

struct party {
    pthread_t thread;
    unsigned lane;
    unsigned one_in; /* this share of its rounds closes the gate; 0: none */
    bool visits;     /* it uses no lane */
    uint64_t wrong, closings;
};

static void *take_part(void *arg)
{
    struct party *p = arg;
    for (unsigned i = 0; i < ROUNDS; i++) {
        if (p->one_in > 0 && i % p->one_in == 0) {
            gate_close(&gate);
            shared.a++;
            if (i % 64 == 0)
                sched_yield();
            shared.b++;
            p->closings++;
            if (i % 3 == 0) {
                gate_open_and_enter(&gate, p->lane);
                p->wrong += shared.a != shared.b;
                gate_leave(&gate, p->lane);
            } else {
                gate_open(&gate);
            }
        } else if (p->visits) {
            gate_visit(&gate);
            p->wrong += shared.a != shared.b;
            gate_end_visit(&gate);
        } else {
            gate_enter(&gate, p->lane);
            p->wrong += shared.a != shared.b;
            gate_leave(&gate, p->lane);
        }
    }
    return NULL;
}

/* Every thread that closes is alone, and all threads come to an end. The last `visitors` ones have no lanes. */
static void check(const unsigned one_in[THREADS], unsigned visitors)
{
    struct party party[THREADS];
    uint64_t closings = 0;
    shared.a = shared.b = 0;
    begin_gate(THREADS);
    for (unsigned i = 0; i < THREADS; i++) {
        party[i] =
            (struct party){.lane = i, .one_in = one_in[i], .visits = i + visitors >= THREADS};
        CHECK(pthread_create(&party[i].thread, NULL, take_part, &party[i]) == 0);
    }
    for (unsigned i = 0; i < THREADS; i++) {
        CHECK(pthread_join(party[i].thread, NULL) == 0);
        CHECK(party[i].wrong == 0);
        closings += party[i].closings;
    }
    CHECK(shared.a == closings && shared.b == closings);
    lanes_clear(&lanes);
}

TEST_TIMEOUT(whoever_has_closed_the_gate_is_alone, 60)
{
    check((const unsigned[THREADS]){10, 10, 10, 10}, 0);
    check((const unsigned[THREADS]){1, 0, 0, 0}, 0);
    check((const unsigned[THREADS]){1, 1, 2, 0}, 0);
    check((const unsigned[THREADS]){1000, 0, 0, 0}, 0);
}

TEST_TIMEOUT(whoever_has_closed_the_gate_has_no_visitors, 60)
{
    check((const unsigned[THREADS]){10, 10, 0, 0}, 2);
    check((const unsigned[THREADS]){1, 0, 0, 0}, 3);
    check((const unsigned[THREADS]){3, 3, 3, 3}, 4);
}

/* ---- visitors ---- */

TEST(who_does_not_wait_closes_no_gate_that_somebody_is_inside)
{
    begin_gate(2);
    gate_visit(&gate);
    CHECK(gate_try_visit(&gate) && gate_try_enter(&gate, 0));
    CHECK(!gate_try_close(&gate));
    gate_leave(&gate, 0);
    CHECK(!gate_try_close(&gate) && !gate_close_unvisited(&gate));
    gate_end_visit(&gate);
    CHECK(!gate_try_close(&gate) && !gate_close_unvisited(&gate));
    gate_end_visit(&gate);
    CHECK(gate_try_close(&gate));
    CHECK(!gate_try_close(&gate) && !gate_try_visit(&gate) && !gate_try_enter(&gate, 1));
    gate_open(&gate);
    CHECK(gate_close_unvisited(&gate) && !gate_try_visit(&gate));
    gate_open(&gate);
    gate_enter(&gate, 1);
    CHECK(!gate_try_close(&gate));
    gate_leave(&gate, 1);
    lanes_clear(&lanes);
}

static void *close_once(void *arg)
{
    atomic_uint *closed = arg;
    gate_close(&gate);
    atomic_store(closed, 1);
    gate_open(&gate);
    return NULL;
}

TEST_TIMEOUT(gate_admits_no_new_visitor_while_a_thread_waits_to_close_it, 60)
{
    pthread_t other;
    atomic_uint closed = 0;
    begin_gate(1);
    gate_visit(&gate);
    CHECK(pthread_create(&other, NULL, close_once, &closed) == 0);
    while (gate_try_visit(&gate)) { /* until it waits */
        gate_end_visit(&gate);
        sched_yield();
    }
    CHECK(atomic_load(&closed) == 0);
    gate_end_visit(&gate);
    CHECK(pthread_join(other, NULL) == 0);
    CHECK(atomic_load(&closed) == 1 && gate_try_visit(&gate));
    gate_end_visit(&gate);
    lanes_clear(&lanes);
}

/* ---- who closes it often keeps nobody out ---- */

static void *enter_once(void *arg)
{
    atomic_uint *entered = arg;
    gate_enter(&gate, 1);
    atomic_store(entered, 1);
    gate_leave(&gate, 1);
    return NULL;
}

TEST_TIMEOUT(thread_that_closes_the_gate_again_comes_after_those_that_wait, 60)
{
    pthread_t other;
    atomic_uint entered = 0;
    begin_gate(2);
    gate_close(&gate);
    CHECK(pthread_create(&other, NULL, enter_once, &entered) == 0);
    while (atomic_load(&gate.next) != atomic_load(&gate.served) + 2) /* it waits */
        sched_yield();
    CHECK(atomic_load(&entered) == 0);
    gate_open(&gate);
    gate_close(&gate);
    CHECK(pthread_join(other, NULL) == 0); /* it has been in between, or it would wait for ever */
    CHECK(atomic_load(&entered) == 1);
    gate_open(&gate);
    lanes_clear(&lanes);
}

/* ---- several gates with the same lanes ---- */

TEST(gate_is_closed_without_waiting_for_those_inside_another_gate)
{
    static struct gate other;
    begin_gate(2);
    gate_init(&other, &lanes);
    gate_enter(&gate, 0);
    gate_close(&other); /* or it waits for ever */
    CHECK(gate_try_enter(&gate, 1));
    gate_leave(&gate, 1);
    CHECK(!gate_try_enter(&other, 1));
    CHECK(lanes.of[1].inside == NULL); /* nobody waits for it */
    gate_open(&other);
    CHECK(gate_try_enter(&other, 1));
    gate_leave(&other, 1);
    gate_leave(&gate, 0);
    gate_close(&gate);
    gate_open(&gate);
    lanes_clear(&lanes);
}

/* ---- loops ---- */

static struct loop loop[2];

struct chore {
    struct task task; /* first */
    pthread_t ran_on;
    bool ran, alone;
};

static void do_chore(struct task *t)
{
    struct chore *c = (struct chore *)t;
    c->ran_on = pthread_self();
    c->ran = true;
    c->alone = loop[1].alone;
    loop_stop(&loop[1]);
}

static void *run_second(void *arg)
{
    (void)arg;
    loop_run(&loop[1]);
    loop_leave(&loop[1]);
    return NULL;
}

/* The second loop has nothing to do for days. */
static void begin_loops(pthread_t *second)
{
    enum { LONG_MS = 1000 * 1000 * 1000 };
    begin_gate(2);
    CHECK(loop_init(&loop[0], &gate, 0) && loop_init(&loop[1], &gate, 1));
    loop[1].next_tick_ms = loop[1].now_ms + LONG_MS;
    CHECK(pthread_create(second, NULL, run_second, NULL) == 0);
}

/* The first loop is alone in the world while the second one waits for events. */
static void be_alone_while_the_other_one_sleeps(void)
{
    for (bool asleep = false; !asleep;) {
        loop_leave(&loop[0]);
        loop_enter(&loop[0]);
        loop_alone(&loop[0]);
        asleep = loop[1].asleep;
    }
}

static void end_loops(pthread_t second)
{
    loop_leave(&loop[0]);
    CHECK(pthread_join(second, NULL) == 0);
    loop_clear(&loop[0]);
    loop_clear(&loop[1]);
    lanes_clear(&lanes);
}

static void hand_over(bool shares)
{
    static struct chore chore;
    pthread_t second;
    chore = (struct chore){.task = {.run = do_chore, .shares = shares}};
    begin_loops(&second);
    be_alone_while_the_other_one_sleeps();
    loop_defer(&loop[1], &chore.task);
    end_loops(second);
    CHECK(chore.ran && pthread_equal(chore.ran_on, second) != 0 && chore.alone == !shares);
}

TEST(task_that_another_loop_is_given_runs_there_at_once)
{
    hand_over(false);
    hand_over(true);
}

static bool rang;

static void ring(struct timer *t)
{
    (void)t;
    rang = loop[1].alone;
    loop_stop(&loop[1]);
}

TEST(timer_that_is_set_while_its_loop_sleeps_wakes_the_loop)
{
    static struct timer timer = {.run = ring};
    pthread_t second;
    begin_loops(&second);
    be_alone_while_the_other_one_sleeps();
    loop_at(&loop[1], &timer, clock_ms() + 20);
    end_loops(second);
    CHECK(rang);
}

TEST(loop_that_is_stopped_while_it_sleeps_ends)
{
    pthread_t second;
    begin_loops(&second);
    be_alone_while_the_other_one_sleeps();
    loop_stop(&loop[1]);
    end_loops(second);
}

TEST(loop_that_is_outside_is_not_made_alone_by_another_thread)
{
    begin_gate(2);
    CHECK(loop_init(&loop[0], &gate, 0) && loop_init(&loop[1], &gate, 1));
    loop_enter(&loop[0]);
    CHECK(loop_is_sharing(&loop[0]));
    loop_alone(&loop[0]);
    CHECK(loop[0].alone && !loop_is_sharing(&loop[0]));
    loop_alone(&loop[1]); /* for a session of the second loop */
    CHECK(!loop[1].inside && !loop[1].alone && !loop_is_sharing(&loop[1]));
    loop_share(&loop[1]);
    CHECK(!loop[1].inside);
    loop_share(&loop[0]);
    CHECK(loop_is_sharing(&loop[0]));
    loop_leave(&loop[0]);
    loop_clear(&loop[0]);
    loop_clear(&loop[1]);
    lanes_clear(&lanes);
}
