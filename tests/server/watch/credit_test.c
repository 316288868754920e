/* credit_test.c - how much time the events of a set may take. */
#include "server/watch/credit.h"
#include "tests/test.h"

enum { MS = 1000 * 1000 };

TEST(events_get_a_part_of_the_time_in_which_the_loop_is_busy)
{
    struct credit c = {.ns = 0, .processor = 5 * MS, .idle_ns = 7 * MS};
    credit_earn(&c, 5 * MS + 12 * MS, 7 * MS);
    CHECK(c.ns == 12 * MS / CREDIT_SHARE);
    credit_earn(&c, 17 * MS + 12 * MS, 7 * MS + 12 * MS); /* as idle as busy */
    CHECK(c.ns == 24 * MS / CREDIT_SHARE);
}

TEST(events_get_half_of_the_time_in_which_the_loop_has_nothing_to_do)
{
    struct credit c = {.ns = -5 * MS};
    credit_earn(&c, 0, 4 * MS);
    CHECK(c.ns == -3 * MS);
    credit_earn(&c, 0, 4 * MS + 1000 * MS);
    CHECK(c.ns == CREDIT_MOST);
}

TEST(debt_of_events_is_limited)
{
    struct credit c = {.ns = CREDIT_MOST};
    credit_spend(&c, 3 * MS);
    CHECK(c.ns == CREDIT_MOST - 3 * MS);
    credit_spend(&c, 1000 * MS);
    CHECK(c.ns == -CREDIT_DEBT);
}
