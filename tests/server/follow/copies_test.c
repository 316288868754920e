/* copies_test.c - a follower answers MISSING skip from copies of its own, which its leader's edits end. */
#include "tests/server/directory.h"
#include "tests/server/follow/node.h"
#include "tests/test.h"

TEST_TIMEOUT(a_follower_skips_missing_values_of_the_set_as_its_leader_has_it, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    node_await(&l, "followers", "1");
    node_expect(&l, "ADD a FIELDS z 0 0 0 4 0 0 4 4 8 0 4 8 2 2 nan", "OK 0 first=0 added=5");
    node_expect(&l, "TRIANGULATE a", "OK 0 points=5");
    node_expect_same(&l, &f);
    node_expect(&f, "VOLUME a z", "OK 0 above=0 below=0 area=0");
    node_expect(&f, "VOLUME a z MISSING skip", "OK 0 above=64 below=0 area=16");
    node_expect(&l, "FSET a z 3 nan", "OK 0");
    node_expect_same(&l, &f);
    node_expect(&f, "VOLUME a z MISSING skip", "OK 0 above=21.333333333333332 below=0 area=8");
    node_expect(&l, "DROP a", "OK 0");
    node_expect(&l, "ADD a FIELDS z 0 0 1 4 0 1 4 4 1 0 4 nan", "OK 0 first=0 added=4");
    node_expect(&l, "TRIANGULATE a", "OK 0 points=4");
    node_expect_same(&l, &f);
    node_expect(&f, "VOLUME a z MISSING skip", "OK 0 above=8 below=0 area=8");
    node_end(&l);
    node_end(&f);
}
