/* queue_test.c - the queue of requests that wait for a set. */
#include "server/sets/dataset.h"
#include "tests/test.h"

#include <string.h>

enum { MANY = 50 };

/* A request that waits; when it is called, it records its number. */
struct request_in_line {
    struct waiter waiter; /* first */
    unsigned number, calls;
};

static unsigned order[2 * MANY], called_n;
static struct registry sets;
static struct dataset *set;
static struct request_in_line in_line[MANY];

static void note_call(struct waiter *w)
{
    struct request_in_line *r = (struct request_in_line *)w;
    r->calls++;
    order[called_n++ % (2 * MANY)] = r->number;
}

static void line_up(struct waiter *w, bool writes)
{
    w->writes = writes;
    queue_enter(&set->queue, w);
}

static void begin(void)
{
    registry_init(&sets);
    set = registry_create(&sets, &(struct word){"t", 1}, 0);
    CHECK(set != NULL);
    set->born = true;
    memset(in_line, 0, sizeof in_line);
    called_n = 0;
    for (unsigned i = 0; i < MANY; i++) {
        in_line[i].number = i;
        in_line[i].waiter.wake = note_call;
    }
}

static struct job *somebody(void)
{
    return (struct job *)(void *)&sets; /* only compared with NULL */
}

static void edit_begins(bool exclusive)
{
    set->writer = somebody();
    set->exclusive = exclusive;
}

static void edit_ends(void)
{
    set->writer = NULL;
    set->exclusive = false;
    queue_call(&set->queue);
}

TEST(waiters_for_a_set_are_called_in_order_and_once_each)
{
    begin();
    edit_begins(true);
    for (unsigned i = 0; i < MANY; i++)
        line_up(&in_line[i].waiter, true);
    for (unsigned i = 0; i < MANY; i++) { /* each begins a job of its own */
        edit_ends();
        CHECK(called_n == i + 1 && order[i] == i && dataset_admits(set, true, &set->queue));
        edit_begins(true);
        queue_served(&in_line[i].waiter);
    }
    for (unsigned i = 0; i < MANY; i++)
        CHECK(in_line[i].calls == 1 && in_line[i].waiter.queue == NULL);
    set->writer = NULL;
    registry_clear(&sets);
}

TEST(request_that_changes_a_set_does_not_overtake_waiting_ones)
{
    begin();
    edit_begins(true);
    line_up(&in_line[0].waiter, true);
    edit_ends();
    CHECK(in_line[0].calls == 1);
    CHECK(!dataset_admits(set, true, NULL) && dataset_admits(set, false, NULL));
    line_up(&in_line[1].waiter, true);
    CHECK(in_line[1].calls == 0);
    queue_served(&in_line[0].waiter);
    CHECK(in_line[1].calls == 1);
    queue_served(&in_line[1].waiter);
    CHECK(dataset_admits(set, true, NULL));
    registry_clear(&sets);
}

TEST(waiting_readers_continue_beside_a_job_that_lets_the_set_be_read)
{
    begin();
    edit_begins(true);
    line_up(&in_line[0].waiter, true);
    line_up(&in_line[1].waiter, false);
    line_up(&in_line[2].waiter, false);
    edit_begins(false); /* the edit ends, and a maintenance job begins at once */
    queue_call(&set->queue);
    CHECK(called_n == 1 && order[0] == 1);
    queue_served(&in_line[1].waiter);
    CHECK(called_n == 2 && order[1] == 2);
    queue_served(&in_line[2].waiter);
    CHECK(called_n == 2);
    edit_ends();
    CHECK(called_n == 3 && order[2] == 0);
    queue_served(&in_line[0].waiter);
    registry_clear(&sets);
}

TEST(waiter_that_is_called_and_must_wait_again_keeps_its_place)
{
    begin();
    edit_begins(true);
    line_up(&in_line[0].waiter, true);
    line_up(&in_line[1].waiter, true);
    edit_ends();
    edit_begins(false);
    line_up(&in_line[0].waiter, true);
    CHECK(called_n == 1);
    edit_ends();
    CHECK(called_n == 2 && order[1] == 0);
    queue_served(&in_line[0].waiter);
    CHECK(called_n == 3 && order[2] == 1);
    queue_served(&in_line[1].waiter);
    registry_clear(&sets);
}

TEST(waiter_that_leaves_when_it_is_called_passes_its_turn_on)
{
    begin();
    edit_begins(true);
    for (unsigned i = 0; i < 3; i++)
        line_up(&in_line[i].waiter, true);
    queue_served(&in_line[1].waiter); /* from the middle of the queue */
    edit_ends();
    queue_served(&in_line[0].waiter); /* its client has disconnected */
    CHECK(called_n == 2 && order[1] == 2 && in_line[1].calls == 0);
    queue_served(&in_line[2].waiter);
    registry_clear(&sets);
}

TEST(waiters_for_a_set_that_is_dropped_are_all_woken)
{
    begin();
    edit_begins(true);
    for (unsigned i = 0; i < 3; i++)
        line_up(&in_line[i].waiter, true);
    edit_ends();
    registry_drop(&sets, set); /* by the request that was called */
    CHECK(called_n == 3);
    for (unsigned i = 0; i < 3; i++)
        CHECK(in_line[i].calls == 1 && in_line[i].waiter.queue == NULL &&
              !in_line[i].waiter.called);
    registry_clear(&sets);
}

TEST(waiter_that_enters_another_queue_passes_its_turn_on)
{
    struct request_queue log = {0};
    begin();
    edit_begins(true);
    line_up(&in_line[0].waiter, true);
    line_up(&in_line[1].waiter, true);
    edit_ends();
    CHECK(queue_turn(&in_line[0].waiter) == &set->queue);
    queue_enter(&log, &in_line[0].waiter); /* it needs something else first */
    CHECK(called_n == 2 && order[1] == 1 && queue_turn(&in_line[0].waiter) == NULL);
    queue_call(&log);
    CHECK(called_n == 3 && order[2] == 0 && queue_is_first(&log, &log) &&
          !queue_is_first(&log, NULL));
    queue_served(&in_line[0].waiter);
    queue_served(&in_line[1].waiter);
    CHECK(queue_is_first(&log, NULL));
    registry_clear(&sets);
}

TEST(waiting_readers_are_not_called_while_the_set_is_edited)
{
    begin();
    edit_begins(true);
    line_up(&in_line[0].waiter, false);
    queue_call(&set->queue); /* as when a request leaves the queue */
    CHECK(called_n == 0);
    edit_ends();
    CHECK(called_n == 1);
    queue_served(&in_line[0].waiter);
    registry_clear(&sets);
}

TEST(one_waiter_is_called_at_a_time)
{
    begin();
    edit_begins(true);
    line_up(&in_line[0].waiter, false);
    line_up(&in_line[1].waiter, false);
    edit_ends();
    queue_call(&set->queue);
    CHECK(called_n == 1);
    queue_served(&in_line[0].waiter);
    queue_call(&set->queue);
    CHECK(called_n == 2);
    queue_served(&in_line[1].waiter);
    registry_clear(&sets);
}
