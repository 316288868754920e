/* lag_test.c - what INFO replication and ROLE say about a follower that has everything; and one that stalls. */
#include "tests/server/follow/node.h"
#include "tests/test.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool info_has(const struct daemon *d, const char *text)
{
    size_t n;
    int fd = daemon_connect(d);
    say(fd, "INFO replication\nQUIT\n");
    char *all = hear_all(fd, &n);
    close(fd);
    bool has = strstr(all, text) != NULL;
    free(all);
    return has;
}

/* The headers that come every second while there are no changes are acknowledged, too. */
TEST(lag_of_a_follower_that_has_everything_is_no_bytes)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    int fd = daemon_connect(&l.d);
    say(fd, "ADD t 1 1\nWAIT 1 60\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0", 12) == 0);
    CHECK_STR(hear_line(fd), "OK 0 followers=1");
    pause_ms(1500); /* a header has come */
    for (unsigned i = 0; i < 100 * test_slowness() && !info_has(&l.d, "lag_records=0,lag_bytes=0,");
         i++)
        pause_ms(50);
    CHECK(info_has(&l.d, "lag_records=0,lag_bytes=0,"));
    close(fd);
    node_end(&l);
    node_end(&f);
}

/* A request in RESP, and the beginning of its reply. */
static void expect_resp(const struct daemon *d, const char *request, const char *want)
{
    int fd = daemon_connect(d);
    say(fd, request);
    expect(fd, want);
    close(fd);
}

TEST(role_in_resp_is_that_of_a_leader_with_followers_and_of_a_follower)
{
    static const char role[] = "*1\r\n$4\r\nROLE\r\n",
                      info[] = "*2\r\n$4\r\nINFO\r\n$11\r\nreplication\r\n";
    struct node l = node_new(NULL), f = node_follower_of(&l);
    char want[300];
    carry_out(&l.d, "ADD t 1 1\n");
    node_await_position(&l, &f);
    expect_resp(&l.d, role, "*3\r\n$6\r\nmaster\r\n:1\r\n*1\r\n*3\r\n$9\r\n127.0.0.1\r\n$");
    snprintf(want, sizeof want,
             "*5\r\n$5\r\nslave\r\n$9\r\n127.0.0.1\r\n:%u\r\n$9\r\nconnected\r\n:1\r\n", l.d.port);
    expect_resp(&f.d, role, want);
    int fd = daemon_connect(&f.d);
    say(fd, info);
    hear_line(fd); /* the length */
    snprintf(want, sizeof want,
             "# Replication\r\nrole:slave\r\nmaster_host:127.0.0.1\r\nmaster_port:%u\r\n"
             "master_link_status:up\r\nslave_read_only:1\r\nslave_repl_offset:1\r\n"
             "connected_slaves:0\r\nmaster_repl_offset:1\r\ndelaunayd_role:follower\r\n",
             l.d.port);
    expect(fd, want);
    close(fd);
    node_end(&l);
    node_end(&f);
}

/* Some 190 MB of log; the bound is far above what buffers of the connection and freed pages need. */
TEST_TIMEOUT(follower_that_stalls_delays_nobody_and_costs_its_leader_no_memory, 60)
{
    enum { LOADS = 30, WARM = 4, ROOM = 64 << 20 };
    const unsigned points = test_is_sanitized() ? 20000 : 400000;
    struct node l = node_new((const char *[]){"--fsync", "no", NULL}), f = node_follower_of(&l);
    carry_out(&l.d, "ADD a 0 0\n");
    node_expect_same(&l, &f);
    int fd = daemon_connect(&l.d);
    size_t before = 0;
    kill(f.d.pid, SIGSTOP);
    for (int i = 0; i < LOADS; i++) {
        load_random(fd, "big", points);
        CHECK(strncmp(node_ask_on(fd, "DROP big\n"), "OK", 2) == 0);
        if (i == WARM)
            before = daemon_resident(&l.d);
    }
    size_t after = daemon_resident(&l.d);
    CHECK_MSG(test_is_sanitized() || after < before + ROOM, "%zu bytes, then %zu", before, after);
    carry_out(&l.d, "ADD a 1 1\n");
    kill(f.d.pid, SIGCONT);
    node_await_position(&l, &f);
    node_expect_same(&l, &f);
    close(fd);
    node_end(&l);
    node_end(&f);
}
