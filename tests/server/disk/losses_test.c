/* losses_test.c - the sets that a repair could not keep. */
#include "server/disk/losses.h"
#include "tests/test.h"

#include <string.h>

static void add(struct losses *l, unsigned i)
{
    char name[16];
    snprintf(name, sizeof name, "set%u", i);
    losses_add(l, name, strlen(name), i);
}

TEST(losses_are_kept_however_many_they_are)
{
    enum { MANY = 100 };
    struct losses l = {0};
    test_guard_alloc(true);
    for (unsigned i = 0; i < MANY; i++)
        add(&l, i);
    CHECK(l.n == MANY && !l.failed);
    for (unsigned i = 0; i < MANY; i++)
        CHECK(l.v[i].points == i && l.v[i].known);
    losses_clear(&l);
    test_guard_alloc(false);
}

TEST(loss_that_could_not_be_kept_is_remembered)
{
    struct losses l = {0};
    test_fail_alloc(1);
    add(&l, 1);
    CHECK(test_alloc_failed() && l.failed && l.n == 0);
    losses_clear(&l);
}
