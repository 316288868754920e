/* memory_test.c - what clients can make a daemon take stays below --max-memory, and everybody is
 * answered. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define MB ((size_t)1000 * 1000)

static bool begins_with(const char *line, const char *with)
{
    return strncmp(line, with, strlen(with)) == 0;
}

static void check_peak(const struct daemon *d, size_t most)
{
    size_t peak = daemon_peak_resident(d);
    CHECK_MSG(!costs_are_telling() || peak <= most, "the daemon has had %zu bytes", peak);
}

TEST_TIMEOUT(eight_builds_at_once_stay_below_max_memory_and_all_are_answered, 120)
{
    enum { SETS = 8, POINTS = 400000 };
    const char *arguments[] = {"--max-memory", "200m", "--threads", "2", NULL};
    struct daemon d = daemon_start(arguments);
    int fd[SETS];
    unsigned done = 0;
    char text[64];
    for (int i = 0; i < SETS; i++) {
        fd[i] = daemon_connect(&d);
        snprintf(text, sizeof text, "t%d", i);
        load_random(fd[i], text, POINTS);
    }
    for (int i = 0; i < SETS; i++) {
        snprintf(text, sizeof text, "TRIANGULATE t%d\n", i);
        say(fd[i], text);
    }
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

/* Whatever fits when it is alone is done, one after the other. */
TEST_TIMEOUT(builds_that_do_not_fit_together_wait_for_each_other_in_order, 120)
{
    enum { SETS = 6, POINTS = 100000 };
    const char *arguments[] = {"--max-memory", "100m", "--threads", "4", NULL};
    struct daemon d = daemon_start(arguments);
    int fd[SETS];
    char text[64];
    for (int i = 0; i < SETS; i++) {
        fd[i] = daemon_connect(&d);
        snprintf(text, sizeof text, "t%d", i);
        load_random(fd[i], text, POINTS);
    }
    for (int round = 0; round < 3; round++) { /* METHOD: each is a build */
        for (int i = 0; i < SETS; i++) {
            snprintf(text, sizeof text, "TRIANGULATE t%d METHOD divide\n", i);
            say(fd[i], text);
        }
        for (int i = 0; i < SETS; i++)
            CHECK(begins_with(hear_line(fd[i]), "OK 0 points=100000 "));
    }
    check_peak(&d, 115 * MB);
    CHECK(daemon_info(&d, "memory_used") < 70 * MB && daemon_info(&d, "memory_peak") < 105 * MB);
}

TEST_TIMEOUT(client_that_leaves_while_its_build_waits_for_memory_holds_up_nobody, 120)
{
    enum { SETS = 6, POINTS = 100000 };
    const char *arguments[] = {"--max-memory", "64m", "--threads", "2", NULL};
    struct daemon d = daemon_start(arguments);
    int fd[SETS];
    char text[64];
    for (int i = 0; i < SETS; i++) {
        fd[i] = daemon_connect(&d);
        snprintf(text, sizeof text, "t%d", i);
        load_random(fd[i], text, POINTS);
    }
    for (int i = 0; i < SETS; i++) {
        snprintf(text, sizeof text, "TRIANGULATE t%d METHOD shelling\n", i);
        say(fd[i], text);
    }
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
