/* nothing_test.c - changes of no points and of no values, in the log, in replay and at a follower. They have no
 * arrays: only the undefined behaviour sanitizer detects a use of the missing arrays (make asan). */
#include "tests/server/follow/node.h"
#include "tests/test.h"

#include <signal.h>

TEST_TIMEOUT(changes_of_nothing_reach_a_follower_and_survive_restarts, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    node_await(&l, "followers", "1");
    for (int i = 0; i < 2; i++) {
        carry_out(&l.d,
                  "LOADB a 0\nLOADB b 0 FIELDS z,w\nLOAD c 0 FIELDS z\nLOAD d\n.\nTRIANGULATE d\n"
                  "FSETB b z 0 0\nFSETB d q 0 0\nCREATE e TOL 1\nTRIANGULATE a METHOD shelling\n");
        node_expect_same(&l, &f);
        daemon_stop(&l.d, SIGKILL);
        daemon_stop(&f.d, SIGKILL);
        node_start(&l, NULL);
        node_start(&f, NULL);
        node_expect_same(&l, &f);
        carry_out(&l.d, "ADD a 0 0 1 0 0 1\nADD b FIELDS z,w 1 1 2 2\nDEL a 0 1 2\nDEL b 0\nDROP "
                        "a\nDROP b\nDROP c\nDROP e\n"
                        "SNAPSHOT\n");
        node_expect_same(&l, &f);
    }
    node_end(&l);
    node_end(&f);
}
