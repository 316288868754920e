/* loop_test.c - turns of the loop: deferred tasks run in each turn, yielded tasks alternate. */
#include "server/system/loop.h"
#include "tests/test.h"

#include <poll.h>
#include <stddef.h>

enum { GREEDY = 100, TURNS = 60, WORK_NS = 200 * 1000 };

static struct loop loop;
static struct task deferred;
static unsigned turns;

struct greedy {
    struct task task; /* first */
    unsigned runs;
} greedy[GREEDY];

static void work(struct task *t)
{
    ((struct greedy *)t)->runs++;
    for (int64_t end = clock_ns() + WORK_NS; clock_ns() < end;)
        ;
    loop_yield(&loop, t);
}

static void count_turn(struct task *t)
{
    if (++turns == TURNS)
        loop_stop(&loop);
    loop_defer(&loop, t);
}

TEST(tasks_with_much_work_alternate_and_delay_no_deferred_task)
{
    unsigned least = UINT32_MAX, most = 0, all = 0;
    CHECK(loop_init(&loop, NULL, 0));
    for (int i = 0; i < GREEDY; i++) {
        greedy[i].task.run = work;
        loop_yield(&loop, &greedy[i].task);
    }
    deferred.run = count_turn;
    loop_defer(&loop, &deferred);
    loop_run(&loop);
    for (int i = 0; i < GREEDY; i++) {
        least = greedy[i].runs < least ? greedy[i].runs : least;
        most = greedy[i].runs > most ? greedy[i].runs : most;
        all += greedy[i].runs;
    }
    CHECK_MSG(most - least <= 1, "from %u to %u runs", least, most);
    CHECK(all >= TURNS && all <= TURNS * (LOOP_TURN_NS / WORK_NS + 1));
}

static void run_once(struct task *t)
{
    ((struct greedy *)t)->runs++;
}

TEST(yielded_task_runs_in_the_next_turn_when_it_is_alone)
{
    CHECK(loop_init(&loop, NULL, 0));
    greedy[0].task.run = run_once;
    loop_yield(&loop, &greedy[0].task);
    loop_yield(&loop, &greedy[0].task); /* is queued already */
    deferred.run = count_turn;
    turns = TURNS - 2;
    loop_defer(&loop, &deferred);
    loop_run(&loop);
    CHECK(greedy[0].runs == 1 && !task_is_queued(&greedy[0].task));
    loop_dispose(&loop, &greedy[1].task);
    greedy[1].task.run = run_once;
    loop_yield(&loop, &greedy[0].task);
    loop_clear(&loop); /* runs the tasks that free something */
    CHECK(greedy[0].runs == 2 && greedy[1].runs == 1);
}

enum { STOPPED_MS = 400 };

/* As if the process were stopped. */
static void be_stopped(struct task *t)
{
    (void)t;
    poll(NULL, 0, STOPPED_MS);
}

TEST(time_in_which_the_loop_is_stopped_is_not_time_awake)
{
    struct task stopped = {.run = be_stopped};
    CHECK(loop_init(&loop, NULL, 0));
    int64_t began_ms = loop.now_ms;
    CHECK(loop.awake_ms == began_ms);
    loop_defer(&loop, &stopped);
    deferred.run = count_turn;
    turns = TURNS - 3;
    loop_defer(&loop, &deferred);
    loop_run(&loop);
    CHECK(loop.now_ms - began_ms >= STOPPED_MS);
    CHECK_MSG(loop.now_ms - loop.awake_ms >= STOPPED_MS / 2, "%d ms",
              (int)(loop.now_ms - loop.awake_ms));
    loop_clear(&loop);
}
static unsigned disposed, done;

static void do_slowly(struct task *t)
{
    (void)t;
    for (int64_t end = clock_ns() + WORK_NS; clock_ns() < end;)
        ;
    if (++done == GREEDY)
        loop_stop(&loop);
}

static void count_turns_and_yield(struct task *t)
{
    turns++;
    loop_yield(&loop, t);
}

/* As when the log releases the replies of a thousand clients at once. */
TEST(deferred_tasks_that_take_long_share_the_turns_with_others)
{
    static struct task other = {.run = count_turns_and_yield};
    CHECK(loop_init(&loop, NULL, 0));
    for (int i = 0; i < GREEDY; i++) {
        greedy[i].task.run = do_slowly;
        loop_defer(&loop, &greedy[i].task);
    }
    loop_yield(&loop, &other);
    loop_run(&loop);
    CHECK(done == GREEDY);
    CHECK_MSG(turns >= GREEDY / (LOOP_TURN_NS / WORK_NS + 1), "%u turns", turns);
    loop_clear(&loop);
}

static void dispose_slowly(struct task *t)
{
    (void)t;
    for (int64_t end = clock_ns() + WORK_NS; clock_ns() < end;)
        ;
    if (++disposed == GREEDY)
        loop_stop(&loop);
}

static void count_turns_only(struct task *t)
{
    turns++;
    loop_defer(&loop, t);
}

TEST(disposals_that_take_long_share_the_turns_with_deferred_tasks)
{
    CHECK(loop_init(&loop, NULL, 0));
    for (int i = 0; i < GREEDY; i++) {
        greedy[i].task.run = dispose_slowly;
        loop_dispose(&loop, &greedy[i].task);
    }
    deferred.run = count_turns_only;
    loop_defer(&loop, &deferred);
    loop_run(&loop);
    CHECK(disposed == GREEDY);
    CHECK_MSG(turns >= GREEDY / (LOOP_TURN_NS / WORK_NS + 1), "%u turns", turns);
    loop_clear(&loop);
}
