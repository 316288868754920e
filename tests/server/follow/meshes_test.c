/* meshes_test.c - what REFINE and SIMPLIFY make is the same on the leader, on its follower, and after either was killed. */
#include "tests/server/follow/node.h"
#include "tests/test.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 8, SETS = 6, LINE = 200 };

static const char *const sets[SETS + 1] = {"a", "b", "c", "d", "large", "x", NULL};

/* Each step edits sets that nodes compare (node_expect_same). The results of SIMPLIFY have such names, too, and REFINE refines one. */
static const char *const step[STEPS] = {
    "ADD a FIELDS z 0 0 0 8 0 8 8 1 9 0 1 1 4 0.5 nan\nTRIANGULATE a\nREFINE a LIMIT 2\n",
    "CONSTRAIN a BORDER OF 3 RING 0 1 2 3\nREFINE a INSIDE 3 ANGLE 28 AREA 0.05\n",
    "SIMPLIFY a z ERROR 0.125 IDS id INTO b\n",
    "TRIANGULATE b\nREFINE b LENGTH 0.5 LIMIT 50\nDEL a 4\n",
    ("CREATE c TOL 0.01\nADD c FIELDS z,w 0 0 1 2 9 9 3 4 0 9 5 6 9 0 7 nan 4 4 0 0 4.001 4 1 1\n"
     "CONSTRAIN c OF 2 4 5\nCONSTRAIN c 0 5\nTRIANGULATE c\nREFINE c KEEP ANGLE 20 LIMIT 30\n"),
    "SIMPLIFY c z ERROR 0 POINTS 20 INTO d\nDROP c\nSIMPLIFY d w ERROR 1e9 IDS old INTO c\n",
    "ADD x 0 0 1 1 2 2\nTRIANGULATE x\nREFINE x\nFSET x z 0 1\nSIMPLIFY x z ERROR 0 INTO gone\n",
    "TRIANGULATE d\nREFINE d AREA 0.01\nSIMPLIFY d z ERROR 0.01 INTO large\nMOVE d 0 -1 -1\n"};

/* Kills the daemon and starts it again. */
static void kill_and_start(struct node *n)
{
    daemon_stop(&n->d, SIGKILL);
    node_start(n, NULL);
}

static void note_digests(const struct node *n, char digest[][LINE])
{
    char line[20];
    for (int i = 0; i < SETS; i++) {
        snprintf(line, sizeof line, "DIGEST %s", sets[i]);
        snprintf(digest[i], LINE, "%s", node_ask(n, line));
    }
}

/* Both have equal replies about all sets; versions differ. */
static void expect_equal(const struct node *a, const struct node *b)
{
    char *of_a = directory_state(&a->d, sets), *of_b = directory_state(&b->d, sets);
    CHECK_STR(of_a, of_b);
    free(of_a);
    free(of_b);
}

TEST_TIMEOUT(refined_and_simplified_sets_are_the_same_on_a_follower_after_each_step, 90)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    node_await(&l, "followers", "1");
    for (int i = 0; i < STEPS; i++) {
        carry_out(&l.d, step[i]);
        node_expect_same(&l, &f);
        if (i % 3 == 1)
            kill_and_start(&f);
    }
    CHECK(node_is(&f, "role", "follower"));
    node_expect(&f, "CHECK d", "OK 0 delaunay=yes");
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(refined_and_simplified_sets_are_replayed_after_a_kill_and_continue_equally, 90)
{
    char before[SETS][LINE], after[SETS][LINE];
    struct node l = node_new(NULL), whole = node_new(NULL);
    for (int i = 0; i < STEPS; i++) {
        carry_out(&l.d, step[i]);
        carry_out(&whole.d, step[i]);
        note_digests(&l, before);
        kill_and_start(&l);
        note_digests(&l, after);
        CHECK(memcmp(before[0], "OK 0 digest=", 12) == 0);
        for (int k = 0; k < SETS; k++)
            CHECK_STR(after[k], before[k]);
        expect_equal(&l, &whole);
    }
    struct node f = node_follower_of(&l);
    node_expect_same(&l, &f);
    node_expect(&f, "REFINE a", "ERR READONLY");
    node_expect(&f, "SIMPLIFY a z ERROR 1 INTO e", "ERR READONLY");
    node_end(&f);
    node_end(&whole);
    node_end(&l);
}
