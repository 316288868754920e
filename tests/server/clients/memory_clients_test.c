/* memory_clients_test.c - the memory of connections and replies is counted, and bounded when memory
 * is short: many clients, long requests, replies that nobody reads. Over a Unix socket, whose own
 * buffers are small. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#define MB ((size_t)1000 * 1000)

struct place {
    char path[64];
    struct daemon d;
};

static struct place begin(const char *max_memory)
{
    struct place p;
    snprintf(p.path, sizeof p.path, "/tmp/delaunayd-test-%d.sock", (int)getpid());
    const char *arguments[] = {"--max-memory", max_memory, "--unix", p.path, NULL};
    p.d = daemon_start(arguments);
    return p;
}

static void leave(const struct place *p)
{
    daemon_stop(&p->d, SIGKILL); /* it need not wait for clients that do not read */
    CHECK(unlink(p->path) == 0);
}

static int local_connect(const struct place *p)
{
    int fd = connect_unix(p->path);
    struct timeval patience = {.tv_usec = 200 * 1000};
    CHECK(fd >= 0 && setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience) == 0);
    return fd;
}

/* Sends as much as the other side accepts. */
static void send_what_goes(int fd, const char *bytes, size_t n)
{
    ssize_t sent = send(fd, bytes, n, MSG_NOSIGNAL);
    CHECK(sent >= 0 || errno == EAGAIN || errno == EPIPE || errno == ECONNRESET);
}

static void check_memory(const struct place *p, int fd, size_t limit)
{
    size_t peak = info_of(fd, "memory_peak"), resident = daemon_peak_resident(&p->d);
    CHECK_MSG(peak <= limit + limit / 16 + MB, "the budget was at %zu", peak);
    CHECK_MSG(test_is_sanitized() || resident <= limit + 12 * MB, "%zu bytes", resident);
    say(fd, "PING\nNEAREST small 0.9 0\n");
    expect(fd, "OK 0\nOK 1\n1 1 0 0.09999999999999998\n");
}

/* Requests, over and over, of which a client sends `bytes`. */
static char *repeated(const char *request, size_t bytes)
{
    size_t len = strlen(request);
    char *text = malloc(bytes);
    CHECK(text != NULL);
    for (size_t at = 0; at < bytes; at++)
        text[at] = request[at % len];
    return text;
}

TEST_TIMEOUT(idle_clients_are_counted, 60)
{
    enum { CLIENTS = 500 };
    struct place p = begin("64m");
    int fd[CLIENTS];
    await_info(&p.d, "clients", 1);
    pause_ms(100); /* until the connection that has asked for that is gone */
    uint64_t before = daemon_info(&p.d, "memory_clients");
    for (int i = 0; i < CLIENTS; i++)
        fd[i] = local_connect(&p);
    await_info(&p.d, "clients", CLIENTS + 1);
    uint64_t counted = daemon_info(&p.d, "memory_clients") - before;
    CHECK_MSG(counted >= CLIENTS * 400 && counted <= CLIENTS * 4000, "%zu", (size_t)counted);
    for (int i = 0; i < CLIENTS; i++)
        close(fd[i]);
    await_info(&p.d, "memory_clients", before);
    leave(&p);
}

TEST_TIMEOUT(replies_that_pile_up_stay_within_the_budget, 120)
{
    enum { CLIENTS = 300, BYTES = 200 * 1000, LIMIT = 8 << 20 };
    int clients = !test_is_sanitized() ? CLIENTS : 60; /* a sanitizer takes its time */
    struct place p = begin("8m");
    int other = daemon_connect(&p.d), fd[CLIENTS];
    say(other, "ADD small 0 0 1 0 0 1\nTRIANGULATE small\n");
    hear_line(other), hear_line(other);
    load_random(other, "t", 60);
    char *requests = repeated("POINTS t\n", BYTES);
    for (int i = 0; i < clients; i++) {
        fd[i] = local_connect(&p);
        send_what_goes(fd[i], requests, BYTES);
    }
    CHECK(info_of(other, "memory_clients") > 1 * MB || clients < CLIENTS);
    check_memory(&p, other, LIMIT);
    for (int i = 1; i < clients; i++)
        close(fd[i]);
    for (unsigned tries = 0; info_of(other, "clients") > 2; tries++, pause_ms(10))
        CHECK(tries < 500 * test_slowness());
    size_t n = 0; /* the remaining requests are answered as usual */
    char line[100];
    shutdown(fd[0], SHUT_WR);
    char *all = hear_all(fd[0], &n);
    const char *at = all, *end;
    for (size_t row = 0; (end = memchr(at, '\n', n - (size_t)(at - all))) != NULL; row++) {
        bool is_head = end - at == 5 && memcmp(at, "OK 60", 5) == 0;
        at = end + 1;
        CHECK(is_head == (row % 61 == 0) || at == all + n); /* the last request is cut off */
    }
    snprintf(line, sizeof line, "%zu", n);
    CHECK_MSG(n > 200 * 1000 && all[n - 1] == '\n', "%s", line);
    free(all);
    free(requests);
    leave(&p);
}

/* Whether the daemon has refused the client's request, or not even admitted it. */
static bool is_refused(int fd)
{
    char line[100];
    ssize_t got = recv(fd, line, sizeof line - 1, MSG_DONTWAIT | MSG_PEEK);
    if (got < 0)
        return errno == ECONNRESET;
    line[got] = '\0';
    CHECK_MSG(got == 0 || strncmp(line, "ERR BUSY ", 9) == 0, "%s", line);
    return true;
}

TEST_TIMEOUT(long_requests_that_do_not_end_stay_within_the_budget, 60)
{
    enum { CLIENTS = 400, BYTES = 60 * 1000, LIMIT = 8 << 20 };
    struct place p = begin("8m");
    int other = daemon_connect(&p.d), fd[CLIENTS], refused = 0;
    unsigned tries = 0;
    bool gone[CLIENTS] = {false};
    say(other, "ADD small 0 0 1 0 0 1\nTRIANGULATE small\n");
    hear_line(other), hear_line(other);
    char *request = repeated("GET small 1 1 1 ", BYTES);
    for (int i = 0; i < CLIENTS; i++) {
        fd[i] = local_connect(&p);
        send_what_goes(fd[i], request, BYTES);
    }
    check_memory(&p, other, LIMIT);
    for (; refused <= CLIENTS / 4; tries++, pause_ms(10)) {
        CHECK_MSG(tries < 1000 * test_slowness(), "%d refused", refused);
        for (int i = 0; i < CLIENTS; i++) {
            bool now = !gone[i] && is_refused(fd[i]);
            gone[i] |= now;
            refused += now;
        }
    }
    CHECK_MSG(refused < CLIENTS, "%d refused", refused);
    check_memory(&p, other, LIMIT);
    for (int i = 0; i < CLIENTS; i++)
        close(fd[i]);
    for (tries = 0; info_of(other, "clients") > 1; tries++, pause_ms(10))
        CHECK(tries < 500 * test_slowness());
    request[BYTES - 1] = 0;
    converse(&p.d, request, "ERR NUMBER GET is not an id\n"); /* there is room again */
    free(request);
    leave(&p);
}

/* Reads until the daemon closes the connection; one that was refused with unread input is reset. */
static void hear_to_the_end(int fd)
{
    char text[1000];
    ssize_t got;
    while ((got = recv(fd, text, sizeof text, 0)) > 0)
        ;
    CHECK_MSG(got == 0 || errno == ECONNRESET, "%s", strerror(errno));
}

/* One of them takes the last large buffer: when it was read there was room, afterwards there is
 * none, and no event of its own follows. */
TEST_TIMEOUT(a_long_request_that_takes_the_last_memory_is_heard_to_its_end, 60)
{
    enum { CLIENTS = 400, BYTES = 18 * 1000 };
    struct place p = begin("8m");
    int fd[CLIENTS];
    char *request = repeated("GET small 1 1 1 ", BYTES);
    for (int i = 0; i < CLIENTS; i++) {
        fd[i] = daemon_connect(&p.d);
        send_what_goes(fd[i], request, BYTES);
    }
    for (int i = 0; i < CLIENTS; i++)
        shutdown(fd[i], SHUT_WR);
    for (int i = 0; i < CLIENTS; i++) {
        hear_to_the_end(fd[i]);
        close(fd[i]);
    }
    await_info(&p.d, "clients", 1);
    free(request);
    leave(&p);
}

/* ---- long replies ---- */

/* `clients` clients send the request and read only the status line of the reply. Returns how many
 * are being answered; the others got an error about memory. */
static int begin_to_read(const struct place *p, int *fd, int clients, const char *request)
{
    int answered = 0;
    for (int i = 0; i < clients; i++) {
        fd[i] = local_connect(p);
        say(fd[i], request);
    }
    for (int i = 0; i < clients; i++) {
        const char *line = hear_line(fd[i]);
        bool refused = strncmp(line, "ERR BUSY ", 9) == 0;
        CHECK_MSG(refused || strncmp(line, "OK ", 3) == 0, "%s", line);
        answered += !refused;
    }
    return answered;
}

static void load_and_triangulate(int fd, uint32_t n)
{
    say(fd, "ADD small 0 0 1 0 0 1\nTRIANGULATE small\n");
    hear_line(fd), hear_line(fd);
    load_random(fd, "t", n);
    say(fd, "TRIANGULATE t\nNEAREST t 0 0\n");
    for (int i = 0; i < 3; i++)
        CHECK(strncmp(hear_line(fd), "ERR", 3) != 0);
}

TEST_TIMEOUT(results_of_searches_that_are_read_slowly_are_counted_and_bounded, 120)
{
    enum { CLIENTS = 60, POINTS = 200000, LIMIT = 64 << 20 };
    struct place p = begin("64m");
    int other = daemon_connect(&p.d), fd[CLIENTS];
    load_and_triangulate(other, POINTS);
    size_t before = info_of(other, "memory_replies");
    int answered = begin_to_read(&p, fd, CLIENTS, "WITHIN t -1 -1 2 2\n");
    CHECK_MSG(answered >= 10 && answered < CLIENTS, "%d", answered);
    CHECK(info_of(other, "memory_replies") - before >= (size_t)answered * POINTS * 4);
    check_memory(&p, other, LIMIT);
    for (int i = 0; i < CLIENTS; i++)
        close(fd[i]);
    for (unsigned tries = 0; info_of(other, "memory_replies") > before; tries++, pause_ms(10))
        CHECK(tries < 500 * test_slowness());
    say(other, "NEAREST t 0.5 0.5 200000\n");
    CHECK_STR(hear_line(other), "OK 200000");
    leave(&p);
}

TEST_TIMEOUT(nearest_points_that_do_not_fit_are_refused_while_they_are_searched, 60)
{
    struct place p = begin("64m");
    int fd = daemon_connect(&p.d);
    load_and_triangulate(fd, 200000);
    say(fd, "CONFIG SET max-memory 26m\nNEAREST t 0.5 0.5 200000\nPING\n");
    expect(fd, "OK 0\n");
    CHECK_STR(hear_line(fd),
              "ERR BUSY not enough free memory for the reply at the moment; try again");
    expect(fd, "OK 0\n");
    CHECK(info_of(fd, "memory_replies") == 0);
    leave(&p);
}

TEST_TIMEOUT(many_readers_of_whole_sets_who_stall_stay_within_the_budget, 120)
{
    enum { CLIENTS = 300, POINTS = 100000, LIMIT = 64 << 20 };
    struct place p = begin("64m");
    int other = daemon_connect(&p.d), fd[CLIENTS];
    load_and_triangulate(other, POINTS);
    int answered = begin_to_read(&p, fd, CLIENTS, "LISTS t\n");
    CHECK_MSG(answered >= 50 && answered < CLIENTS, "%d", answered);
    check_memory(&p, other, LIMIT);
    for (int i = 0; i < CLIENTS; i++)
        close(fd[i]);
    for (unsigned tries = 0; info_of(other, "memory_replies") > 0; tries++, pause_ms(10))
        CHECK(tries < 500 * test_slowness());
    say(other, "LISTS t\n");
    CHECK(strncmp(hear_line(other), "OK 100000 ", 10) == 0);
    leave(&p);
}
