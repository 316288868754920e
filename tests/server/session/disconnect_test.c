/* disconnect_test.c - clients that close their connection, or only their sending side, while a worker
 * carries out their request. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { POINTS = 600000 }; /* shelling takes less than a second for them, but much more than 50 ms */

static const char build[] = "TRIANGULATE t METHOD shelling\n";
static const char build_in_resp[] =
    "*4\r\n$11\r\nTRIANGULATE\r\n$1\r\nt\r\n$6\r\nMETHOD\r\n$8\r\nshelling\r\n";

/* A daemon with a Unix socket and a set t that is not triangulated. */
struct service {
    struct daemon d;
    char path[64];
};

static struct service start(void)
{
    struct service s;
    snprintf(s.path, sizeof s.path, "/tmp/delaunayd-test-%d.sock", (int)getpid());
    const char *arguments[] = {"--unix", s.path, NULL};
    s.d = daemon_start(arguments);
    int fd = daemon_connect(&s.d);
    load_random(fd, "t", POINTS);
    close(fd);
    await_info(&s.d, "clients", 1);
    return s;
}

/* Starts a build by a client that closes its connection; the build must end without a result. */
static void expect_cancelled(const struct service *s, int leaver, const char *request)
{
    say(leaver, request);
    await_info(&s->d, "jobs_running", 1);
    close(leaver);
    await_info(&s->d, "jobs_running", 0);
    await_info(&s->d, "clients", 1);
    int fd = daemon_connect(&s->d);
    say(fd, "STAT t\n");
    CHECK(strstr(hear_line(fd), "triangulated=no") != NULL);
    close(fd);
    await_info(&s->d, "clients", 1);
}

TEST(build_of_a_client_that_closes_its_connection_is_cancelled_before_it_is_a_second_old)
{
    struct service s = start();
    expect_cancelled(&s, daemon_connect(&s.d), build);
    daemon_end(&s.d);
}

TEST(client_that_closes_a_unix_socket_cancels_its_build_in_either_framing)
{
    struct service s = start();
    expect_cancelled(&s, connect_unix(s.path), build);
    expect_cancelled(&s, connect_unix(s.path), build_in_resp);
    daemon_end(&s.d);
}

TEST(client_that_closes_its_connection_cancels_its_request_that_waits_for_another_one)
{
    struct service s = start();
    int fd = daemon_connect(&s.d);
    say(fd, "ADD u 0 0  1 0  0 1\nTRIANGULATE u\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0", 12) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 points=3", 13) == 0);
    close(fd);
    int leaver = daemon_connect(&s.d);
    say(leaver, "CHECK u\nNEAREST u 1 1 2\n");
    expect_cancelled(&s, leaver, build);
    daemon_end(&s.d);
}

/* The reply to `request` on a connection whose sending side has been closed. */
static char *hear_half_closed(int fd, const char *request)
{
    size_t n;
    say(fd, request);
    CHECK(shutdown(fd, SHUT_WR) == 0);
    char *text = hear_all_and_comments(fd, &n);
    close(fd);
    return text;
}

TEST(client_that_closes_its_sending_side_gets_its_reply_after_an_early_comment)
{
    struct service s = start();
    char *text = hear_half_closed(daemon_connect(&s.d), build);
    CHECK_MSG(strncmp(text, "# progress ", 11) == 0 && strstr(text, "\nOK 0 points=") != NULL, "%s",
              text);
    free(text);
    daemon_end(&s.d);
}

TEST(client_that_closes_its_sending_side_gets_its_reply_in_resp_and_from_a_unix_socket)
{
    struct service s = start();
    char *text = hear_half_closed(daemon_connect(&s.d), build_in_resp);
    CHECK_MSG(strncmp(text, "+OK points=", 11) == 0, "%s", text);
    free(text);
    text = hear_half_closed(connect_unix(s.path), build);
    CHECK_MSG(strstr(text, "OK 0 points=") != NULL, "%s", text);
    free(text);
    daemon_end(&s.d);
}
