/* concurrency_test.c - several clients at once: heavy and light requests, readers and writers. */
#include "proto/reply_read.h"
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static bool has_answered(int fd)
{
    char c;
    return recv(fd, &c, 1, MSG_PEEK | MSG_DONTWAIT) == 1;
}

TEST(two_clients_share_a_set)
{
    struct daemon d = daemon_start(NULL);
    int a = daemon_connect(&d), b = daemon_connect(&d);
    say(a, "ADD t 1 2\n");
    expect(a, "OK 0 first=0 added=1 coincident=0\n");
    say(b, "GET t 0\nMOVE t 0 3 4\n");
    expect(b, "OK 1\n0 1 2\nOK 0\n");
    say(a, "GET t 0\n");
    expect(a, "OK 1\n0 3 4\n");
}

TEST(ping_is_answered_while_a_large_set_is_triangulated)
{
    struct daemon d = daemon_start(NULL);
    int busy = daemon_connect(&d), idle = daemon_connect(&d);
    unsigned answered = 0;
    load_random(busy, "t", 400000);
    say(busy, "TRIANGULATE t METHOD shelling\n");
    while (!has_answered(busy)) {
        say(idle, "PING\n");
        expect(idle, "OK 0\n");
        answered += !has_answered(busy);
    }
    CHECK_MSG(answered >= (!test_is_sanitized() ? 10 : 1), "only %u answers", answered);
    CHECK(strncmp(hear_line(busy), "OK 0 points=400000 coincident=0 ", 32) == 0);
}

TEST(points_are_read_while_their_set_is_triangulated)
{
    struct daemon d = daemon_start(NULL);
    int busy = daemon_connect(&d), reader = daemon_connect(&d);
    bool during = false;
    load_random(busy, "t", 400000);
    say(busy, "TRIANGULATE t METHOD shelling\n");
    while (!has_answered(busy)) {
        say(reader, "GET t 7\n");
        CHECK(strcmp(hear_line(reader), "OK 1") == 0);
        hear_line(reader);
        during = during || !has_answered(busy);
    }
    CHECK(during);
}

/* Sends LOADB of n random points, and returns when a worker has begun to add them. */
static void begin_to_load(const struct daemon *d, int fd, unsigned n)
{
    char text[64];
    double *xy = malloc(2 * n * sizeof *xy);
    CHECK(xy != NULL);
    for (unsigned i = 0; i < 2 * n; i++)
        xy[i] = test_uniform();
    uint64_t jobs = daemon_info(d, "jobs");
    snprintf(text, sizeof text, "LOADB t %u\n", n);
    say(fd, text);
    say_bytes(fd, xy, 2 * n * sizeof *xy);
    free(xy);
    while (daemon_info(d, "jobs") == jobs && !has_answered(fd))
        pause_ms(1);
}

TEST(set_that_is_queried_is_read_while_a_large_load_is_added)
{
    struct daemon d = daemon_start(NULL);
    int busy = daemon_connect(&d), reader = daemon_connect(&d);
    unsigned during = 0;
    load_random(busy, "t", 400000);
    say(busy, "TRIANGULATE t\n");
    hear_line(busy);
    say(reader, "NEAREST t 0.5 0.5\n");
    CHECK(strcmp(hear_line(reader), "OK 1") == 0);
    hear_line(reader);
    begin_to_load(&d, busy, 100000);
    while (!has_answered(busy)) {
        say(reader, "GET t 7\nNEAREST t 0.5 0.5\n");
        for (int i = 0; i < 2; i++) {
            CHECK(strcmp(hear_line(reader), "OK 1") == 0);
            hear_line(reader);
        }
        during += !has_answered(busy);
    }
    CHECK(strncmp(hear_line(busy), "OK 0 first=400000 added=100000 ", 31) == 0);
    CHECK(during > 0);
    say(reader, "STAT t\nCHECK t\n");
    CHECK(strstr(hear_line(reader), "points=500000 ") != NULL);
    CHECK(strncmp(hear_line(reader), "OK 0 delaunay=yes points=500000 ", 32) == 0);
    daemon_end(&d);
}

TEST(many_points_are_added_to_an_empty_set_that_is_queried)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "CREATE t\nTRIANGULATE t\nHULL t\n");
    hear_line(fd);
    hear_line(fd);
    CHECK(strcmp(hear_line(fd), "OK 0") == 0);
    begin_to_load(&d, fd, 3000);
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=3000 ", 24) == 0);
    say(fd, "CHECK t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 delaunay=yes points=3000 ", 30) == 0);
    daemon_end(&d);
}

/* Returns how many ADD requests have waited. */
static unsigned adds_that_waited(int fd)
{
    unsigned rows, waits = 0;
    say(fd, "INFO commands\n");
    CHECK(sscanf(hear_line(fd), "OK %u", &rows) == 1);
    for (unsigned i = 0; i < rows; i++) {
        const char *line = hear_line(fd), *at = strstr(line, "waits=");
        if (strncmp(line, "command_ADD:", 12) == 0 && at != NULL)
            waits = (unsigned)strtoul(at + 6, NULL, 10);
    }
    return waits;
}

TEST(pipelines_that_wait_for_a_set_wait_once_and_not_per_request)
{
    enum { CLIENTS = 8, ADDS = 200 };
    struct daemon d = daemon_start(NULL);
    int busy = daemon_connect(&d), fd[CLIENTS];
    load_random(busy, "t", 100000);
    say(busy, "TRIANGULATE t METHOD shelling\n");
    for (int i = 0; i < CLIENTS; i++) {
        char text[ADDS * 20], *to = text;
        fd[i] = daemon_connect(&d);
        for (int n = 0; n < ADDS; n++)
            to += snprintf(to, 20, "ADD t %d %d\n", i + 2, n);
        say(fd[i], text);
    }
    CHECK(strncmp(hear_line(busy), "OK 0 points=100000 ", 19) == 0);
    for (int i = 0; i < CLIENTS; i++)
        for (int n = 0; n < ADDS; n++)
            CHECK(strncmp(hear_line(fd[i]), "OK 0 first=", 11) == 0);
    unsigned waited = adds_that_waited(busy);
    CHECK_MSG(waited < CLIENTS * ADDS / 4, "%u of %d", waited, CLIENTS * ADDS);
}

TEST(requests_after_a_heavy_one_are_answered_in_order)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 100000);
    say(fd, "PING\nTRIANGULATE t\nGET t\nLISTS t 5\nCHECK t\nADD t 9 9\nNEAREST t 9 9\nFOO\n");
    expect(fd, "OK 0\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=100000 ", 19) == 0);
    expect(fd, "ERR SYNTAX usage: GET set id [id ...]\nOK 1 interior=1 boundary=0\n5 ");
    hear_line(fd);
    CHECK(strncmp(hear_line(fd), "OK 0 delaunay=yes points=100000 ", 32) == 0);
    expect(fd, "OK 0 first=100000 added=1 coincident=0\nOK 1\n100000 9 9 0\nERR UNKNOWN there is "
               "no command FOO; try HELP\n");
}

TEST(writers_of_a_set_take_turns)
{
    enum { CLIENTS = 6, ROUNDS = 50, LARGE = 300 };
    struct daemon d = daemon_start(NULL);
    int fd[CLIENTS];
    unsigned total = 0;
    char large[LARGE * 8 + 100], small[] = "ADD t 0.5 0.5\n";
    size_t n = (size_t)sprintf(large, "ADD t");
    for (int i = 0; i < LARGE; i++)
        n += (size_t)sprintf(large + n, " %d 0", i);
    strcpy(large + n, "\n");
    for (int i = 0; i < CLIENTS; i++)
        fd[i] = daemon_connect(&d);
    for (int r = 0; r < ROUNDS; r++)
        for (int i = 0; i < CLIENTS; i++)
            say(fd[i], (r + i) % 2 ? large : small);
    for (int i = 0; i < CLIENTS; i++) {
        long last = -1;
        for (int r = 0; r < ROUNDS; r++) {
            long first, added;
            CHECK(sscanf(hear_line(fd[i]), "OK 0 first=%ld added=%ld", &first, &added) == 2);
            CHECK(first > last && added == ((r + i) % 2 ? LARGE : 1));
            last = first;
            total += (unsigned)added;
        }
    }
    say(fd[0], "STAT t\n");
    unsigned points;
    CHECK(sscanf(hear_line(fd[0]), "OK 0 points=%u", &points) == 1 && points == total);
}

/* ---- streams ---- */

/* The whole reply to a request on a connection of its own. */
static char *whole_reply(const struct daemon *d, const char *request, size_t *n)
{
    int fd = daemon_connect(d);
    say(fd, request);
    shutdown(fd, SHUT_WR);
    char *text = hear_all(fd, n);
    close(fd);
    return text;
}

TEST(reply_that_is_being_sent_shows_one_version_during_edits)
{
    static const char *const edits[] = {
        "ADD t 0.5 0.5 0.25 0.25\n",     "DEL t 1 2 3\n", "MOVE t 9 7 7\n",
        "TRIANGULATE t METHOD divide\n", "LISTS t 5\n",   "DROP t\n"};
    size_t want_n, got_n;
    struct daemon d = daemon_start(NULL);
    int writer = daemon_connect(&d), reader = daemon_connect(&d);
    load_random(writer, "t", 150000);
    say(writer, "TRIANGULATE t\n");
    hear_line(writer);
    char *want = whole_reply(&d, "LISTS t\n", &want_n);
    CHECK(want_n > 6000000);
    say(reader, "LISTS t\n");
    shutdown(reader, SHUT_WR);
    expect(reader, "OK 150000 interior=");
    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
        say(writer, edits[i]);
        CHECK(strncmp(hear_line(writer), "OK ", 3) == 0);
        if (i == 4)
            hear_line(writer);
    }
    char *got = hear_all(reader, &got_n);
    CHECK(got_n == want_n - 19 && memcmp(got, want + 19, got_n) == 0);
    free(got);
    free(want);
}

TEST(slow_reader_gets_the_whole_reply_after_half_close)
{
    size_t n;
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 200000);
    say(fd, "TRIANGULATE t\n");
    hear_line(fd);
    say(fd, "LISTS t");
    shutdown(fd, SHUT_WR);
    pause_ms(500);
    double cpu = daemon_cpu_seconds(&d);
    pause_ms(1500);
    cpu = daemon_cpu_seconds(&d) - cpu;
    if (!test_is_sanitized())
        CHECK_MSG(cpu < 0.1, "%.2f s of work for a reader that sleeps", cpu);
    char *text = hear_all(fd, &n);
    size_t lines = 0;
    for (size_t i = 0; i < n; i++)
        lines += text[i] == '\n';
    CHECK(lines == 200001 && text[n - 1] == '\n');
    free(text);
}

/* Waits until the daemon has sent all bytes that the sockets accept; fails if it never stops sending. */
static void wait_until_quiet(const struct daemon *d)
{
    for (int i = 0; i < 150; i++) {
        double cpu = daemon_cpu_seconds(d);
        pause_ms(300);
        if (daemon_cpu_seconds(d) - cpu < 0.02 || test_is_sanitized())
            return;
    }
    test_fail(__FILE__, __LINE__, "the daemon is busy for readers that stall");
}

/* 220 to 380 KiB each were measured, more on a busy machine; a whole reply has megabytes. */
TEST_TIMEOUT(readers_that_stall_cost_little_memory, 60)
{
    enum { READERS = 100 };
    int fd[READERS];
    struct daemon d = daemon_start(NULL);
    int first = daemon_connect(&d);
    load_random(first, "t", 200000);
    say(first, "TRIANGULATE t\n");
    hear_line(first);
    size_t before = daemon_resident(&d);
    for (int i = 0; i < READERS; i++) {
        fd[i] = daemon_connect(&d);
        say(fd[i], "LISTS t\nTRIANGLES t\nPOINTS t\n");
    }
    wait_until_quiet(&d);
    size_t after = daemon_resident(&d);
    if (!test_is_sanitized())
        CHECK_MSG(after < before + (size_t)READERS * 500 * 1024, "%zu KiB more",
                  (after - before) / 1024);
    say(first, "PING\n");
    expect(first, "OK 0\n");
}

TEST(binary_tables_are_as_long_as_announced)
{
    static const char *const requests[] = {"LISTS t BINARY\n", "TRIANGLES t CW BINARY\n",
                                           "EDGES t BINARY\n", "POINTS t BINARY\n"};
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 50000);
    say(fd, "TRIANGULATE t\n");
    hear_line(fd);
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++) {
        size_t n, bytes;
        char *text = whole_reply(&d, requests[i], &n);
        char *at = strstr(text, " bytes=");
        CHECK(at != NULL && sscanf(at, " bytes=%zu", &bytes) == 1 && bytes > 500000);
        CHECK_MSG(n == (size_t)(strchr(text, '\n') + 1 - text) + bytes, "%s", requests[i]);
        free(text);
    }
}

TEST(points_come_back_as_they_were_loaded)
{
    enum { POINTS = 50000 };
    size_t n, at = 0, want_at;
    struct daemon d = daemon_start(NULL);
    char *load = malloc(POINTS * 40 + 100), *want = malloc(POINTS * 40 + 100);
    CHECK(load != NULL && want != NULL);
    at += (size_t)sprintf(load, "LOAD t\n");
    want_at = (size_t)sprintf(want, "OK 0 first=0 added=%d coincident=0\nOK %d\n", POINTS, POINTS);
    for (int i = 0; i < POINTS; i++) {
        at += (size_t)sprintf(load + at, "%d.25 -0.%d1\n", i, i);
        want_at += (size_t)sprintf(want + want_at, "%d %d.25 -0.%d1\n", i, i, i);
    }
    strcpy(load + at, ".\nPOINTS t\n");
    char *got = whole_reply(&d, load, &n);
    CHECK_STR(got, want);
    free(got);
    free(want);
    free(load);
}

TEST_TIMEOUT(heavy_requests_wait_with_progress_comments_until_there_are_too_many, 60)
{
    enum { CLIENTS = 90 };
    const char *arguments[] = {"--threads", "1", NULL};
    struct daemon d = daemon_start(arguments);
    int fd[CLIENTS], fine = 0, busy = 0, comments = 0;
    char text[100];
    for (int i = 0; i < CLIENTS; i++) {
        fd[i] = daemon_connect(&d);
        sprintf(text, "s%d", i);
        load_random(fd[i], text, 1000);
    }
    load_random(fd[0], "t",
                !test_is_sanitized() ? 1000000 : 50000); /* a sanitizer takes its time */
    double start = seconds();
    for (int i = 0; i < CLIENTS; i++) { /* the only worker has the first one to do */
        sprintf(text, i == 0 ? "TRIANGULATE t METHOD shelling\n" : "TRIANGULATE s%d\n", i);
        say(fd[i], text);
        shutdown(fd[i], SHUT_WR);
        if (i == 0)
            await_info(&d, "jobs_running", 1);
    }
    for (int i = 0; i < CLIENTS; i++) {
        size_t n;
        char *reply = hear_all_and_comments(fd[i], &n), *at = reply;
        for (; strncmp(at, "# progress ", 11) == 0; at = strchr(at, '\n') + 1)
            comments++;
        fine += strncmp(at, "OK ", 3) == 0;
        busy += strncmp(at, "ERR BUSY ", 9) == 0;
        free(reply);
    }
    CHECK_MSG(fine >= 64 && busy > 0 && fine + busy == CLIENTS, "%d answered, %d refused", fine,
              busy);
    CHECK(comments > 0 || seconds() - start < 2); /* a fast machine has nothing to report */
}

TEST_TIMEOUT(request_that_waits_for_a_set_gets_the_progress_of_what_it_waits_for, 60)
{
    const char *arguments[] = {"--threads", "1", NULL};
    struct daemon d = daemon_start(arguments);
    int busy = daemon_connect(&d), waits = daemon_connect(&d);
    load_random(busy, "t", !test_is_sanitized() ? 1500000 : 50000);
    double start = seconds();
    say(busy, "TRIANGULATE t METHOD shelling\n");
    await_info(&d, "jobs_running", 1);
    say(waits, "TRIANGULATE t METHOD shelling\n");
    shutdown(waits, SHUT_WR);
    size_t n;
    char *reply = hear_all_and_comments(waits, &n);
    CHECK_MSG(strstr(reply, "OK 0 points=") != NULL, "%s", reply);
    CHECK_MSG(strncmp(reply, "# progress ", 11) == 0 || seconds() - start < 2, "%s", reply);
    free(reply);
    CHECK(strncmp(hear_line(busy), "OK 0 points=", 12) == 0);
    daemon_end(&d);
}

/* ---- pipelines ---- */

enum { PIPELINE = 100000 };

static void *say_pipeline(void *arg)
{
    char *text = malloc(PIPELINE * 16), *to = text;
    for (int i = 0; i < PIPELINE; i++)
        to += i % 4 == 0 ? sprintf(to, "PING\n") : sprintf(to, "GET t %d\n", i % 1000);
    say_bytes(*(int *)arg, text, (size_t)(to - text));
    shutdown(*(int *)arg, SHUT_WR);
    free(text);
    return NULL;
}

static void hear_pipeline(int fd)
{
    char want[64];
    size_t n;
    char *text = hear_all(fd, &n), *at = text;
    for (int i = 0; i < PIPELINE; i++) {
        int id = i % 1000;
        size_t len = (size_t)(i % 4 == 0 ? sprintf(want, "OK 0\n")
                                         : sprintf(want, "OK 1\n%d %d %d\n", id, id, -id));
        CHECK_MSG(strncmp(at, want, len) == 0, "reply %d: %.64s", i, at);
        at += len;
    }
    CHECK(at == text + n);
    free(text);
}

TEST_TIMEOUT(pipelines_of_100000_requests_are_answered_in_order, 60)
{
    pthread_t talker[2];
    int fd[2];
    struct daemon d = daemon_start(NULL);
    fd[0] = daemon_connect(&d);
    fd[1] = daemon_connect(&d);
    for (int i = 0; i < 1000; i++) {
        char add[64];
        sprintf(add, "ADD t %d %d\n", i, -i);
        say(fd[0], add);
        hear_line(fd[0]);
    }
    for (int i = 0; i < 2; i++)
        CHECK(pthread_create(&talker[i], NULL, say_pipeline, &fd[i]) == 0);
    pause_ms(
        300); /* the requests are larger than the sockets' buffers: the daemon must stop reading, not use more memory */
    for (int i = 0; i < 2; i++)
        hear_pipeline(fd[i]);
    for (int i = 0; i < 2; i++)
        pthread_join(talker[i], NULL);
}

TEST(client_that_sends_and_never_reads_costs_little_memory)
{
    static char block[64 * 1024];
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    size_t sent = 0;
    for (size_t i = 0; i + 5 <= sizeof block; i += 5)
        memcpy(block + i, "HELP\n", 5);
    size_t before = daemon_resident(&d);
    for (double start = seconds(); seconds() - start < 1;) {
        ssize_t n = send(fd, block, sizeof block - 1, MSG_DONTWAIT | MSG_NOSIGNAL);
        sent += n > 0 ? (size_t)n : 0;
        CHECK(n > 0 || errno == EAGAIN);
        if (n < 0)
            pause_ms(20);
    }
    CHECK_MSG(sent < 100u << 20, "%zu MiB were taken", sent >> 20);
    if (!test_is_sanitized())
        CHECK(daemon_resident(&d) < before + (4 << 20));
    converse(&d, "PING\n", "OK 0\n");
}

/* ---- everything at once ---- */

static const struct daemon *stressed;
static atomic_bool stress_over;

/* Reads the replies to `n` requests; each must be well formed, an error or not. */
static void frame_replies(int fd, int n)
{
    static _Thread_local char bytes[1 << 16];
    struct reply_reader reader = {0};
    size_t have = 0;
    while (n > 0) {
        ssize_t r = recv(fd, bytes + have, sizeof bytes - have, 0);
        CHECK(r > 0);
        have += (size_t)r;
        struct reply_part part;
        ptrdiff_t used;
        size_t at = 0;
        while (n > 0 && (used = reply_read(&reader, bytes + at, have - at, &part)) != 0) {
            CHECK_MSG(used > 0, "%s: %.*s", reader.fault, (int)(have - at), bytes + at);
            at += (size_t)used;
            n -= part.last;
        }
        memmove(bytes, bytes + at, have - at);
        have -= at;
    }
    CHECK(have == 0);
}

static int random_request(char *to, unsigned *state)
{
    *state = *state * 1103515245u + 12345u;
    unsigned r = *state >> 8, set = r % 3, id = r / 7 % 3000;
    switch (r / 3 % 16) {
    case 0:
        return sprintf(to, "TRIANGULATE s%u\n", set);
    case 1:
        return sprintf(to, "LISTS s%u\n", set);
    case 2:
        return sprintf(to, "DEL s%u %u\n", set, id);
    case 3:
        return sprintf(to, "MOVE s%u %u %u %u\n", set, id, id, r % 1000);
    case 4:
        return sprintf(to, r % 50 == 0 ? "DROP s%u\n" : "STAT s%u\n", set);
    case 5:
        return sprintf(to, "CHECK s%u\n", set);
    case 6:
        return sprintf(to, "TRIANGLES s%u BINARY\n", set);
    case 7:
        return sprintf(to, "NEAREST s%u 5 5 %u\n", set, id);
    case 8:
        return sprintf(to, "WITHIN s%u 0 0 500 500\nSETS\n", set);
    case 9:
        return sprintf(to, "TRIANGULATE s%u METHOD %s\n", set, r % 2 ? "divide" : "shelling");
    default: {
        int n = sprintf(to, "ADD s%u", set);
        for (unsigned i = 0; i < 150; i++)
            n += sprintf(to + n, " %u %u", (r + i * 7919) % 1000, (r + i * i) % 1013);
        return n + sprintf(to + n, "\n");
    }
    }
}

static void *stress(void *arg)
{
    unsigned state = (unsigned)(uintptr_t)arg;
    char requests[8 * 2000];
    while (!stress_over) {
        int fd = daemon_connect(stressed), n = 0, count = 0;
        for (int i = 0; i < 6; i++)
            n += random_request(requests + n, &state);
        for (int i = 0; i < n; i++)
            count += requests[i] == '\n';
        say_bytes(fd, requests, (size_t)n);
        if (state >> 12 & 3)
            frame_replies(fd, count);
        close(fd); /* sometimes in the middle of everything */
    }
    return NULL;
}

/* Drops a set that one of the clients may have dropped already. */
static void drop_if_there(const struct daemon *d, const char *set)
{
    int fd = daemon_connect(d);
    say(fd, "DROP ");
    say(fd, set);
    say(fd, "\n");
    const char *reply = hear_line(fd);
    CHECK_MSG(strcmp(reply, "OK 0") == 0 || strncmp(reply, "ERR NOSET ", 10) == 0, "%s", reply);
    close(fd);
}

TEST_TIMEOUT(clients_that_do_everything_at_once_get_well_formed_replies, 60)
{
    enum { CLIENTS = 8 };
    pthread_t thread[CLIENTS];
    const char *arguments[] = {"--threads", "3", NULL};
    struct daemon d = daemon_start(arguments);
    stressed = &d;
    for (uintptr_t i = 0; i < CLIENTS; i++)
        CHECK(pthread_create(&thread[i], NULL, stress, (void *)(i * 7 + test_below(1000))) == 0);
    pause_ms(3000);
    stress_over = true;
    for (int i = 0; i < CLIENTS; i++)
        pthread_join(thread[i], NULL);
    await_info(&d, "clients",
               1); /* all requests of the last clients are done: no ADD follows the DROP */
    drop_if_there(&d, "s0");
    drop_if_there(&d, "s1");
    drop_if_there(&d, "s2");
    await_info(&d, "memory", 0);
    await_info(&d, "loading", 0);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}
