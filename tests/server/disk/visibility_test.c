/* visibility_test.c - while a sync is running, no reply shows changes that are not on the disk yet.
 * The disk is tests/faults/disk_shim.c, found through DISK_SHIM: its syncs wait at a gate. */
#include "tests/server/directory.h"
#include "tests/test.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

struct bench {
    struct directory dir;
    char gate[100];
    struct daemon d;
    int writer, reader;
};

static void begin(struct bench *b, const char *policy)
{
    b->dir = directory_new();
    snprintf(b->gate, sizeof b->gate, "%s.gate", b->dir.path);
    setenv("LD_PRELOAD", getenv("DISK_SHIM"), 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
    setenv("DISK_DIR", b->dir.path, 1);
    setenv("DISK_GATE", b->gate, 1);
    b->d = directory_daemon(
        &b->dir, (const char *const[]){"--fsync", policy, "--max-points", "40000", NULL});
    unsetenv("LD_PRELOAD");
    b->writer = daemon_connect(&b->d);
    b->reader = daemon_connect(&b->d);
}

static void shut_gate(const struct bench *b)
{
    int fd = open(b->gate, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    CHECK(fd >= 0);
    close(fd);
}

static void open_gate(const struct bench *b)
{
    CHECK(unlink(b->gate) == 0);
}

static void end(struct bench *b)
{
    close(b->writer);
    close(b->reader);
    daemon_stop(&b->d, SIGKILL);
    unlink(b->gate);
    directory_remove(&b->dir);
}

/* No reply arrives, although the daemon has processed the request. */
static bool is_silent(const struct bench *b, int fd)
{
    struct pollfd in = {.fd = fd, .events = POLLIN};
    daemon_info(&b->d, "commands");
    return poll(&in, 1, 30) == 0;
}

/* While the change is not on the disk, the reply to the request waits; then it is `want`. */
static void expect_held(const char *history, const char *change, const char *request,
                        const char *want)
{
    struct bench b;
    begin(&b, "always");
    carry_out(&b.d, history);
    shut_gate(&b);
    uint64_t lsn = daemon_info(&b.d, "lsn");
    say(b.writer, change);
    while (daemon_info(&b.d, "lsn") == lsn) /* another reactor may take the request that follows */
        pause_ms(1);
    CHECK_MSG(is_silent(&b, b.writer), "%s", change);
    say(b.reader, request);
    CHECK_MSG(is_silent(&b, b.reader), "%s", request);
    open_gate(&b);
    CHECK(strncmp(hear_line(b.writer), "OK ", 3) == 0);
    expect(b.reader, want);
    end(&b);
}

static const char points[] = "ADD t 0 0  4 0  4 4  0 4\n";
static const char live[] = "ADD t 0 0  4 0  4 4  0 4\nTRIANGULATE t\n";

/* ---- changes that have no effect ---- */

TEST(triangulate_of_a_set_whose_triangulate_is_not_saved_yet_waits_for_that)
{
    expect_held(points, "TRIANGULATE t\n", "TRIANGULATE t\n", "OK 0 points=4");
    expect_held(points, "TRIANGULATE t\n", "TRIANGULATE t METHOD divide\n", "OK 0 points=4");
}

TEST(create_of_a_set_whose_create_is_not_saved_yet_waits_for_that)
{
    expect_held(points, "CREATE u\n", "CREATE u\n", "ERR EXISTS");
}

TEST(request_for_a_set_whose_drop_is_not_saved_yet_waits_for_that)
{
    expect_held(points, "DROP t\n", "DROP t\n", "ERR NOSET");
    expect_held(points, "DROP t\n", "GET t 0\n", "ERR NOSET");
}

TEST(delete_of_a_point_whose_delete_is_not_saved_yet_waits_for_that)
{
    expect_held(points, "DEL t 1\n", "DEL t 1\n", "ERR NOPOINT");
}

/* ---- requests that only read ---- */

TEST(query_waits_until_the_changes_of_its_set_are_saved)
{
    expect_held(live, "ADD t 1 1\n", "NEAREST t 1 1\n", "OK 1\n4 1 1 0\n");
    expect_held(live, "ADD t 1 1\n", "GET t 4\n", "OK 1\n4 1 1\n");
    expect_held(live, "MOVE t 0 1 1\n", "LISTS t 0\n", "OK 1 interior=0 boundary=1\n");
    expect_held(live, "DEL t 0\n", "STAT t\n", "OK 0 points=3");
    expect_held(live, "DEL t 0\n", "CHECK t\n", "OK 0 delaunay=yes points=3");
    expect_held(live, "ADD u 1 1\n", "SETS\n", "OK 2\nt points=4");
    expect_held(points, "TRIANGULATE t\n", "HULL t\n", "OK 4\n");
}

TEST(event_waits_until_its_change_is_saved)
{
    struct bench b;
    begin(&b, "always");
    carry_out(&b.d, points);
    say(b.reader, "WATCH t\n");
    expect(b.reader, "OK 0\n");
    for (int i = 0; i < 5; i++) /* the reset */
        hear_line(b.reader);
    shut_gate(&b);
    say(b.writer, "MOVE t 1 5 0\n");
    CHECK(is_silent(&b, b.writer) && is_silent(&b, b.reader));
    open_gate(&b);
    CHECK(strncmp(hear_line(b.writer), "OK ", 3) == 0);
    CHECK(strncmp(hear_line(b.reader), "EVENT 1 set=t version=", 22) == 0);
    expect(b.reader, "point 1 5 0\n");
    end(&b);
}

TEST(query_by_a_worker_waits_until_the_changes_of_its_set_are_saved)
{
    enum { MANY = 2000 };
    struct bench b;
    begin(&b, "always");
    load_random(b.writer, "t", MANY);
    carry_out(&b.d, "TRIANGULATE t\n");
    shut_gate(&b);
    say(b.writer, "DEL t 0\n");
    CHECK(is_silent(&b, b.writer));
    say(b.reader, "CHECK t\n");
    await_info(&b.d, "jobs_running", 0);
    CHECK(is_silent(&b, b.reader));
    open_gate(&b);
    expect(b.writer, "OK 0 deleted=1\n");
    CHECK(strncmp(hear_line(b.reader), "OK 0 delaunay=yes points=1999 ", 30) == 0);
    end(&b);
}

TEST(load_that_does_not_fit_waits_for_the_points_that_leave_no_room)
{
    expect_held("LOAD t 2\n1 1\n2 2\n", "LOAD t 1\n3 3\n", "LOAD t 0\n", "OK 0 first=3 added=0");
    struct bench b;
    begin(&b, "always");
    load_random(b.writer, "t", 39999);
    shut_gate(&b);
    say(b.writer, "ADD t 7 7\n");
    CHECK(is_silent(&b, b.writer));
    say(b.reader, "LOAD t 1\n8 8\n");
    CHECK(is_silent(&b, b.reader));
    open_gate(&b);
    expect(b.reader, "ERR TOOBIG");
    end(&b);
}

TEST(query_of_a_saved_set_does_not_wait_for_others)
{
    struct bench b;
    begin(&b, "always");
    carry_out(&b.d, live);
    shut_gate(&b);
    say(b.writer, "ADD u 7 7\n");
    CHECK(is_silent(&b, b.writer));
    say(b.reader, "GET t 1\nSTAT u\nPING\nGET t 2\n");
    expect(b.reader, "OK 1\n1 4 0\n");
    CHECK(is_silent(&b, b.reader)); /* the STAT, and what is behind it */
    open_gate(&b);
    expect(b.writer, "OK 0 first=0 added=1 coincident=0\n");
    CHECK(strncmp(hear_line(b.reader), "OK 0 points=1", 13) == 0);
    expect(b.reader, "OK 0\nOK 1\n2 4 4\n");
    end(&b);
}

TEST(reply_of_many_rows_waits_as_a_whole_and_comes_as_a_whole)
{
    enum { MANY = 30000 };
    struct bench b;
    begin(&b, "always");
    load_random(b.writer, "t", MANY);
    shut_gate(&b);
    say(b.writer, "ADD t 7 7\n");
    CHECK(is_silent(&b, b.writer));
    say(b.reader, "POINTS t\n");
    CHECK(is_silent(&b, b.reader));
    open_gate(&b);
    expect(b.writer, "OK 0 first=30000 added=1 coincident=0\n");
    CHECK_STR(hear_line(b.reader), "OK 30001");
    for (int i = 0; i < MANY; i++)
        hear_line(b.reader);
    CHECK_STR(hear_line(b.reader), "30000 7 7");
    end(&b);
}

TEST(change_that_is_only_to_be_written_is_shown_when_it_is_written)
{
    static const char *const policies[] = {"everysec", "no"};
    for (int i = 0; i < 2; i++) {
        struct bench b;
        begin(&b, policies[i]);
        carry_out(&b.d, points);
        shut_gate(&b);
        say(b.writer, "ADD t 7 7\n");
        /* With everysec the sync that is due may have begun before it was written. */
        if (strcmp(policies[i], "no") == 0)
            expect(b.writer, "OK 0 first=4 added=1 coincident=0\n");
        else
            pause_ms(100); /* until it has been carried out */
        say(b.reader, "GET t 4\n");
        if (strcmp(policies[i], "no") == 0)
            expect(b.reader, "OK 1\n4 7 7\n");
        open_gate(&b);
        if (strcmp(policies[i], "no") != 0)
            expect(b.reader, "OK 1\n4 7 7\n");
        end(&b);
    }
}

/* ---- a disk that stays broken ---- */

/* After the first ADD, the next `times` syncs of this daemon fail. */
static void begin_badly(struct bench *b, const char *times)
{
    setenv("DISK_OP", "sync", 1);
    setenv("DISK_NTH", "4", 1); /* the segment, the directory, the first ADD: these succeed */
    setenv("DISK_TIMES", times, 1);
    begin(b, "always");
}

TEST(query_is_answered_and_its_connection_kept_when_the_disk_stays_broken)
{
    struct bench b;
    begin_badly(&b, "1000000");
    carry_out(&b.d, "ADD t 0 0\n");
    shut_gate(&b);
    say(b.writer, "ADD t 7 7\n");
    CHECK(is_silent(&b, b.writer));
    say(b.reader, "GET t 1\n");
    CHECK(is_silent(&b, b.reader));
    open_gate(&b);
    expect(b.reader, "OK 1\n1 7 7\n");
    CHECK(strncmp(hear_line(b.writer), "ERR IO", 6) == 0);
    say(b.reader, "GET t 1\nADD t 8 8\nGET t 0\n");
    expect(b.reader, "OK 1\n1 7 7\nERR READONLY");
    hear_line(b.reader);
    expect(b.reader, "OK 1\n0 0 0\n");
    end(&b);
}

TEST(query_waits_for_the_disk_again_when_that_is_good_again)
{
    struct bench b;
    begin_badly(&b, "2"); /* the second ADD, and the snapshot that would make up for it */
    carry_out(&b.d, "ADD t 0 0\n");
    say(b.writer, "ADD t 7 7\n");
    CHECK(strncmp(hear_line(b.writer), "ERR IO", 6) == 0);
    await_info(&b.d, "log_durable_lsn", 2);
    shut_gate(&b);
    close(b.writer);
    b.writer = daemon_connect(&b.d);
    say(b.writer, "ADD t 8 8\n");
    CHECK(is_silent(&b, b.writer));
    say(b.reader, "GET t 2\n");
    CHECK(is_silent(&b, b.reader));
    open_gate(&b);
    expect(b.reader, "OK 1\n2 8 8\n");
    end(&b);
}
