/* transfer_test.c - what the clients of a follower notice when a snapshot of its leader replaces its sets. */
#include "server/follow/incoming.h"

#include "tests/server/file_calls.h"
#include "tests/server/follow/node.h"
#include "tests/test.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void expect_line(int fd, const char *want)
{
    const char *got = hear_line(fd);
    CHECK_MSG(strncmp(got, want, strlen(want)) == 0, "%s, not %s", got, want);
}

/* An event, with or without `reset`. */
static void expect_event(int fd, const char *reset)
{
    unsigned lines;
    const char *got = hear_line(fd);
    CHECK_MSG(sscanf(got, "EVENT %u ", &lines) == 1, "%s", got);
    CHECK_MSG((strstr(got, "reset") != NULL) == (reset[0] != '\0'), "%s", got);
    while (lines-- > 0)
        hear_line(fd);
}

/* The connection watches the set, and has got the first event. */
static int watch(const struct node *n, const char *set)
{
    char line[64];
    int fd = daemon_connect(&n->d);
    snprintf(line, sizeof line, "WATCH %s\n", set);
    say(fd, line);
    expect_line(fd, "OK 0 version=");
    expect_event(fd, "reset");
    return fd;
}

/* The leader's log does not reach back to what the follower has, which is still running. */
static void change_beyond_the_log(const struct node *l, const struct node *f, const char *changes)
{
    carry_out(&f->d, "FOLLOW 127.0.0.1 1\n");
    carry_out(&l->d, changes);
    for (unsigned i = 0; i < 3; i++) {
        carry_out(&l->d, "ADD b 8 8\nSNAPSHOT\n");
        await_info(&l->d, "snapshot_running", 0);
    }
}

TEST_TIMEOUT(snapshot_leaves_temporary_sets_and_watchers_of_sets_that_it_does_not_change, 60)
{
    struct node l = node_new((const char *const[]){"--keep-log", "1", NULL});
    struct node f = node_new(NULL);
    int mine = daemon_connect(&f.d);
    say(mine, "CREATE t TEMPORARY\nADD t 1 1 2 2 3 5\nTRIANGULATE t\n"
              "CREATE e TEMPORARY\nADD e 1 1\n");
    for (int i = 0; i < 5; i++)
        expect_line(mine, "OK 0");
    carry_out(&l.d, "ADD a 0 0 9 0 9 9 0 9 4 4 5 6 7 3 2 3\nTRIANGULATE a\n"
                    "ADD c 0 0 1 0\nTRIANGULATE c\nADD d 0 0 1 0\nTRIANGULATE d\nEXPIRE d 1000\n");
    node_follow(&f, &l, "");
    node_expect_same(&l, &f);
    int a = watch(&f, "a"), c = watch(&f, "c"), d = watch(&f, "d");
    change_beyond_the_log(&l, &f, "ADD c 5 5\nDROP d\nADD e 7 7 8 8\n");
    node_follow(&f, &l, "");
    node_expect_same(&l, &f);
    CHECK(node_has_snapshot(&f));
    CHECK(strncmp(node_ask_on(mine, "ADD t 9 9"), "OK 0 first=3", 12) == 0);
    CHECK(strncmp(node_ask_on(mine, "STAT t"), "OK 0 points=4", 13) == 0);
    CHECK(strncmp(node_ask_on(mine, "STAT e"), "OK 0 points=2", 13) == 0); /* the leader's */
    CHECK(strncmp(node_ask_on(mine, "ADD e 9 9"), "ERR READONLY", 12) == 0);
    expect_event(c, "reset");
    expect_line(d, "EVENT 0 set=d dropped");
    carry_out(&l.d, "ADD a 3 3\n"); /* the first event that watchers of a get */
    expect_event(a, "");
    close(mine);
    node_expect_same(&l, &f);
    await_info(&f.d, "sets", 4);
    close(a), close(c), close(d);
    node_end(&l);
    node_end(&f);
}

/* Two daemons that have started in the same second have the same versions: then the set is dropped. */
TEST_TIMEOUT(snapshot_of_another_history_replaces_every_set, 60)
{
    struct node l = node_new(NULL), f = node_new(NULL);
    carry_out(&l.d, "ADD a 0 0 1 0\nTRIANGULATE a\n");
    carry_out(&f.d, "ADD a 5 5 6 6\nTRIANGULATE a\n");
    int a = watch(&f, "a");
    node_follow(&f, &l, " CONFIRM");
    node_expect_same(&l, &f);
    const char *event = hear_line(a);
    if (strcmp(event, "EVENT 0 set=a dropped") != 0) {
        CHECK_MSG(strstr(event, " reset") != NULL, "%s", event);
        expect_line(a, "point 0 0 0");
    }
    close(a);
    node_end(&l);
    node_end(&f);
}

static bool take_any_header(void *ctx, const struct segment *h)
{
    (void)ctx, (void)h;
    return true;
}

/* With a margin for the connections that ask. */
TEST_TIMEOUT(buffers_of_a_leader_and_of_its_follower_are_in_the_memory_budget, 60)
{
    enum { SENDER = 1 << 20, LINK = 256 << 10, MARGIN = 128 << 10 };
    struct node l = node_new(NULL);
    carry_out(&l.d, "ADD a 0 0\n");
    uint64_t before = daemon_info(&l.d, "memory_clients");
    struct node f = node_follower_of(&l);
    node_expect_same(&l, &f);
    uint64_t with = daemon_info(&l.d, "memory_clients");
    CHECK_MSG(with >= before + SENDER - MARGIN, "%lu, %lu", (unsigned long)before,
              (unsigned long)with);
    await_info(&f.d, "memory_log", LINK);
    CHECK(daemon_info(&f.d, "memory") < MARGIN); /* the snapshot is counted once */
    node_end(&f);
    node_await(&l, "followers", "0");
    CHECK(daemon_info(&l.d, "memory_clients") <= before + MARGIN);
    node_end(&l);
}

/* The disk of the follower is full when a snapshot comes. */
TEST(snapshot_that_does_not_fit_is_explained)
{
    struct directory directory = directory_quick();
    struct datadir dir;
    struct incoming s = {.dir = &dir};
    CHECK(datadir_open(&dir, directory.path, false));
    s.calls = &(struct incoming_calls){take_any_header, NULL, NULL};
    struct segment h = {.version = RECORD_VERSION, .kind = SEGMENT_SNAPSHOT, .lsn = 9};
    char *to = buf_reserve(&s.in, SEGMENT_HEADER);
    segment_write(to, &h);
    buf_commit(&s.in, SEGMENT_HEADER);
    calls_watch(directory.path);
    calls_fail("*", 1, UINT_MAX, ENOSPC);
    CHECK(!incoming_take(&s) && s.disk_failed);
    calls_watch("/nowhere");
    CHECK_MSG(strstr(s.why, "no room on the disk for its snapshot") != NULL, "%s", s.why);
    CHECK_STR(incoming_disk_fault(EIO), strerror(EIO));
    CHECK(strlen(incoming_disk_fault(ENOSPC)) < sizeof s.why);
    incoming_clear(&s);
    datadir_close(&dir);
    directory_remove(&directory);
}
