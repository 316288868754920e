/* single_flight_test.c - a request for a result that a job already computes waits for that result. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { POINTS = 50000, ATTEMPTS = 50 };

/* Asks on both connections; true if the second got the first one's result. The replies are in
 * one and two. */
static bool ask_both(const struct daemon *d, const int fd[2], const char *first, const char *second,
                     char *one, char *two)
{
    uint64_t before = daemon_info(d, "jobs_shared");
    say(fd[0], first);
    say(fd[1], second);
    strcpy(one, hear_line(fd[0]));
    strcpy(two, hear_line(fd[1]));
    return daemon_info(d, "jobs_shared") > before;
}

/* On a busy machine the first may be done before the second arrives, so this tries repeatedly. */
static void expect_shared(const char *first, const char *second)
{
    struct daemon d = daemon_start(NULL);
    int fd[2] = {daemon_connect(&d), daemon_connect(&d)};
    char one[1 << 16], two[1 << 16];
    bool shared = false;
    load_random(fd[0], "t", POINTS);
    say(fd[0], "TRIANGULATE t\n");
    hear_line(fd[0]);
    for (int i = 0; i < ATTEMPTS && !shared; i++) {
        shared = ask_both(&d, fd, first, second, one, two);
        CHECK(strstr(one, " points=50000 ") != NULL && strstr(two, " points=50000 ") != NULL);
        CHECK(!shared || strcmp(one, two) == 0);
    }
    CHECK(shared);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(triangulate_that_two_clients_request_runs_once)
{
    expect_shared("TRIANGULATE t METHOD shelling\n", "TRIANGULATE t METHOD shelling\n");
    expect_shared("TRIANGULATE t METHOD shelling\n", "TRIANGULATE t\n");
}

TEST(check_that_two_clients_request_runs_once)
{
    expect_shared("CHECK t\n", "CHECK t\n");
}

TEST(request_that_comes_after_a_result_does_not_get_it)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", POINTS);
    say(fd, "TRIANGULATE t\nCHECK t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 ", 5) == 0 && strncmp(hear_line(fd), "OK 0 ", 5) == 0);
    await_info(&d, "jobs_running", 0);
    uint64_t jobs = daemon_info(&d, "jobs");
    say(fd, "CHECK t\nCHECK t\nTRIANGULATE t METHOD divide\nTRIANGULATE t METHOD divide\n");
    for (int i = 0; i < 4; i++)
        CHECK(strncmp(hear_line(fd), "OK 0 ", 5) == 0);
    CHECK(daemon_info(&d, "jobs") >= jobs + 4 && daemon_info(&d, "jobs_shared") == 0);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(triangulate_by_another_method_runs_separately)
{
    struct daemon d = daemon_start(NULL);
    int fd[2] = {daemon_connect(&d), daemon_connect(&d)};
    char one[1 << 16], two[1 << 16];
    load_random(fd[0], "t", POINTS);
    CHECK(!ask_both(&d, fd, "TRIANGULATE t METHOD shelling\n", "TRIANGULATE t METHOD divide\n", one,
                    two));
    CHECK(strncmp(one, "OK 0 points=50000 ", 18) == 0);
    CHECK(strncmp(two, "OK 0 points=50000 ", 18) == 0);
    say(fd[0], "TRIANGULATE t METHOD shelling\n");
    say(fd[1], "TRIANGULATE t METHOD magic\n");
    CHECK(strncmp(hear_line(fd[1]), "ERR SYNTAX ", 11) == 0);
    hear_line(fd[0]);
}

/* Closes the connection so that the other side notices at once. */
static void reset(int fd)
{
    struct linger hard = {.l_onoff = 1};
    CHECK(setsockopt(fd, SOL_SOCKET, SO_LINGER, &hard, sizeof hard) == 0);
    close(fd);
}

TEST(clients_that_wait_for_the_job_of_a_client_that_disconnects_get_a_result)
{
    struct daemon d = daemon_start(NULL);
    int stays = daemon_connect(&d);
    load_random(stays, "t", POINTS);
    for (int i = 0; i < 3; i++) {
        int goes = daemon_connect(&d), resp = daemon_connect(&d);
        say(goes, "TRIANGULATE t METHOD shelling\n");
        say(stays, "TRIANGULATE t METHOD shelling\nDROP u\n");
        say(resp, "*2\r\n$11\r\nTRIANGULATE\r\n$1\r\nt\r\n");
        pause_ms(5);
        reset(goes);
        CHECK(strncmp(hear_line(stays), "OK 0 points=50000 ", 18) == 0);
        expect(stays, "ERR NOSET there is no set u\n");
        CHECK(strncmp(hear_line(resp), "+OK points=50000 ", 17) == 0);
        close(resp);
    }
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* The only worker is busy, so the cancelled job of the disconnected client still waits when the next
 * client asks. */
TEST(check_that_was_cancelled_is_not_joined)
{
    const char *arguments[] = {"--threads", "1", NULL};
    struct daemon d = daemon_start(arguments);
    int busy = daemon_connect(&d), goes = daemon_connect(&d), stays = daemon_connect(&d);
    load_random(busy, "large", 400000);
    load_random(busy, "t", 100000);        /* large enough that a check notices its cancellation */
    say(busy, "TRIANGULATE t\nCHECK t\n"); /* the first one also makes the grid */
    CHECK(strncmp(hear_line(busy), "OK 0 ", 5) == 0 && strncmp(hear_line(busy), "OK 0 ", 5) == 0);
    await_info(&d, "clients", 4);      /* the fourth asks for INFO */
    await_info(&d, "jobs_running", 0); /* the maintenance jobs after the loads */
    say(busy, "TRIANGULATE large METHOD shelling\n");
    say(goes, "CHECK t\n");
    converse(&d, "PING\n", "OK 0\n"); /* so these two have been read */
    reset(goes);
    await_info(&d, "clients", 3);
    say(stays, "CHECK t\n");
    CHECK(strncmp(hear_line(stays), "OK 0 delaunay=yes points=100000 ", 32) == 0);
    CHECK(strncmp(hear_line(busy), "OK 0 points=400000 ", 19) == 0);
    daemon_end(&d);
}
