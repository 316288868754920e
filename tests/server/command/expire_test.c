/* expire_test.c - sets that the server drops at a time. */
#include "tests/server/directory.h"
#include "tests/test.h"

#include <signal.h>
#include <string.h>
#include <unistd.h>

TEST(expire_drops_a_set_at_its_time)
{
    struct daemon d = daemon_start(NULL);
    converse(&d,
             "ADD t 0 0 1 1\nADD u 5 5\nEXPIRE t 0\nSTAT t\nSETS\nTRIANGULATE t\nADD t 2 2\nTTL t\n"
             "EXPIRE t -5\nDROP t\nCREATE t\nPOINTS t\n",
             "OK 0 first=0 added=2 coincident=0\nOK 0 first=0 added=1 coincident=0\nOK 0\n"
             "ERR NOSET there is no set t\nOK 1\nu points=1 triangulated=no\n"
             "ERR NOSET there is no set t\nOK 0 first=0 added=1 coincident=0\nOK 0\nOK 0\n"
             "ERR NOSET there is no set t\nOK 0\nOK 0\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(expire_can_be_taken_back)
{
    struct daemon d = daemon_start(NULL);
    converse(&d, "CREATE t TEMPORARY\nPERSIST t\nEXPIRE t 1000\nPERSIST t\nTTL t\nPERSIST t\n",
             "OK 0\nOK 0 changed=0\nOK 0\nOK 0 changed=1\nOK 0\nOK 0 changed=0\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(expire_takes_seconds)
{
    struct daemon d = daemon_start(NULL);
    converse(&d, "CREATE t\nEXPIRE t soon\nEXPIRE t 1e10\nEXPIRE t\nEXPIRE u 1\nTTL u\nPERSIST u\n",
             "OK 0\nERR NUMBER soon is not a number\n"
             "ERR RANGE a set is dropped within 1000000000 seconds, or never\n"
             "ERR SYNTAX usage: EXPIRE set seconds\nERR NOSET there is no set u\n"
             "ERR NOSET there is no set u\nERR NOSET there is no set u\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* Sets that no request names: the server drops them by itself. */
TEST(expire_needs_no_request)
{
    enum { N = 100 };
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    char line[64];
    for (int i = 0; i < N; i++) {
        sprintf(line, "CREATE set%d\nEXPIRE set%d %s\n", i, i, i % 2 == 0 ? "0.3" : "1000");
        say(fd, line);
        expect(fd, "OK 0\nOK 0\n");
    }
    await_info(&d, "sets", N / 2);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* Between 900 and 1000 seconds are left. */
static void expect_ttl(const struct daemon *d, const char *request)
{
    int fd = daemon_connect(d);
    say(fd, request);
    const char *ttl = strstr(hear_line(fd), " ttl=");
    CHECK(ttl != NULL);
    double s = strtod(ttl + 5, NULL);
    CHECK_MSG(s > 900 && s <= 1000, "%s", ttl);
    close(fd);
}

TEST(expire_survives_a_restart_by_log_and_by_snapshot)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    converse(&d,
             "ADD t 0 0\nCREATE u\nADD gone 1 1\nEXPIRE t 1000\nEXPIRE u 5\nPERSIST u\n"
             "EXPIRE gone 0.001\n",
             "OK 0 first=0 added=1 coincident=0\nOK 0\nOK 0 first=0 added=1 coincident=0\nOK 0\n"
             "OK 0\nOK 0 changed=1\nOK 0\n");
    daemon_stop(&d, SIGKILL);
    for (int i = 0; i < 3; i++) { /* the log, then snapshots */
        d = directory_daemon(&dir, NULL);
        expect_ttl(&d, "TTL t\n");
        expect_ttl(&d, "STAT t\n");
        converse(&d, "TTL u\nSTAT gone\n", "OK 0\nERR NOSET there is no set gone\n");
        carry_out(&d, "SNAPSHOT\n");
        await_info(&d, "snapshots", 1);
        daemon_stop(&d, SIGKILL);
    }
    d = directory_daemon(&dir, NULL);
    converse(&d, "EXPIRE t 0\nPOINTS t\nADD t 7 7\n",
             "OK 0\nERR NOSET there is no set t\nOK 0 first=0 added=1 coincident=0\n");
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL);
    converse(&d, "POINTS t\nTTL t\n", "OK 1\n0 7 7\nOK 0\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    directory_remove(&dir);
}
