/* itself_test.c - FOLLOW of a daemon that is no other leader: of itself, by any address, and of its own follower. */
#include "server/follow/announce.h"
#include "tests/faults/tree.h"
#include "tests/server/follow/node.h"
#include "tests/test.h"

#include <arpa/inet.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

static void expect_leader(const struct node *n)
{
    CHECK(node_is(n, "role", "leader") && node_is(n, "leader", ""));
    node_expect(n, "ADD a 1 1", "OK 0 first=");
}

TEST_TIMEOUT(daemon_does_not_follow_itself_by_any_of_its_addresses, 60)
{
    static const char *const addresses[] = {"127.0.0.1", "0.0.0.0", "::ffff:127.0.0.1"};
    struct node n = node_new(NULL);
    char line[80], want[80];
    for (size_t i = 0; i < sizeof addresses / sizeof addresses[0]; i++) {
        snprintf(line, sizeof line, "FOLLOW %s %u%s", addresses[i], n.d.port,
                 i == 1 ? " CONFIRM" : "");
        bool v6 = strchr(addresses[i], ':') != NULL;
        snprintf(want, sizeof want, "ERR RANGE %s%s%s:%u is this daemon itself", v6 ? "[" : "",
                 addresses[i], v6 ? "]" : "", n.d.port);
        CHECK_STR(node_ask(&n, line), want);
        expect_leader(&n);
    }
    node_end(&n);
}

TEST_TIMEOUT(daemon_that_is_started_to_follow_itself_does_not_start, 60)
{
    static const char *const hosts[] = {"127.0.0.1", "0.0.0.0"};
    struct node n = node_new(NULL);
    char flag[40];
    daemon_end(&n.d);
    for (size_t i = 0; i < sizeof hosts / sizeof hosts[0]; i++) {
        struct daemon d;
        snprintf(flag, sizeof flag, "%s:%u", hosts[i], n.d.port);
        CHECK(!directory_try(
            &n.dir, (const char *const[]){"--port", n.d.port_text, "--follow", flag, NULL}, &d));
    }
    node_start(&n, NULL);
    expect_leader(&n);
    node_end(&n);
}

/* It does not answer itself without a token. */
TEST_TIMEOUT(daemon_with_tokens_does_not_follow_itself, 60)
{
    static const char tokens[] = "rw secret\n";
    struct directory files = directory_quick();
    char auth_file[100], line[80];
    snprintf(auth_file, sizeof auth_file, "%s/tokens", files.path);
    file_write(auth_file, tokens, strlen(tokens));
    struct node n = {.dir = directory_quick()};
    n.d = daemon_start((const char *const[]){"--data", n.dir.path, "--auth-file", auth_file, NULL});
    int fd = daemon_connect(&n.d);
    CHECK_STR(node_ask_on(fd, "AUTH secret"), "OK 0 role=rw");
    snprintf(line, sizeof line, "FOLLOW 127.0.0.1 %u", n.d.port);
    const char *got = node_ask_on(fd, line);
    CHECK_MSG(strncmp(got, "ERR RANGE", 9) == 0 && strstr(got, "it answers ERR ") != NULL, "%s",
              got);
    CHECK(strncmp(node_ask_on(fd, "ADD a 1 1"), "OK 0 first=0", 12) == 0);
    close(fd);
    node_end(&n);
    tree_remove(files.path);
}

TEST(answer_that_says_who_a_daemon_is_is_read)
{
    struct inquired who;
    announce_read(
        "OK 0 role=rw\nOK 5\nrole:follower\nleader:[::1]:7\nlink:receiving\ndaemon:00ff\n", &who);
    CHECK_STR(who.daemon, "00ff");
    CHECK_STR(who.role, "follower");
    CHECK_STR(who.leader, "[::1]:7");
    CHECK_STR(who.refusal, "");
    announce_read("ERR DENIED wrong token\nERR DENIED AUTH first\n", &who);
    CHECK_STR(who.refusal, "ERR DENIED wrong token");
    CHECK_STR(who.role, "");
    announce_read("OK 0\nERR x", &who);
    CHECK_STR(who.refusal, "ERR x");
    announce_read("", &who);
    CHECK_STR(who.refusal, "");
}

/* ---- through a relay ---- */

static bool pass(int from, int to)
{
    char bytes[4096];
    ssize_t n = read(from, bytes, sizeof bytes);
    return n > 0 && write(to, bytes, (size_t)n) == n;
}

/* Passes on one connection after the other, until it is killed. */
static void relay(int listener, const struct node *to)
{
    for (;;) {
        int fd[2] = {accept(listener, NULL, NULL), daemon_connect(&to->d)};
        struct pollfd p[2] = {{.fd = fd[0], .events = POLLIN}, {.fd = fd[1], .events = POLLIN}};
        bool going = true;
        while (going && poll(p, 2, -1) > 0)
            for (int i = 0; going && i < 2; i++)
                if (p[i].revents != 0)
                    going = pass(fd[i], fd[1 - i]);
        close(fd[0]);
        close(fd[1]);
    }
}

TEST_TIMEOUT(daemon_does_not_follow_itself_through_a_relay, 60)
{
    struct node n = node_new(NULL);
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof at;
    int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    CHECK(bind(listener, (struct sockaddr *)&at, size) == 0 && listen(listener, 10) == 0 &&
          getsockname(listener, (struct sockaddr *)&at, &size) == 0);
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0)
        relay(listener, &n);
    char line[80];
    snprintf(line, sizeof line, "FOLLOW 127.0.0.1 %u", ntohs(at.sin_port));
    const char *got = node_ask(&n, line);
    kill(pid, SIGKILL);
    waitpid(pid, NULL, 0);
    CHECK_MSG(strstr(got, "is this daemon itself") != NULL, "%s", got);
    expect_leader(&n);
    node_end(&n);
}

/* ---- rings ---- */

static void refuse(const struct node *n, const struct node *target, const char *part)
{
    char line[80];
    snprintf(line, sizeof line, "FOLLOW 127.0.0.1 %u", target->d.port);
    const char *got = node_ask(n, line);
    CHECK_MSG(strncmp(got, "ERR RANGE", 9) == 0 && strstr(got, part) != NULL, "%s", got);
}

TEST_TIMEOUT(leader_does_not_follow_its_follower_nor_a_daemon_of_a_ring, 60)
{
    struct node a = node_new(NULL), b = node_follower_of(&a), c = node_follower_of(&a);
    node_await(&b, "link", "receiving");
    node_await(&c, "link", "receiving");
    refuse(&a, &b, "a follower itself: FOLLOW its leader 127.0.0.1:");
    refuse(&b, &c, "a follower itself: FOLLOW its leader 127.0.0.1:");
    expect_leader(&a);
    node_expect_same(&a, &b);
    node_expect_same(&a, &c);
    carry_out(&b.d, "FOLLOW NONE\n");
    node_await(&a, "role", "fenced");
    refuse(&c, &a, "is no leader");
    node_follow(&a, &b, " CONFIRM");
    node_follow(&c, &b, "");
    node_expect_same(&b, &a);
    node_expect_same(&b, &c);
    node_end(&a);
    node_end(&b);
    node_end(&c);
}

/* ---- IPv6 ---- */

TEST_TIMEOUT(leader_with_an_ipv6_address_is_written_in_brackets, 60)
{
    struct node n = node_new(NULL);
    carry_out(&n.d, "FOLLOW ::1 1\n");
    CHECK(node_is(&n, "leader", "[::1]:1"));
    CHECK_STR(node_ask(&n, "ADD a 1 1"), "ERR READONLY leader=[::1]:1");
    carry_out(&n.d, "FOLLOW NONE\n");
    CHECK(node_is(&n, "uninformed_leader", "[::1]:1"));
    node_end(&n);
}
