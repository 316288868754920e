/* reply_hold_test.c - which bytes wait for which change, and when connections are notified. */
#include "server/disk/reply_hold.h"

#include "tests/test.h"

#include <string.h>

enum { CONNECTIONS = 4 };

static struct hold hold[CONNECTIONS];
static unsigned released[CONNECTIONS], not_saved[CONNECTIONS];

static void on_released(struct hold *h)
{
    released[h - hold]++;
}

static void on_not_saved(struct hold *h)
{
    not_saved[h - hold]++;
    hold_clear(h);
}

static struct holders all = {.released = on_released, .not_saved = on_not_saved};

/* Returns how many of the bytes 0..99 may be sent. */
static size_t free_of(const struct hold *h)
{
    return hold_free(h, 0, 100);
}

TEST(bytes_wait_until_their_own_change_is_durable)
{
    hold_acknowledgement(&all, &hold[0], 5, 10);
    CHECK(free_of(&hold[0]) == 10);
    holders_release(&all, 4);
    CHECK(free_of(&hold[0]) == 10 && released[0] == 0);
    holders_release(&all, 5);
    CHECK(free_of(&hold[0]) == 100 && released[0] == 1);
    holders_release(&all, 6);
    CHECK(released[0] == 1 && list_is_empty(&all.holds[0]));
}

TEST(second_group_of_a_connection_waits_for_its_latest_change)
{
    hold_acknowledgement(&all, &hold[0], 5, 10);
    hold_acknowledgement(&all, &hold[0], 6, 20);
    hold_acknowledgement(&all, &hold[0], 7, 30);
    holders_release(&all, 5);
    CHECK(free_of(&hold[0]) == 20 && released[0] == 1);
    holders_release(&all, 6);
    CHECK(free_of(&hold[0]) == 20 && released[0] == 1);
    hold_acknowledgement(&all, &hold[0], 8,
                         40); /* behind the group that waits for 7, not with it */
    holders_release(&all, 7);
    CHECK(free_of(&hold[0]) == 40 && released[0] == 2);
    holders_release(&all, 8);
    CHECK(free_of(&hold[0]) == 100 && released[0] == 3 && list_is_empty(&all.holds[0]));
}

TEST(one_release_may_end_both_groups)
{
    hold_acknowledgement(&all, &hold[0], 5, 10);
    hold_acknowledgement(&all, &hold[0], 6, 20);
    holders_release(&all, 6);
    CHECK(free_of(&hold[0]) == 100 && released[0] == 1 && list_is_empty(&all.holds[0]));
}

static unsigned count_held(void)
{
    unsigned n = 0;
    for (const struct hold *h = list_first(&all.holds[0]); h != NULL;
         h = list_next(&all.holds[0], h))
        n++;
    return n;
}

TEST(connections_that_wait_again_stand_in_line_as_if_for_the_first_time)
{
    for (int i = 0; i < 3; i++)
        hold_acknowledgement(&all, &hold[i], 1, 0);
    hold_clear(&hold[0]);
    CHECK(count_held() == 2);
    hold_acknowledgement(&all, &hold[0], 2, 0);
    CHECK(count_held() == 3 && list_last(&all.holds[0]) == &hold[0]);
    hold_clear(&hold[0]);
    CHECK(count_held() == 2 && list_last(&all.holds[0]) == &hold[2]);
    hold_clear(&hold[0]); /* twice is once */
    CHECK(count_held() == 2);
}

TEST(everybody_who_can_go_is_released_and_nobody_else)
{
    for (unsigned i = 0; i < CONNECTIONS; i++)
        hold_acknowledgement(&all, &hold[i], i + 1, 0);
    holders_release(&all, 3);
    CHECK(released[0] == 1 && released[1] == 1 && released[2] == 1 && released[3] == 0);
    CHECK(count_held() == 1 && list_first(&all.holds[0]) == &hold[3]);
}

/* ---- what replies show ---- */

TEST(nothing_waits_for_what_is_durable_already)
{
    holders_release(&all, 5);
    hold_acknowledgement(&all, &hold[0], 5, 0);
    hold_view(&all, &hold[1], 4, 0);
    CHECK(list_is_empty(&all.holds[0]) && free_of(&hold[0]) == 100 && free_of(&hold[1]) == 100);
}

TEST(reply_waits_for_the_latest_change_that_it_shows_or_acknowledges)
{
    hold_view(&all, &hold[0], 5, 10);
    hold_acknowledgement(&all, &hold[0], 6, 10); /* the same reply: no group of its own */
    hold_view(&all, &hold[0], 7, 20);
    holders_release(&all, 5);
    CHECK(free_of(&hold[0]) == 10);
    holders_release(&all, 6);
    CHECK(free_of(&hold[0]) == 20);
    holders_release(&all, 7);
    CHECK(free_of(&hold[0]) == 100);
}

/* The connection waits for a change; another set may show it an older change. */
TEST(older_change_takes_nothing_from_the_wait_for_a_later_one)
{
    hold_acknowledgement(&all, &hold[0], 7, 10);
    hold_view(&all, &hold[0], 3, 20);
    hold_acknowledgement(&all, &hold[0], 9, 30);
    hold_view(&all, &hold[0], 8, 40);
    holders_release(&all, 7);
    CHECK(free_of(&hold[0]) == 30);
    holders_release(&all, 8);
    CHECK(free_of(&hold[0]) == 30);
    holders_release(&all, 9);
    CHECK(free_of(&hold[0]) == 100 && released[0] == 2);
}

TEST(failing_disk_lets_go_of_what_only_shows_changes)
{
    hold_view(&all, &hold[0], 5, 10);
    hold_view(&all, &hold[1], 5, 10);
    hold_acknowledgement(&all, &hold[1], 6, 20);
    hold_acknowledgement(&all, &hold[2], 6, 10);
    hold_view(&all, &hold[2], 7, 20);
    hold_view(&all, &hold[3], 5, 10);
    hold_acknowledgement(&all, &hold[3], 5, 20); /* one group for both */
    holders_fail(&all, HOLD_DISK);
    CHECK(released[0] == 1 && not_saved[0] == 0 && free_of(&hold[0]) == 100);
    CHECK(released[1] == 1 && not_saved[1] == 1);
    CHECK(released[2] == 0 && not_saved[2] == 1 && not_saved[3] == 1);
    hold_view(&all, &hold[0], 8, 10);
    CHECK(free_of(&hold[0]) == 100);
    hold_acknowledgement(&all, &hold[0], 8, 20);
    CHECK(free_of(&hold[0]) == 20);
    holders_recover(&all, HOLD_DISK);
    hold_view(&all, &hold[1], 8, 10);
    CHECK(free_of(&hold[1]) == 10);
    holders_release(&all, 8);
    CHECK(free_of(&hold[0]) == 100 && free_of(&hold[1]) == 100);
}

TEST(all_waiting_clients_get_the_error_that_nothing_was_saved)
{
    for (unsigned i = 0; i < CONNECTIONS; i++)
        hold_acknowledgement(&all, &hold[i], i + 1, 0);
    holders_release(&all, 2);
    holders_fail(&all, HOLD_DISK);
    CHECK(not_saved[0] == 0 && not_saved[1] == 0 && not_saved[2] == 1 && not_saved[3] == 1);
    CHECK(count_held() == 0);
}
