/* memory_test.c - the memory that clients can make a daemon use stays below --max-memory, and all of them
 * are answered. */
#include "tests/server/directory.h"
#include "tests/server/said.h"
#include "tests/test.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#define MB ((size_t)1000 * 1000)

static bool begins_with(const char *line, const char *with)
{
    return strncmp(line, with, strlen(with)) == 0;
}

static void check_peak(const struct daemon *d, size_t most)
{
    size_t peak = daemon_peak_resident(d);
    CHECK_MSG(test_is_sanitized() || peak <= most, "the daemon has had %zu bytes", peak);
}

/* Loads sets t0, t1, ... of random points, each on a connection of its own. */
static void load_sets(const struct daemon *d, int *fd, int sets, uint32_t points)
{
    char name[16];
    for (int i = 0; i < sets; i++) {
        fd[i] = daemon_connect(d);
        snprintf(name, sizeof name, "t%d", i);
        load_random(fd[i], name, points);
    }
}

/* Requests their triangulations, all at once. */
static void triangulate_sets(const int *fd, int sets, const char *how)
{
    char text[64];
    for (int i = 0; i < sets; i++) {
        snprintf(text, sizeof text, "TRIANGULATE t%d%s\n", i, how);
        say(fd[i], text);
    }
}

TEST_TIMEOUT(eight_builds_at_once_stay_below_max_memory_and_all_are_answered, 120)
{
    enum { SETS = 8, POINTS = 400000 };
    const char *arguments[] = {"--max-memory", "200m", "--threads", "2", NULL};
    struct daemon d = daemon_start(arguments);
    int fd[SETS];
    unsigned done = 0;
    load_sets(&d, fd, SETS, POINTS);
    triangulate_sets(fd, SETS, "");
    for (int i = 0; i < SETS; i++) {
        const char *line = hear_line(fd[i]);
        bool refused = begins_with(line, "ERR BUSY ") || begins_with(line, "ERR NOMEM ");
        CHECK_MSG(refused || begins_with(line, "OK 0 points=400000 "), "%s", line);
        done += !refused;
    }
    CHECK_MSG(done >= 2, "only %u builds succeeded", done);
    CHECK(daemon_info(&d, "memory_builds") == 0 && daemon_info(&d, "memory_edits") == 0);
    check_peak(&d, 230 * MB);
}

/* Builds that fit one at a time are done one after the other. */
TEST_TIMEOUT(builds_that_do_not_fit_together_wait_for_each_other_in_order, 120)
{
    enum { SETS = 6, POINTS = 100000 };
    const char *arguments[] = {"--max-memory", "100m", "--threads", "4", NULL};
    struct daemon d = daemon_start(arguments);
    int fd[SETS];
    load_sets(&d, fd, SETS, POINTS);
    for (int round = 0; round < 3; round++) { /* METHOD: each is a build */
        triangulate_sets(fd, SETS, " METHOD divide");
        for (int i = 0; i < SETS; i++)
            CHECK(begins_with(hear_line(fd[i]), "OK 0 points=100000 "));
    }
    check_peak(&d, 115 * MB);
    CHECK(daemon_info(&d, "memory_peak") < 105 * MB);
    for (unsigned tries = 0; daemon_info(&d, "memory_used") >= 70 * MB; tries++, pause_ms(10))
        CHECK(tries <
              500 * test_slowness()); /* workers free the versions that have been replaced */
}

/* Numbers of 2,500 bits need ten times the memory, but no point of a circle needs such numbers. */
TEST_TIMEOUT(weights_of_many_neighbours_reserve_the_memory_of_their_numbers, 60)
{
    enum { POINTS = 20000 };
    const char *arguments[] = {"--max-memory", "48m", "--threads", "2", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    char text[100];
    snprintf(text, sizeof text, "LOAD t %d\n", POINTS);
    say(fd, text);
    for (int i = 0; i < POINTS; i++) {
        double angle = i * 6.283185307179586 / POINTS;
        snprintf(text, sizeof text, "%.17g %.17g\n", cos(angle), sin(angle));
        say(fd, text);
    }
    say(fd, "TRIANGULATE t\nWEIGHTS t 0.25 0.125 METHOD natural\n");
    for (int i = 0; i < 2; i++)
        CHECK(begins_with(hear_line(fd), "OK 0 "));
    CHECK_STR(hear_line(fd), "OK 20000");
    CHECK(daemon_info(&d, "memory_peak") < 48 * MB);
}

TEST_TIMEOUT(client_that_disconnects_while_its_build_waits_for_memory_delays_nobody, 120)
{
    enum { SETS = 6, POINTS = 100000 };
    const char *arguments[] = {"--max-memory", "64m", "--threads", "2", NULL};
    struct daemon d = daemon_start(arguments);
    int fd[SETS];
    load_sets(&d, fd, SETS, POINTS);
    triangulate_sets(fd, SETS, " METHOD shelling");
    for (int i = 1; i < SETS; i += 2)
        close(fd[i]);
    unsigned done = 0;
    for (int i = 0; i < SETS; i += 2)
        done += begins_with(hear_line(fd[i]), "OK 0 points=100000 ");
    CHECK_MSG(done >= 1, "%u", done);
    await_info(&d, "jobs_running", 0);
    CHECK(daemon_info(&d, "memory_builds") == 0);
    say(fd[0], "DROP t1\nDROP t3\nDROP t5\nTRIANGULATE t4\n");
    expect(fd[0], "OK 0\nOK 0\nOK 0\n");
    CHECK(begins_with(hear_line(fd[0]), "OK 0 points=100000 "));
}

/* ---- the log's queue, while the disk stalls ---- */

/* A process that sends LOADB and DROP of a set repeatedly, reads all replies, and exits: with 0 if all
 * were OK. */
static pid_t load_and_drop(const struct daemon *d, int rounds, uint32_t n)
{
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid > 0)
        return pid;
    int fd = daemon_connect(d), bad = 0;
    double *xy = calloc(n, 16);
    for (int i = 0; i < rounds && xy != NULL; i++) {
        char text[100];
        for (uint32_t k = 0; k < 2 * n; k++)
            xy[k] = k % 2 == 0 ? (double)k : (double)i;
        snprintf(text, sizeof text, "LOADB t %u\n", n);
        say(fd, text);
        say_bytes(fd, xy, (size_t)n * 16);
        snprintf(text, sizeof text, "ADD log %d 1\nDROP t\n", i);
        say(fd, text);
    }
    for (int i = 0; i < 3 * rounds; i++)
        bad += !begins_with(hear_line(fd), "OK 0");
    _exit(bad > 0);
}

/* Waits until the daemon has carried out only our commands for a while. */
static void await_standstill(const struct daemon *d)
{
    uint64_t before = 0, now;
    for (unsigned still = 0, tries = 0; still < 20; tries++, pause_ms(20)) {
        CHECK(tries < 1000 * test_slowness());
        now = daemon_info(d, "commands");
        still = now == before + 2 ? still + 1 : 0; /* INFO and QUIT are ours */
        before = now;
    }
}

/* Waits until the log's queue has more than `bytes` bytes, however slow the machine is, and then until nothing
 * more is carried out. Returns how many bytes it has. */
static size_t await_queue(const struct daemon *d, size_t bytes)
{
    for (unsigned tries = 0; daemon_info(d, "memory_log") <= bytes; tries++, pause_ms(20))
        CHECK(tries < 1500 * test_slowness());
    await_standstill(d);
    return daemon_info(d, "memory_log");
}

/* A daemon whose disk stalls while the file `gate` exists. */
static struct daemon daemon_with_gate(const struct directory *dir, const char *const *arguments,
                                      char gate[100])
{
    snprintf(gate, 100, "%s.gate", dir->path);
    setenv("LD_PRELOAD", getenv("DISK_SHIM"), 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
    setenv("DISK_DIR", dir->path, 1);
    setenv("DISK_GATE", gate, 1);
    struct daemon d = directory_daemon(dir, arguments);
    unsetenv("LD_PRELOAD");
    return d;
}

TEST_TIMEOUT(queue_of_the_log_has_64_KiB_however_little_memory_there_is, 60)
{
    enum { CHANGES = 2000 }; /* more than that */
    struct directory dir = directory_new();
    char gate[100];
    const char *arguments[] = {"--max-memory", "256k", NULL};
    struct daemon d = daemon_with_gate(&dir, arguments, gate);
    carry_out(&d, "ADD t 1 1\n");
    file_write(gate, "", 0);
    int fd = daemon_connect(&d);
    for (int i = 0; i < CHANGES; i++) {
        say(fd, "MOVE t 0 1 1\n");
        if (i % 50 == 0) /* so that they arrive in many turns */
            daemon_info(&d, "memory_log");
    }
    size_t queued = await_queue(&d, 64 * 1024);
    CHECK_MSG(queued > 64 * 1024 && queued < 72 * 1024, "%zu", queued);
    CHECK(unlink(gate) == 0);
    for (int i = 0; i < CHANGES; i++)
        CHECK_STR(hear_line(fd), "OK 0");
    close(fd);
    daemon_end(&d);
    directory_remove(&dir);
}

TEST_TIMEOUT(changes_wait_while_the_disk_stalls_and_the_logs_queue_stays_small, 120)
{
    enum { ROUNDS = 80, POINTS = 100000 };
    struct directory dir = directory_new();
    char gate[100];
    int status;
    const char *arguments[] = {"--max-memory", "64m", "--compact-at", "4g", NULL};
    struct daemon d = daemon_with_gate(&dir, arguments, gate);
    carry_out(&d, "ADD other 0 0 1 0 0 1\nTRIANGULATE other\n");
    file_write(gate, "", 0);
    pid_t writer = load_and_drop(&d, ROUNDS, POINTS);
    size_t queued = await_queue(&d, 8 * MB);
    CHECK_MSG(queued > 8 * MB && queued < 12 * MB, "%zu", queued);
    converse(&d, "PING\nNEAREST other 0.9 0\n", "OK 0\nOK 1\n1 1 0 0.09999999999999998\n");
    check_peak(&d, 90 * MB);
    CHECK(unlink(gate) == 0);
    CHECK(waitpid(writer, &status, 0) == writer && WIFEXITED(status) && WEXITSTATUS(status) == 0);
    check_peak(&d, 90 * MB);
    CHECK(daemon_stop(&d, SIGKILL) == -1); /* nothing is lost or reordered */
    d = directory_daemon(&dir, arguments);
    int fd = daemon_connect(&d);
    char last[100];
    say(fd, "SETS\nGET log 79\n");
    snprintf(
        last, sizeof last,
        "OK 2\nlog points=%d triangulated=no\nother points=3 triangulated=yes\nOK 1\n79 79 1\n",
        ROUNDS);
    expect(fd, last);
    daemon_end(&d);
    directory_remove(&dir);
}

/* ---- loads that stall ---- */

/* Sends the first n points 0 0, 1 0, ... of a LOADB that announces `all`. */
static void begin_load(int fd, uint32_t all, uint32_t n)
{
    char head[64];
    double *xy = calloc(n, 16);
    CHECK(xy != NULL);
    for (uint32_t i = 0; i < n; i++)
        xy[2 * i] = i;
    snprintf(head, sizeof head, "LOADB t %u\n", all);
    say(fd, head);
    say_bytes(fd, xy, (size_t)n * 16);
    free(xy);
}

TEST_TIMEOUT(load_whose_points_stop_arriving_is_cancelled_and_its_memory_is_freed, 60)
{
    enum { POINTS = 200000 };
    static const double one_point[2] = {0.5, 0.5};
    const char *arguments[] = {"--load-timeout", "1", "--max-memory", "32m", NULL};
    struct daemon d = daemon_start(arguments);
    int silent = daemon_connect(&d), slow = daemon_connect(&d), typed = daemon_connect(&d);
    begin_load(silent, POINTS, POINTS / 2);
    begin_load(slow, POINTS, POINTS / 2);
    say(typed, "LOAD typed\n");
    for (int i = 0; i < 20;
         i++, pause_ms(200)) { /* a point at a time is enough for a short one only */
        say(typed, "1 1\n");
        (void)send(slow, one_point, sizeof one_point, MSG_NOSIGNAL);
    }
    CHECK_STR(hear_line(silent), "ERR TIMEOUT the points stopped coming; nothing was loaded");
    expect_end(silent);
    CHECK_STR(hear_line(slow), "ERR TIMEOUT the points stopped coming; nothing was loaded");
    say(typed, ".\n");
    expect(typed, "OK 0 first=0 added=20 coincident=19\n");
    CHECK(daemon_info(&d, "loading") == 0 && daemon_info(&d, "sets") == 1);
    begin_load(typed, POINTS, POINTS);
    CHECK_STR(hear_line(typed), "OK 0 first=0 added=200000 coincident=0");
}

TEST_TIMEOUT(loads_that_arrive_slowly_but_steadily_are_not_cancelled, 60)
{
    enum { POINTS = 200000, STEPS = 20 };
    const char *arguments[] = {"--load-timeout", "1", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    double *xy = calloc(POINTS / STEPS, 16);
    CHECK(xy != NULL);
    say(fd, "LOADB t 200000\n");
    for (int i = 0; i < STEPS; i++, pause_ms(150))
        say_bytes(fd, xy, POINTS / STEPS * 16);
    CHECK_STR(hear_line(fd), "OK 0 first=0 added=200000 coincident=199999");
    free(xy);
}

TEST_TIMEOUT(bodies_reserve_memory_as_they_grow_and_are_refused_if_they_do_not_fit, 60)
{
    enum { POINTS = 400000, CLIENTS = 12 }; /* 6.4 MB each */
    const char *arguments[] = {"--max-memory", "32m", NULL};
    struct daemon d = daemon_start(arguments);
    int fd[CLIENTS];
    for (int i = 0; i < CLIENTS; i++) {
        fd[i] = daemon_connect(&d);
        begin_load(fd[i], POINTS, POINTS - 1);
    }
    pause_ms(300);
    size_t loading = daemon_info(&d, "loading");
    CHECK_MSG(loading > 12 * MB && loading < 32 * MB, "%zu", loading);
    double last[2] = {-1, -1};
    int refused = 0;
    for (int i = 0; i < CLIENTS; i++)
        say_bytes(fd[i], last, sizeof last);
    for (int i = 0; i < CLIENTS; i++) {
        const char *line = hear_line(fd[i]);
        bool no = begins_with(line, "ERR BUSY ") || begins_with(line, "ERR NOMEM ");
        CHECK_MSG(no || begins_with(line, "OK 0 "), "%s", line);
        refused += no;
    }
    CHECK(refused > 0);
    check_peak(&d, 46 * MB);
    CHECK(daemon_info(&d, "loading") == 0);
}

/* ---- a restart with less memory than before ---- */

/* A daemon on the directory, and its messages. */
static struct said begin_noted(const struct directory *dir, const char *max_memory,
                               struct daemon *d)
{
    const char *arguments[] = {"--max-memory", max_memory, NULL};
    struct said said = said_begin();
    *d = directory_daemon(dir, arguments);
    said_end(&said);
    return said;
}

TEST_TIMEOUT(sets_larger_than_max_memory_survive_a_restart_and_can_shrink, 60)
{
    enum { POINTS = 20000 };
    static const char warning[] = "points can be deleted, but not added";
    struct directory dir = directory_new();
    struct daemon d;
    struct said said = begin_noted(&dir, "64m", &d);
    load_random(daemon_connect(&d), "a", POINTS);
    load_random(daemon_connect(&d), "b", POINTS);
    carry_out(&d, "TRIANGULATE a\nDEL a 7\n");
    CHECK(daemon_stop(&d, SIGKILL) == -1);
    CHECK(said_lines(&said, warning) == 0);
    said = begin_noted(&dir, "1m", &d);
    await_info(&d, "loaded_percent", 100);
    said_await(&said, warning, 1);
    int fd = daemon_connect(&d);
    say(fd, "SETS\nADD a 2 2\nDEL a 8\nSNAPSHOT\nDROP b\n");
    expect(fd, "OK 2\na points=19999 triangulated=yes\nb points=20000 triangulated=no\n");
    CHECK(begins_with(hear_line(fd), "ERR NOMEM "));
    expect(fd, "OK 0 deleted=1\n");
    CHECK(begins_with(hear_line(fd), "OK 0 lsn="));
    expect(fd, "OK 0\n");
    await_info(&d, "snapshot_running", 0);
    CHECK(daemon_stop(&d, SIGKILL) == -1);
    begin_noted(&dir, "64m", &d);
    await_info(&d, "loaded_percent", 100);
    converse(&d, "SETS\nADD a 2 2\n",
             "OK 1\na points=19998 triangulated=yes\nOK 0 first=20000 added=1 coincident=0\n");
    directory_remove(&dir);
}
