/* durable_test.c - acknowledged changes exist after a restart, however the daemon ended. */
#include "proto/records/record.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const names[] = {"a", "b", "t", NULL};

/* Every kind of change; deleted ids, including the highest ones; points near each other. */
static const char history[] = "CREATE a TOL 0.5\n"
                              "ADD a 0 0  0.25 0  4 0  4 0.25  0 4  4 4  9 9\n"
                              "DEL a 0 6\n"
                              "ADD t 0 0  4 0  4 4  0 4  2 2  2 2  7 7\n"
                              "DEL t 6\n"
                              "TRIANGULATE t\n"
                              "MOVE t 4 1 2\n"
                              "ADD b 1e-3 -7.25e20\n"
                              "LOAD b 3\n1 2\n3 4\n5 6\n"
                              "ADD gone 1 1\nTRIANGULATE gone\nDROP gone\n"
                              "ADD gone 2 2\nDROP gone\n"
                              "TRIANGULATE a\nMOVE a 2 4 3.9\nDEL t 0\nADD t 0 0\n"
                              "LOADB b 0\n";

static void check_state(const struct daemon *d, const char *want)
{
    char *got = directory_state(d, names);
    CHECK_STR(got, want);
    free(got);
}

static void restart_after(int sig, const char *const *arguments)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, arguments);
    carry_out(&d, history);
    char *want = directory_state(&d, names);
    for (int i = 0; i < 3; i++) {
        daemon_stop(&d, sig);
        d = directory_daemon(&dir, arguments);
        check_state(&d, want);
    }
    converse(&d, "ADD a 8 8\nADD t 8 8\nADD b 8 8\n",
             "OK 0 first=7 added=1 coincident=0\n"
             "OK 0 first=8 added=1 coincident=0\n"
             "OK 0 first=4 added=1 coincident=0\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    free(want);
    directory_remove(&dir);
}

TEST(changes_survive_kill)
{
    restart_after(SIGKILL, NULL);
}

TEST(changes_survive_a_stop)
{
    restart_after(SIGTERM, NULL);
}

TEST(changes_survive_kill_with_every_fsync_policy)
{
    restart_after(SIGKILL, (const char *const[]){"--fsync", "everysec", NULL});
    restart_after(SIGKILL, (const char *const[]){"--fsync", "no", NULL});
}

static void wait_for_snapshot(const struct daemon *d, uint64_t lsn)
{
    while (daemon_info(d, "snapshot_lsn") < lsn || daemon_info(d, "snapshot_running") != 0)
        pause_ms(5);
}

TEST(snapshot_holds_everything_and_replaces_the_log)
{
    char path[128];
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    carry_out(&d, history);
    char *want = directory_state(&d, names);
    uint64_t lsn = daemon_info(&d, "log_lsn");
    carry_out(&d, "SNAPSHOT\n");
    wait_for_snapshot(&d, lsn);
    CHECK(directory_file(&dir, "snapshot.", 0, path) &&
          !directory_file(&dir, "snapshot.", 1, path));
    CHECK(!directory_file(&dir, "log.0000000000000001", 0, path));
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL);
    check_state(&d, want);
    converse(&d, "ADD a 8 8\nADD t 8 8\n",
             "OK 0 first=7 added=1 coincident=0\nOK 0 first=8 added=1 coincident=0\n");
    free(want);
    want = directory_state(&d, names);
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL);
    check_state(&d, want);
    free(want);
    daemon_stop(&d, SIGKILL);
    directory_remove(&dir);
}

TEST(log_is_compacted_when_it_has_become_long)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, (const char *const[]){"--compact-at", "4k", NULL});
    int fd = daemon_connect(&d);
    for (int i = 0; i < 400; i++)
        say(fd, "ADD t 1 2\nDEL t 0\nDROP t\n");
    for (int i = 0; i < 1200; i++)
        hear_line(fd);
    for (unsigned i = 0; i < 300 * test_slowness() && daemon_info(&d, "log_bytes") > 20000; i++)
        pause_ms(10);
    CHECK(daemon_info(&d, "log_bytes") < 20000 && daemon_info(&d, "snapshots") > 0);
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL);
    converse(&d, "SETS\n", "OK 0\n");
    daemon_stop(&d, SIGKILL);
    directory_remove(&dir);
}

TEST(memory_of_sets_is_accounted_for_after_a_restart)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 5000);
    close(fd);
    carry_out(&d, "SNAPSHOT\n");
    await_info(&d, "snapshots", 1);
    for (int i = 0; i < 2; i++) { /* from a snapshot, then from a log as well */
        daemon_stop(&d, SIGKILL);
        d = directory_daemon(&dir, NULL);
        uint64_t memory = daemon_info(&d, "memory");
        CHECK_MSG(memory > 5000 * 16 && memory < 5000 * 1000, "%" PRIu64, memory);
        carry_out(&d, "ADD u 1 1\nDROP u\n");
    }
    carry_out(&d, "DROP t\n");
    CHECK(daemon_info(&d, "memory") == 0);
    daemon_stop(&d, SIGKILL);
    directory_remove(&dir);
}

TEST_TIMEOUT(load_of_many_records_comes_back, 60)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 100000);
    say(fd, "DEL t 5\nTRIANGULATE t\n");
    expect(fd, "OK 0 deleted=1\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=99999", 17) == 0);
    close(fd);
    char *want = directory_state(&d, (const char *const[]){"t", NULL});
    daemon_stop(&d, SIGKILL);
    for (int i = 0; i < 2; i++) { /* from the log, then from a snapshot */
        d = directory_daemon(&dir, NULL);
        while (daemon_info(&d, "loaded_percent") < 100)
            pause_ms(10);
        char *got = directory_state(&d, (const char *const[]){"t", NULL});
        CHECK(strcmp(got, want) == 0);
        free(got);
        carry_out(&d, "SNAPSHOT\n");
        wait_for_snapshot(&d, 5);
        daemon_stop(&d, SIGKILL);
    }
    free(want);
    directory_remove(&dir);
}

TEST(directory_belongs_to_one_daemon)
{
    char text[1000];
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    CHECK(directory_run(&dir, "--data", text, sizeof text) == 1);
    CHECK(strstr(text, "in use") != NULL);
    CHECK(directory_run(&dir, "--check", text, sizeof text) == 1);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    CHECK_MSG(directory_run(&dir, "--check", text, sizeof text) == 0, "%s", text);
    directory_remove(&dir);
}

TEST(pipelined_replies_come_in_order_though_some_wait_for_the_disk)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    converse(&d, "PING\nADD t 1 1\nPING\nADD t 2 2\nGET t 1\nPING\n",
             "OK 0\nOK 0 first=0 added=1 coincident=0\nOK 0\n"
             "OK 0 first=1 added=1 coincident=0\nOK 1\n1 2 2\nOK 0\n");
    daemon_stop(&d, SIGKILL);
    directory_remove(&dir);
}

/* A set that was busy when the snapshot began is in it with later changes, and a crash may take
 * these from the end of the log. Then their numbers must not be given again. */
TEST(changes_come_back_behind_a_snapshot_that_is_ahead_of_its_log)
{
    char path[128], header[SEGMENT_HEADER];
    struct directory dir = directory_new();
    struct segment log = {.version = RECORD_VERSION, .kind = SEGMENT_LOG, .lsn = 3},
                   snapshot = {.version = RECORD_VERSION, .kind = SEGMENT_SNAPSHOT, .lsn = 2};
    struct record set = {.lsn = 1, .synced = 5, .type = RECORD_SET, .name = "t", .name_len = 1},
                  end = {.lsn = 2, .type = RECORD_END, .n = 1};
    struct buf b = {0};
    segment_write(header, &snapshot);
    buf_append(&b, header, sizeof header);
    record_write(&b, &set);
    record_write(&b, &end);
    snprintf(path, sizeof path, "%s/snapshot.%016x", dir.path, 2);
    file_write(path, buf_head(&b), buf_len(&b));
    segment_write(header, &log);
    snprintf(path, sizeof path, "%s/log.%016x", dir.path, 3);
    file_write(path, header, sizeof header);
    for (int i = 0; i < 3; i++) {
        struct daemon d = directory_daemon(&dir, NULL);
        char points[64] = "OK 0\n";
        for (int n = 0, at = i == 0 ? 0 : snprintf(points, 64, "OK %d\n", i); n < i; n++)
            at += snprintf(points + at, sizeof points - (size_t)at, "%d 1 %d\n", n, n);
        converse(&d, "POINTS t\n", points);
        snprintf(points, sizeof points, "ADD t 1 %d\n", i);
        carry_out(&d, points);
        daemon_stop(&d, i == 1 ? SIGTERM : SIGKILL);
    }
    buf_free(&b);
    directory_remove(&dir);
}

/* ---- names that may never get to the disk, since the sync of the directory has failed ---- */

static ino_t inode_of(const char *path)
{
    struct stat st;
    CHECK_MSG(stat(path, &st) == 0, "%s", path);
    return st.st_ino;
}

TEST(a_log_segment_that_is_there_already_is_replaced_so_that_its_name_is_synced)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    char path[128];
    CHECK(daemon_stop(&d, SIGKILL) == -1);
    CHECK(directory_file(&dir, "log.", 0, path));
    int old = open(path, O_RDONLY); /* so that its number is not used again */
    ino_t before = inode_of(path);
    d = directory_daemon(&dir, NULL);
    CHECK(inode_of(path) != before);
    carry_out(&d, "ADD t 1 2\n");
    CHECK(daemon_stop(&d, SIGKILL) == -1);
    before = inode_of(path);
    d = directory_daemon(&dir, NULL);
    CHECK(inode_of(path) == before); /* its name was synced before the change */
    converse(&d, "GET t 0\n", "OK 1\n0 1 2\n");
    close(old);
    directory_remove(&dir);
}

TEST(a_snapshot_beside_files_that_it_covers_is_replaced_so_that_its_name_is_synced)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    char snapshot[128], log[128];
    carry_out(&d, "ADD t 1 2\n");
    CHECK(directory_file(&dir, "log.", 0, log));
    size_t n;
    char *bytes = file_read(log, &n);
    carry_out(&d, "SNAPSHOT\n");
    await_info(&d, "snapshots", 1);
    await_info(&d, "snapshot_running", 0);
    carry_out(&d, "ADD t 3 4\n");
    CHECK(directory_file(&dir, "snapshot.", 0, snapshot));
    int old = open(snapshot, O_RDONLY);
    ino_t before = inode_of(snapshot);
    for (int covers = 0; covers < 2; covers++) {
        CHECK(daemon_stop(&d, SIGKILL) == -1);
        if (covers == 1)
            file_write(log, bytes, n);
        d = directory_daemon(&dir, NULL);
        CHECK((inode_of(snapshot) != before) == (covers == 1));
        converse(&d, "POINTS t\n", "OK 2\n0 1 2\n1 3 4\n");
    }
    close(old);
    free(bytes);
    directory_remove(&dir);
}
