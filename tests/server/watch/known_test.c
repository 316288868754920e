/* known_test.c - the points that a watcher of a box may know. */
#include "server/watch/known.h"
#include "tests/test.h"

#include <stdlib.h>

enum { IDS = 1 << 20 };

/* A random sequence of additions and removals; few: of ids that share their places in the table. */
static void check_random(uint32_t ids, uint32_t few, unsigned steps)
{
    struct known k = {.count = 0};
    bool *in = calloc(ids, sizeof *in);
    uint32_t state = 1;
    for (unsigned i = 0; i < steps; i++) {
        state = state * 1664525 + 1013904223;
        uint32_t id = (state >> 8) % few * (ids / few);
        if (state >> 31 != 0) {
            CHECK(known_add(&k, id, ids));
            in[id] = true;
        } else {
            CHECK(known_remove(&k, id) == in[id]);
            in[id] = false;
        }
    }
    for (uint32_t id = 0; id < ids; id++)
        CHECK(known_has(&k, id) == in[id]);
    known_clear(&k);
    CHECK(known_memory(&k) == 0);
    free(in);
}

TEST(ids_that_are_added_and_removed_at_random_are_known_or_not)
{
    check_random(IDS, 40, 4000);
    check_random(IDS, 3000, 20000);
    check_random(100, 100, 1000);
}

TEST(few_known_ids_of_many_need_memory_for_few)
{
    struct known k = {.count = 0};
    for (uint32_t id = 0; id < 1000; id++)
        CHECK(known_add(&k, id * 1000, IDS));
    CHECK(known_memory(&k) <= 8192);
    known_clear(&k);
}

TEST(many_known_ids_need_a_bit_for_each_id)
{
    struct known k = {.count = 0};
    size_t most = 0;
    for (uint32_t id = 0; id < IDS; id++) {
        CHECK(known_add(&k, id, IDS));
        most = known_memory(&k) > most ? known_memory(&k) : most;
    }
    CHECK(most <= IDS / 8 + 8);
    CHECK(known_has(&k, IDS - 1) && known_remove(&k, 0) && !known_has(&k, 0));
    known_clear(&k);
}

TEST(all_ids_below_a_limit_can_be_known_beside_some_others)
{
    struct known k = {.count = 0};
    CHECK(known_add(&k, 1000000, IDS) && known_fill(&k, 500000));
    CHECK(known_has(&k, 0) && known_has(&k, 499999) && !known_has(&k, 500000));
    CHECK(known_has(&k, 1000000));
    known_clear(&k);
}
