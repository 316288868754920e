/* hostile_test.c - clients that are slow, silent or without a token, and how they affect others. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- what others notice ---- */

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median time of a PING: single times depend more on the machine than on the daemon. */
static double median_ping_ms(int fd)
{
    enum { PINGS = 101 };
    double ms[PINGS];
    for (int i = 0; i < PINGS; i++) {
        double start = seconds();
        say(fd, "PING\n");
        expect(fd, "OK 0\n");
        ms[i] = 1000 * (seconds() - start);
    }
    qsort(ms, PINGS, sizeof ms[0], ascending);
    return ms[PINGS / 2];
}

/* Reactors that all have work take turns on the processors: the longest time of a PING, in ms. */
static double patience_ms(int fd)
{
    enum { MOST_MS = 5 };
    unsigned n = 0, lines = 0;
    double reactors = 1, processors = (double)sysconf(_SC_NPROCESSORS_ONLN);
    say(fd, "INFO server\n");
    CHECK(sscanf(hear_line(fd), "OK %u", &lines) == 1);
    while (lines-- > 0)
        if (sscanf(hear_line(fd), "reactors:%u", &n) == 1)
            reactors = n;
    return MOST_MS * test_slowness() * (reactors > processors ? reactors / processors : 1);
}

static void expect_no_delay(int fd)
{
    double ms = median_ping_ms(fd);
    if (!test_is_sanitized())
        CHECK_MSG(ms < patience_ms(fd), "a PING takes %.2f ms", ms);
}

TEST_TIMEOUT(clients_that_read_a_large_reply_slowly_delay_nobody, 60)
{
    enum { READERS = 20, SIPS = 30 };
    static char sip[20000];
    int reader[READERS];
    struct daemon d = daemon_start(NULL);
    int other = daemon_connect(&d);
    load_random(other, "t", 100000);
    say(other, "TRIANGULATE t\n");
    hear_line(other);
    for (int i = 0; i < READERS; i++) {
        reader[i] = daemon_connect(&d);
        say(reader[i], "LISTS t\nLISTS t\n");
    }
    for (int i = 0; i < SIPS; i++)
        CHECK(recv(reader[i % READERS], sip, sizeof sip, 0) > 0);
    expect_no_delay(other);
}

TEST(clients_that_send_a_byte_at_a_time_delay_nobody)
{
    enum { CLIENTS = 300 };
    static const char request[] = "LOCATE none 1 2\n";
    int slow[CLIENTS];
    struct daemon d = daemon_start(NULL);
    int other = daemon_connect(&d);
    for (int i = 0; i < CLIENTS; i++)
        slow[i] = daemon_connect(&d);
    for (size_t at = 0; at < sizeof request - 1; at++) {
        for (int i = 0; i < CLIENTS; i++)
            say_bytes(slow[i], request + at, 1);
        say(other, "PING\n");
        expect(other, "OK 0\n");
    }
    for (int i = 0; i < CLIENTS; i++)
        expect(slow[i], "ERR NOSET there is no set none\n");
    expect_no_delay(other);
}

TEST(request_that_takes_long_is_answered_after_half_close)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 300000);
    say(fd, "TRIANGULATE t METHOD shelling\nNEAREST t 2 2\nCHECK t");
    shutdown(fd, SHUT_WR);
    CHECK(strncmp(hear_line(fd), "OK 0 points=300000 coincident=0 ", 32) == 0);
    CHECK_STR(hear_line(fd), "OK 1");
    hear_line(fd);
    CHECK(strncmp(hear_line(fd), "OK 0 delaunay=yes points=300000 ", 32) == 0);
    expect_end(fd);
}

TEST(client_that_never_stops_sending_delays_nobody)
{
    static char block[64 * 1024];
    struct daemon d = daemon_start(NULL);
    int flood = daemon_connect(&d), other = daemon_connect(&d);
    memset(block, '\n', sizeof block);
    for (size_t i = 0; i + 5 <= sizeof block; i += 5)
        memcpy(block + i, "PING\n", 5);
    for (int i = 0; i < 200; i++) {
        ssize_t n = send(flood, block, sizeof block, MSG_DONTWAIT | MSG_NOSIGNAL);
        CHECK(n > 0 || errno == EAGAIN);
        say(other, "PING\n");
        expect(other, "OK 0\n");
    }
    expect_no_delay(other);
}

TEST(client_that_keeps_sending_after_its_last_reply_is_closed)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "QUIT\n");
    expect(fd, "OK 0\n");
    expect_end(fd);
    double start = seconds();
    while (send(fd, "x", 1, MSG_NOSIGNAL) == 1) {
        CHECK_MSG(seconds() - start < 10, "it may still send");
        pause_ms(50);
    }
    CHECK(errno == EPIPE || errno == ECONNRESET);
    CHECK(seconds() - start > 1); /* not at once, which could take the last reply with it */
    CHECK(daemon_info(&d, "clients") == 1);
}

/* Sends requests on all connections without waiting, and reads the replies, until killed. */
static pid_t flood_on(const struct daemon *d, int connections, const char *request)
{
    enum { MOST = 64, BLOCK = 64 * 1024 };
    static char block[BLOCK], sink[1 << 18];
    struct pollfd p[MOST];
    size_t len = strlen(request), whole = BLOCK / len * len, sent[MOST] = {0};
    pid_t pid = fork();
    CHECK(pid >= 0 && connections <= MOST);
    if (pid > 0)
        return pid;
    for (size_t at = 0; at < whole; at += len)
        memcpy(block + at, request, len);
    for (int i = 0; i < connections; i++)
        p[i] = (struct pollfd){.fd = daemon_connect(d), .events = POLLIN | POLLOUT};
    while (poll(p, (nfds_t)connections, -1) > 0) {
        for (int i = 0; i < connections; i++) {
            ssize_t n = 0;
            if ((p[i].revents & POLLIN) != 0 && recv(p[i].fd, sink, sizeof sink, MSG_DONTWAIT) <= 0)
                _exit(0);
            if ((p[i].revents & POLLOUT) != 0)
                n = send(p[i].fd, block + sent[i], whole - sent[i], MSG_DONTWAIT | MSG_NOSIGNAL);
            sent[i] = n > 0 ? (sent[i] + (size_t)n) % whole : sent[i];
        }
    }
    _exit(0);
}

TEST_TIMEOUT(clients_with_pipelines_that_never_end_delay_nobody, 60)
{
    static const char *const request[] = {"PING\n", "INFO\n", "SETS\n",
                                          "*2\r\n$4\r\nECHO\r\n$4\r\nnews\r\n"};
    for (size_t i = 0; i < sizeof request / sizeof request[0]; i++) {
        struct daemon d = daemon_start(NULL);
        int other = daemon_connect(&d);
        pid_t flood = flood_on(&d, 50, request[i]);
        pause_ms(300);
        expect_no_delay(other);
        kill(flood, SIGKILL);
        CHECK(waitpid(flood, NULL, 0) == flood);
        daemon_end(&d);
    }
}

/* ---- TIMEOUT ---- */

TEST_TIMEOUT(request_that_exceeds_its_timeout_is_cancelled_and_others_are_not, 60)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), waiting = daemon_connect(&d);
    load_random(fd, "t", 300000);
    say(fd, "TRIANGULATE t\n");
    hear_line(fd);
    say(fd, "TIMEOUT 60 STAT t\nTIMEOUT 0 PING\nTIMEOUT 1 TIMEOUT 1 PING\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=300000 ", 19) == 0);
    for (int i = 0; i < 2; i++)
        CHECK(strncmp(hear_line(fd), "ERR SYNTAX ", 11) == 0);
    say(fd, "TRIANGULATE t METHOD shelling\n");
    say(waiting, "TIMEOUT 0.001 TRIANGULATE t METHOD divide\nPING\n");
    CHECK_STR(hear_line(waiting), "ERR TIMEOUT the request took too long; nothing has changed");
    CHECK_STR(hear_line(waiting), "OK 0");
    CHECK(strncmp(hear_line(fd), "OK 0 points=300000 ", 19) == 0);
}

/* ---- strangers: clients without a token ---- */

static struct daemon start_with_token(const char *token)
{
    char path[] = "/tmp/delaunayd-test-XXXXXX";
    const char *arguments[] = {"--auth-file", path, NULL};
    int file = mkstemp(path);
    CHECK(file >= 0 && write(file, token, strlen(token)) == (ssize_t)strlen(token));
    close(file);
    struct daemon d = daemon_start(arguments);
    unlink(path);
    return d;
}

static const char too_much[] = "ERR TOOLONG before AUTH a request has at most 10 words and 16384 "
                               "bytes\n";

TEST(strangers_may_send_ten_words)
{
    struct daemon d = start_with_token("rw secret\n");
    converse(&d, "GET t 1 2 3 4 5 6 7 8\nPING\n",
             "ERR NOAUTH authenticate first: AUTH token\nOK 0\n");
    converse(&d, "GET t 1 2 3 4 5 6 7 8 9\nPING\n", too_much);
    converse(&d, "AUTH secret\nGET t 1 2 3 4 5 6 7 8 9\n",
             "OK 0 role=rw\nERR NOSET there is no set t\n");
}

TEST(strangers_may_send_16_kib)
{
    enum { LIMIT = 16 * 1024 };
    static char line[LIMIT + 64], known[LIMIT + 128];
    struct daemon d = start_with_token("rw secret\n");
    memset(line, ' ', LIMIT + 1);
    memcpy(line, "PING", 4);
    line[LIMIT - 1] = '\n';
    line[LIMIT] = '\0';
    converse(&d, line, "OK 0\n");
    line[LIMIT - 1] = ' ';
    strcpy(line + LIMIT, "\n");
    converse(&d, line, too_much);
    snprintf(known, sizeof known, "AUTH secret\n%s", line);
    converse(&d, known, "OK 0 role=rw\nOK 0\n");

    /* Nothing is kept of a line that does not end, nor of a bulk string that is announced. */
    int fd = daemon_connect(&d);
    memset(line, 'x', LIMIT + 1);
    say_bytes(fd, line, LIMIT + 1);
    expect(fd, too_much);
    expect_end(fd);
    fd = daemon_connect(&d);
    say(fd, "*2\r\n$4\r\nECHO\r\n$100000\r\nxxxx");
    expect(fd, "-TOOLONG before AUTH a request has at most 10 words and 16384 bytes\r\n");
    expect_end(fd);
}

TEST_TIMEOUT(strangers_have_ten_seconds, 40)
{
    struct daemon d = start_with_token("rw secret\n");
    int known = daemon_connect(&d), stranger = daemon_connect(&d);
    say(known, "AUTH secret\n");
    expect(known, "OK 0 role=rw\n");
    double start = seconds();
    say(stranger, "PING\nAUTH secr");
    expect(stranger, "OK 0\nERR TIMEOUT not authenticated within 10 seconds\n");
    CHECK(seconds() - start > 9);
    expect_end(stranger);
    say(known, "PING\n");
    expect(known, "OK 0\n");
}

TEST_TIMEOUT(idle_timeout_disconnects_silent_clients_and_not_busy_ones, 40)
{
    const char *arguments[] = {"--idle-timeout", "2", NULL};
    struct daemon d = daemon_start(arguments);
    int busy = daemon_connect(&d), loading = daemon_connect(&d), silent = daemon_connect(&d);
    say(loading, "LOAD t\n1 1\n");
    for (int i = 0; i < 8; i++) {
        say(busy, "PING\n");
        expect(busy, "OK 0\n");
        pause_ms(500);
    }
    expect(silent, "ERR TIMEOUT idle for too long\n");
    expect_end(silent);
    expect(loading, "ERR TIMEOUT idle for too long\n");
    expect_end(loading);
    close(silent);
    close(loading);
    await_info(&d, "loading", 0);
    say(busy, "SETS\n");
    expect(busy, "OK 0\n");
}

/* ---- many clients: make faults ---- */

/* Allows n descriptors for the test and, inherited, for the daemon; otherwise skips the test. */
static void need_descriptors(rlim_t n)
{
    struct rlimit limit;
    if (getenv("FAULTS") == NULL)
        SKIP("only make faults has thousands of clients");
    CHECK(getrlimit(RLIMIT_NOFILE, &limit) == 0);
    if (limit.rlim_max < n)
        SKIP("this machine allows only %ju open files", (uintmax_t)limit.rlim_max);
    limit.rlim_cur = n;
    CHECK(setrlimit(RLIMIT_NOFILE, &limit) == 0);
}

/* The resident memory without the page cache, which the daemon may give back at any time. */
static size_t resident_in_use(const struct daemon *d)
{
    uint64_t kept = daemon_info(d, "memory_kept");
    return daemon_resident(d) - (size_t)kept;
}

TEST_TIMEOUT(thousand_readers_that_stall_cost_a_third_of_a_mib_each_and_no_time, 300)
{
    enum { READERS = 1000 };
    static int fd[READERS];
    need_descriptors(READERS + 200);
    struct daemon d = daemon_start(NULL);
    int first = daemon_connect(&d);
    load_random(first, "t", 1000000); /* whose LISTS are 50 MB long */
    say(first, "TRIANGULATE t\n");
    hear_line(first);
    size_t before = resident_in_use(&d);
    for (int i = 0; i < READERS; i++) {
        fd[i] = daemon_connect(&d);
        say(fd[i], "LISTS t\n");
    }
    double cpu;
    for (int i = 0; i < 60; i++) { /* until the system's own buffers are full */
        cpu = daemon_cpu_seconds(&d);
        pause_ms(1000);
        if (daemon_cpu_seconds(&d) - cpu < 0.03)
            break;
    }
    size_t now = resident_in_use(&d), more = now - before;
    CHECK_MSG(now < before || more < ((size_t)READERS << 20) / 3, "%zu MiB more", more >> 20);
    cpu = daemon_cpu_seconds(&d);
    pause_ms(5000);
    cpu = daemon_cpu_seconds(&d) - cpu;
    CHECK_MSG(cpu < 0.15, "%.2f s in 5 s for readers that stall", cpu);
    printf("1000 stalled readers of LISTS: %zu MiB more, %.1f %% of a processor\n", more >> 20,
           cpu * 20);
    expect_no_delay(first);
}

TEST_TIMEOUT(ten_thousand_idle_clients_use_4_kib_each, 120)
{
    enum { CLIENTS = 9900 };
    static int fd[CLIENTS];
    need_descriptors(CLIENTS + 200);
    struct daemon d = daemon_start(NULL);
    fd[0] = daemon_connect(&d);
    size_t before = daemon_resident(&d);
    for (int i = 1; i < CLIENTS; i++) {
        fd[i] = daemon_connect(&d);
        say(fd[i], "PING\n");
        expect(fd[i], "OK 0\n");
    }
    size_t each = (daemon_resident(&d) - before) / CLIENTS;
    CHECK_MSG(each < 4096, "%zu bytes each", each);
    printf("%d idle clients: %zu bytes each\n", CLIENTS, each);
    expect_no_delay(fd[0]);
}
