/* temporary_test.c - sets that are dropped when the connection that created them ends. */
#include "tests/server/directory.h"
#include "tests/test.h"

#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

/* Waits until the daemon has `want` sets. */
static void await_sets(const struct daemon *d, uint64_t want)
{
    await_info(d, "sets", want);
}

TEST(temporary_set_ends_with_its_connection_and_others_stay)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "CREATE a TOL 0.5 TEMPORARY\nCREATE b TEMPORARY TOL 1\nCREATE c\nADD a 1 1\n");
    expect(fd, "OK 0\nOK 0\nOK 0\nOK 0 first=0 added=1 coincident=0\n");
    converse(&d, "ADD a 2 2\nSETS\nCREATE a\n",
             "OK 0 first=1 added=1 coincident=0\nOK 3\na points=2 triangulated=no\n"
             "b points=0 triangulated=no\nc points=0 triangulated=no\n"
             "ERR EXISTS the set a already exists\n");
    close(fd);
    await_sets(&d, 1);
    converse(&d, "SETS\nCREATE a\n", "OK 1\nc points=0 triangulated=no\nOK 0\n");
    daemon_end(&d);
}

TEST(temporary_set_that_is_dropped_may_be_created_again_as_a_permanent_one)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd,
        "CREATE a TEMPORARY\nCREATE b TEMPORARY\nCREATE c TEMPORARY\nDROP b\nCREATE b\nDROP c\n");
    expect(fd, "OK 0\nOK 0\nOK 0\nOK 0\nOK 0\nOK 0\n");
    close(fd);
    await_sets(&d, 1);
    converse(&d, "SETS\n", "OK 1\nb points=0 triangulated=no\n");
    daemon_end(&d);
}

TEST(thousands_of_temporary_sets_all_end)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    for (int i = 0; i < 3000; i++) {
        char line[64];
        snprintf(line, sizeof line, "CREATE s%d TEMPORARY\n", i);
        say(fd, line);
    }
    for (int i = 0; i < 3000; i++)
        expect(fd, "OK 0\n");
    close(fd);
    await_sets(&d, 0);
    daemon_end(&d);
}

TEST(temporary_set_that_another_client_writes_ends_after_that)
{
    struct daemon d = daemon_start(NULL);
    int owner = daemon_connect(&d), other = daemon_connect(&d);
    say(owner, "CREATE t TEMPORARY\n");
    expect(owner, "OK 0\n");
    load_random(other, "t", 300000);
    await_info(&d, "clients", 3); /* with the one that asks */
    await_info(&d, "jobs_running", 0);
    uint64_t jobs = daemon_info(&d, "jobs");
    say(other, "TRIANGULATE t\n");
    while (daemon_info(&d, "jobs") == jobs)
        pause_ms(1);
    close(owner);
    await_info(&d, "clients", 2);
    CHECK(strncmp(hear_line(other), "OK 0 points=300000", 18) == 0);
    say(other, "SETS\nSTAT t\n");
    expect(other, "OK 0\nERR NOSET there is no set t\n");
    await_sets(&d, 0);
    daemon_end(&d);
}

TEST(temporary_set_is_not_on_disk)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    uint64_t lsn = daemon_info(&d, "log_lsn");
    int fd = daemon_connect(&d);
    say(fd, "CREATE t TEMPORARY\nADD t 0 0  1 0  0 1  5 5\nMOVE t 3 4 4\nDEL t 3\nTRIANGULATE t\n"
            "CREATE u TEMPORARY\nDROP u\n");
    expect(fd, "OK 0\nOK 0 first=0 added=4 coincident=0\nOK 0\nOK 0 deleted=1\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=3", 13) == 0);
    expect(fd, "OK 0\nOK 0\n");
    CHECK(daemon_info(&d, "log_lsn") == lsn);
    say(fd, "ADD v 1 1\nSNAPSHOT\n");
    expect(fd, "OK 0 first=0 added=1 coincident=0\n");
    CHECK(strncmp(hear_line(fd), "OK 0 lsn=", 9) == 0);
    await_info(&d, "snapshots", 1);
    CHECK(daemon_stop(&d, SIGKILL) == -1);
    d = directory_daemon(&dir, NULL);
    converse(&d, "SETS\n", "OK 1\nv points=1 triangulated=no\n");
    daemon_end(&d);
    directory_remove(&dir);
}

TEST(daemon_stops_with_temporary_sets)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "CREATE t TEMPORARY\nADD t 0 0\n");
    expect(fd, "OK 0\nOK 0 first=0 added=1 coincident=0\n");
    daemon_end(&d);
    close(fd);
}
