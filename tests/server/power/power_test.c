/* power_test.c - power cuts at any moment. Any of the unsynced operations may reach the disk. Every
 * acknowledged change must exist, no change in part, and none that was never sent. POWER_LIVES is
 * the number of lives in each test (make faults: more). */
#include "tests/server/power/power_life.h"
#include "tests/test.h"

static unsigned lives(unsigned few)
{
    const char *text = getenv("POWER_LIVES");
    return text == NULL ? few : (unsigned)strtoul(text, NULL, 10) * few;
}

static void print(const struct tally *t)
{
    printf("%u lives, %u operations, %u snapshots, %u failed syncs; changes: %u acknowledged (%u "
           "large), %u "
           "refused, %u neither; %u power cuts, %u with a torn end\n",
           t->lives, t->operations, t->snapshots, t->failed_syncs, t->acknowledged, t->loads,
           t->refused, t->unknown, t->cuts, t->torn);
}

/* Runs stories of n lives in all, and more while no end of a file has been torn. */
static struct tally run_lives(const struct circumstances *kind, unsigned kinds, unsigned n)
{
    enum { LIVES = 5, MORE = 10 };
    struct story s = {0};
    bool ended = true;
    for (unsigned i = 0; i < n || (s.tally.torn == 0 && i < MORE * n); i++) {
        if (ended)
            story_begin(&s);
        story_live(&s, &kind[test_below(kinds)]);
        ended = i % LIVES == LIVES - 1 || i + 1 >= n;
        if (ended)
            story_end(&s);
    }
    print(&s.tally);
    CHECK(s.tally.acknowledged > 0 && s.tally.torn > 0); /* else nothing was tested */
    return s.tally;
}

TEST_TIMEOUT(power_cut_leaves_every_acknowledged_change, 300)
{
    static const struct circumstances kind[] = {
        {.policy = "always", .compact_at = "4k", .ms = 60, .states = 20},
        {.policy = "always", .compact_at = "40k", .ms = 100, .states = 20},
        {.policy = "always", .ms = 60, .states = 20},
    };
    run_lives(kind, 3, lives(20));
}

/* Of the acknowledged changes only the synced ones are promised; of the others, a prefix survives. */
TEST_TIMEOUT(power_cut_leaves_what_was_synced_whatever_the_policy, 300)
{
    static const struct circumstances kind[] = {
        {.policy = "everysec", .compact_at = "4k", .ms = 60, .states = 20},
        {.policy = "everysec", .compact_at = "40k", .ms = 100, .states = 20},
        {.policy = "no", .compact_at = "20k", .ms = 60, .states = 20},
        {.policy = "no", .ms = 60, .states = 20},
    };
    run_lives(kind, 4, lives(10));
}

/* Nothing is acknowledged while the disk stalls; changes that arrive meanwhile are written together. */
TEST_TIMEOUT(power_cut_of_a_disk_that_stalls, 300)
{
    static const struct circumstances kind[] = {
        {.policy = "always", .compact_at = "4k", .stall_us = 3000, .ms = 100, .states = 20},
        {.policy = "always", .compact_at = "2k", .stall_us = 30000, .ms = 300, .states = 20},
        {.policy = "everysec", .compact_at = "4k", .stall_us = 30000, .ms = 100, .states = 20},
    };
    run_lives(kind, 3, lives(5));
}

/* A failed sync may lose its data for good; no later sync makes that data durable. */
TEST_TIMEOUT(power_cut_of_a_disk_that_fails, 300)
{
    static const struct circumstances kind[] = {
        {.policy = "always", .compact_at = "4k", .sync_fails = 10, .ms = 200, .states = 20},
        {.policy = "always", .compact_at = "4k", .write_fails = 20, .ms = 200, .states = 20},
        {.policy = "always", .sync_fails = 50, .write_fails = 50, .ms = 700, .states = 20},
        {.policy = "everysec", .compact_at = "4k", .sync_fails = 50, .ms = 200, .states = 20},
    };
    run_lives(kind, 4, lives(10));
}

/* The reserve is 4 MiB; with some sets there are snapshots of 100 kB. */
TEST_TIMEOUT(power_cut_of_a_disk_that_is_full, 300)
{
    enum { RESERVE = 4 << 20, ROOM = 30000 };
    static const struct circumstances kind[] = {
        {.policy = "always", .compact_at = "4k", .space = RESERVE + ROOM, .ms = 300, .states = 20},
        {.policy = "always", .space = RESERVE + 3 * ROOM, .ms = 300, .states = 20},
        {.policy = "always", .space = ROOM, .ms = 200, .states = 20},
    };
    run_lives(kind, 3, lives(5));
}

TEST_TIMEOUT(power_cut_while_large_loads_arrive, 300)
{
    static const struct circumstances kind[] = {
        {.policy = "always", .compact_at = "400k", .large = true, .ms = 300, .states = 12},
        {.policy = "everysec", .compact_at = "2m", .large = true, .ms = 300, .states = 12},
    };
    run_lives(kind, 2, lives(2));
}
