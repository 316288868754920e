/* power_test.c - power cuts at any moment: whatever of the operations that no sync has covered gets
 * to the disk, all that was acknowledged is there, nothing is there by half, and nothing that was
 * never sent. POWER_LIVES says how many lives each test takes (make faults: more). */
#include "tests/server/power_life.h"
#include "tests/test.h"

static unsigned lives(unsigned few)
{
    const char *text = getenv("POWER_LIVES");
    return text == NULL ? few : (unsigned)strtoul(text, NULL, 10) * few;
}

/* Stories of so many lives on the same directory. */
static void tell(const struct circumstances *kind, unsigned kinds, unsigned n)
{
    enum { LIVES = 5 };
    unsigned states = 0, operations = 0;
    for (unsigned i = 0; i < n; i += LIVES) {
        struct story s;
        story_begin(&s);
        for (unsigned k = 0; k < LIVES; k++)
            story_live(&s, &kind[test_below(kinds)]);
        states += s.states;
        operations += s.operations;
        story_end(&s);
    }
    if (getenv("POWER_LIVES") != NULL)
        printf("%u lives, %u operations, %u power cuts\n", n, operations, states);
}

TEST_TIMEOUT(power_cut_leaves_every_acknowledged_change, 300)
{
    static const struct circumstances kind[] = {
        {.policy = "always", .compact_at = "4k", .ms = 60, .states = 20},
        {.policy = "always", .compact_at = "40k", .ms = 100, .states = 20},
        {.policy = "always", .ms = 60, .states = 20},
    };
    tell(kind, 3, lives(20));
}

/* Of what was acknowledged only that is promised which was synced; the rest is there in order. */
TEST_TIMEOUT(power_cut_leaves_what_was_synced_whatever_the_policy, 300)
{
    static const struct circumstances kind[] = {
        {.policy = "everysec", .compact_at = "4k", .ms = 60, .states = 20},
        {.policy = "everysec", .compact_at = "40k", .ms = 100, .states = 20},
        {.policy = "no", .compact_at = "20k", .ms = 60, .states = 20},
        {.policy = "no", .ms = 60, .states = 20},
    };
    tell(kind, 4, lives(10));
}
