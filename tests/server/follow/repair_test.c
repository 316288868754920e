/* repair_test.c - leaders and followers whose directories have been repaired. */
#include "proto/records/record.h"
#include "tests/server/follow/node.h"
#include "tests/test.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>

/* Kills the daemon, damages its second change, which later ones show to have been on the disk, and repairs the directory. */
static void lose_changes(struct node *n)
{
    char path[128], text[1000];
    size_t size;
    daemon_stop(&n->d, SIGKILL);
    CHECK(directory_file(&n->dir, "log.", 0, path));
    char *bytes = file_read(path, &size);
    size_t second = SEGMENT_HEADER + RECORD_HEADER + record_outline(bytes + SEGMENT_HEADER).length;
    CHECK(second + RECORD_HEADER < size);
    bytes[second + RECORD_HEADER] ^= 1;
    file_write(path, bytes, size);
    free(bytes);
    CHECK_MSG(directory_repair(&n->dir, text, sizeof text) == 0, "%s", text);
    CHECK_MSG(strstr(text, "cut off") != NULL, "%s", text);
}

/* Each change is on both disks before the next one. */
static void change_both(const struct node *l, const struct node *f)
{
    node_await(l, "followers", "1");
    node_await_position(l, f); /* so that the log begins with the first change */
    for (int i = 0; i < 5; i++)
        carry_out(&l->d, "ADD a 1 1\nWAIT 1 60\n");
    node_expect_same(l, f);
}

static void save_all(const struct node *n)
{
    for (int i = 0; i < 8; i++) {
        carry_out(&n->d, "ADD a 9 9\nSNAPSHOT\n");
        await_info(&n->d, "snapshot_running", 0);
    }
}

/* The leader has lost a change that the follower has, then it gets more changes, and its log no longer has those before. */
TEST_TIMEOUT(follower_refuses_a_leader_that_was_repaired_and_has_lost_changes, 60)
{
    struct node l = node_new((const char *const[]){"--keep-log", "1", NULL}),
                f = node_follower_of(&l);
    change_both(&l, &f);
    daemon_stop(&f.d, SIGTERM);
    lose_changes(&l);
    node_start(&l, (const char *const[]){"--keep-log", "1", NULL});
    node_expect(&l, "STAT a", "OK 0 points=1");
    save_all(&l);
    node_start(&f, NULL);
    node_await(&f, "link", "refused");
    node_expect(&f, "STAT a", "OK 0 points=5");
    node_end(&l);
    node_end(&f);
}

TEST_TIMEOUT(follower_that_was_repaired_and_has_lost_changes_continues, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    change_both(&l, &f);
    lose_changes(&f);
    node_start(&f, NULL);
    node_expect_same(&l, &f);
    CHECK(node_is(&f, "link_error", ""));
    node_end(&l);
    node_end(&f);
}
