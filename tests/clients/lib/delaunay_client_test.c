/* delaunay_client_test.c - the client library with servers that behave, and with faulty ones. */
#include "clients/lib/delaunay_client.h"

#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/clients/peer.h"
#include "tests/daemon.h"
#include "tests/test.h"

static struct delaunay_client *connected(const char *port)
{
    char why[200];
    struct delaunay_client *c = delaunay_connect("127.0.0.1", port, why, sizeof why);
    CHECK_MSG(c != NULL, "%s", why);
    return c;
}

/* Appends "kind:text;" to the transcript ctx[1000]. */
static bool transcribe(void *ctx, const struct delaunay_part *part)
{
    char *out = ctx;
    size_t n = strlen(out);
    snprintf(out + n, 1000 - n, "%c:%.*s;", "oerb#"[part->kind], (int)part -> len, part -> text);
    return true;
}

/* Answers a few known lines. */
static void answer(int fd)
{
    char line[200];
    while (peer_hear(fd, line, sizeof line)) {
        if (strcmp(line, "HULL t") == 0)
            peer_say(fd, "# progress 50 hull\nOK 2 boundary=2\n0 1 2\n1 3 4\n");
        else if (strcmp(line, "RAW") == 0)
            peer_say(fd, "OK 0 bytes=3\nabc");
        else if (strcmp(line, "CUT") == 0) {
            peer_say(fd, "OK 2\nonly one\n");
            return;
        } else if (strcmp(line, "JUNK") == 0)
            peer_say(fd, "HTTP/1.1 200 OK\n");
        else
            peer_say(fd, "ERR UNKNOWN what\n");
    }
}

TEST(client_passes_every_part_of_a_reply)
{
    char port[8], got[1000] = "";
    peer_start(port, answer);
    struct delaunay_client *c = connected(port);
    CHECK(delaunay_request(c, "HULL t", transcribe, got) == DELAUNAY_OK);
    CHECK_STR(got, "#:# progress 50 hull;o:OK 2 boundary=2;r:0 1 2;r:1 3 4;");
    uint64_t boundary;
    CHECK(delaunay_key_number(delaunay_status(c), "boundary", &boundary) && boundary == 2);
    got[0] = 0;
    CHECK(delaunay_request(c, "RAW", transcribe, got) == DELAUNAY_OK);
    CHECK_STR(got, "o:OK 0 bytes=3;b:abc;");
    delaunay_close(c);
}

TEST(client_continues_after_a_refusal)
{
    char port[8];
    peer_start(port, answer);
    struct delaunay_client *c = connected(port);
    CHECK(delaunay_request(c, "NONSENSE", NULL, NULL) == DELAUNAY_REFUSED);
    CHECK_STR(delaunay_status(c)->text, "ERR UNKNOWN what");
    CHECK(delaunay_request(c, "HULL t", NULL, NULL) == DELAUNAY_OK);
    CHECK_STR(delaunay_status(c)->text, "OK 2 boundary=2");
    delaunay_close(c);
}

TEST(client_notices_a_reply_that_is_cut)
{
    char port[8], got[1000] = "";
    peer_start(port, answer);
    struct delaunay_client *c = connected(port);
    CHECK(delaunay_request(c, "CUT", transcribe, got) == DELAUNAY_LOST);
    CHECK_STR(got, "o:OK 2;r:only one;");
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_LOST);
    delaunay_close(c);
}

TEST(client_notices_another_protocol)
{
    char port[8];
    peer_start(port, answer);
    struct delaunay_client *c = connected(port);
    CHECK(delaunay_request(c, "JUNK", NULL, NULL) == DELAUNAY_BROKEN);
    delaunay_close(c);
}

static bool stop(void *ctx, const struct delaunay_part *part)
{
    (void)ctx;
    return part->kind != DELAUNAY_PART_ROW;
}

TEST(client_stops_when_its_caller_says_so)
{
    char port[8];
    peer_start(port, answer);
    struct delaunay_client *c = connected(port);
    CHECK(delaunay_request(c, "HULL t", stop, NULL) == DELAUNAY_STOPPED);
    delaunay_close(c);
}

/* Stops reading while its replies are not read, like a server with back-pressure. */
static void echo_much(int fd)
{
    char *line = NULL, reply[3000];
    size_t room = 0;
    FILE *in = fdopen(dup(fd), "r");
    while (in != NULL && getline(&line, &room, in) > 0) {
        snprintf(reply, sizeof reply, "OK 1\n%lu %02000d\n", strtoul(line, NULL, 10), 0);
        peer_say(fd, reply);
    }
}

static bool check_echo(void *ctx, const struct delaunay_part *part)
{
    if (part->kind == DELAUNAY_PART_ROW)
        CHECK(strtoul(part->text, NULL, 10) == *(unsigned *)ctx && part->len > 2000);
    return true;
}

TEST_TIMEOUT(client_pipelines_any_amount_without_deadlock, 60)
{
    char port[8], line[512];
    const unsigned requests =
        40000; /* 80 MB of replies, 16 MB of requests: more than sockets hold */
    peer_start(port, echo_much);
    struct delaunay_client *c = connected(port);
    for (unsigned i = 0; i < requests; i++)
        CHECK(delaunay_send(c, line, (size_t)snprintf(line, sizeof line, "%u %0400u", i, i)) ==
              DELAUNAY_OK);
    for (unsigned i = 0; i < requests; i++)
        CHECK(delaunay_receive(c, check_echo, &i) == DELAUNAY_OK);
    delaunay_close(c);
}

/* Accepts a LOADB and replies with its head and a checksum of its body. */
static void take_points(int fd)
{
    char line[200], reply[300];
    unsigned char byte[65536];
    unsigned long n, sum = 0;
    if (!peer_hear(fd, line, sizeof line) || sscanf(line, "LOADB s %lu", &n) != 1)
        return;
    for (size_t left = 16 * n; left > 0;) {
        ssize_t got = read(fd, byte, left < sizeof byte ? left : sizeof byte);
        if (got <= 0)
            return;
        for (ssize_t i = 0; i < got; i++)
            sum = sum * 31 + byte[i];
        left -= (size_t)got;
    }
    snprintf(reply, sizeof reply, "OK 0 added=%lu sum=%lu\n", n, sum);
    peer_say(fd, reply);
}

struct progress_seen {
    size_t calls, last, total;
};

static void see_progress(void *ctx, size_t done, size_t total)
{
    struct progress_seen *p = ctx;
    CHECK(done > p->last && done <= total);
    p->calls++;
    p->last = done;
    p->total = total;
}

TEST(client_sends_points_in_binary_and_reports_progress)
{
    const size_t n = 300001;
    char port[8];
    unsigned long sum = 0;
    double *xy = malloc(2 * n * sizeof *xy);
    for (size_t i = 0; i < 2 * n; i++) {
        xy[i] = test_uniform() - 0.5;
        uint64_t bits;
        memcpy(&bits, &xy[i], sizeof bits);
        for (int k = 0; k < 64; k += 8)
            sum = sum * 31 + (bits >> k & 255);
    }
    peer_start(port, take_points);
    struct delaunay_client *c = connected(port);
    struct progress_seen seen = {0};
    CHECK(delaunay_send_points(c, "s", xy, n, see_progress, &seen) == DELAUNAY_OK);
    CHECK(seen.calls > 10 && seen.last == n && seen.total == n);
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_OK);
    uint64_t got;
    CHECK(delaunay_key_number(delaunay_status(c), "added", &got) && got == n);
    CHECK(delaunay_key_number(delaunay_status(c), "sum", &got) && got == sum);
    delaunay_close(c);
    free(xy);
}

/* Refuses at once, then reads the rest of the input. */
static void refuse_early(int fd)
{
    char bytes[65536];
    peer_say(fd, "ERR BUSY later\n");
    shutdown(fd, SHUT_WR);
    while (read(fd, bytes, sizeof bytes) > 0)
        continue;
}

static void close_early(int fd)
{
    char byte;
    if (read(fd, &byte, 1) < 0)
        return;
}

TEST(client_reads_a_refusal_that_arrives_while_it_sends)
{
    const size_t n = 1000000;
    char port[8];
    double *xy = calloc(2 * n, sizeof *xy);
    peer_start(port, refuse_early);
    struct delaunay_client *c = connected(port);
    CHECK(delaunay_send_points(c, "s", xy, n, NULL, NULL) == DELAUNAY_OK);
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_REFUSED);
    CHECK_STR(delaunay_status(c)->text, "ERR BUSY later");
    delaunay_close(c);
    free(xy);
}

TEST(client_survives_a_server_that_disconnects_during_a_load)
{
    const size_t n = 1000000;
    char port[8];
    double *xy = calloc(2 * n, sizeof *xy);
    peer_start(port, close_early);
    struct delaunay_client *c = connected(port);
    enum delaunay_result r = delaunay_send_points(c, "s", xy, n, NULL, NULL);
    if (r == DELAUNAY_OK)
        r = delaunay_receive(c, NULL, NULL);
    CHECK(r == DELAUNAY_LOST);
    CHECK_STR(delaunay_status(c)->text, ""); /* no reply has arrived */
    delaunay_close(c);
    free(xy);
}

TEST(client_sends_no_points_with_an_invalid_name)
{
    char port[8];
    double xy[2] = {0};
    peer_start(port, answer);
    struct delaunay_client *c = connected(port);
    CHECK(delaunay_send_points(c, "a b", xy, 1, NULL, NULL) == DELAUNAY_BADNAME);
    CHECK(delaunay_send_points(c, "a\nDROP a", xy, 1, NULL, NULL) == DELAUNAY_BADNAME);
    CHECK(delaunay_send_points(c, "", xy, 1, NULL, NULL) == DELAUNAY_BADNAME);
    CHECK(delaunay_request(c, "HULL t", NULL, NULL) ==
          DELAUNAY_OK); /* the connection still works */
    delaunay_close(c);
}

/* Each allocation fails once, for a binary reply and for points that are sent. */
TEST(client_reports_that_memory_ran_out)
{
    static const double xy[2 * 5000];
    char port[8];
    bool failed = true;
    peer_start(port, answer);
    for (long nth = 1; failed; nth++) {
        void *bytes = NULL;
        size_t n = 0;
        struct delaunay_client *c = connected(port);
        test_fail_alloc(nth);
        enum delaunay_result r = delaunay_send(c, "RAW", 3);
        if (r == DELAUNAY_OK)
            r = delaunay_receive_bytes(c, &bytes, &n);
        failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK_MSG(r == (failed ? DELAUNAY_NOMEM : DELAUNAY_OK), "allocation %ld: %s", nth,
                  delaunay_result_text(r));
        CHECK(failed ? bytes == NULL && n == 0 : n == 3 && memcmp(bytes, "abc", 3) == 0);
        free(bytes);
        delaunay_close(c);
        CHECK(nth < 20);
    }
    struct delaunay_client *c = connected(port);
    test_fail_alloc(1);
    CHECK(delaunay_send_points(c, "s", xy, 5000, NULL, NULL) == DELAUNAY_NOMEM);
    delaunay_close(c);
}

TEST(client_looks_up_many_places_at_once)
{
    static const double points[] = {0, 0, 4, 0, 4, 4, 0, 4}, at[] = {1, 1, 3, 1, 5, 5};
    static const uint32_t found[] = {0, 1, 3, 0, 1, 3, DELAUNAY_NONE, DELAUNAY_NONE, DELAUNAY_NONE},
                          near[] = {0, 1, 3, 2, DELAUNAY_NONE, 1, 0, 2, 3, DELAUNAY_NONE,
                                    2, 1, 3, 0, DELAUNAY_NONE};
    struct daemon d = daemon_start(NULL);
    struct delaunay_client *c = connected(d.port_text);
    uint32_t got[15] = {7};
    CHECK(delaunay_send_points(c, "t", points, 4, NULL, NULL) == DELAUNAY_OK);
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_OK);
    CHECK(delaunay_locate_places(c, "t", at, 3, got) == DELAUNAY_REFUSED && got[0] == 7);
    CHECK(delaunay_request(c, "TRIANGULATE t", NULL, NULL) == DELAUNAY_OK);
    CHECK(delaunay_locate_places(c, "t", at, 3, got) == DELAUNAY_OK);
    CHECK(memcmp(got, found, sizeof found) == 0);
    CHECK(delaunay_nearest_places(c, "t", at, 3, 5, got) == DELAUNAY_OK);
    CHECK(memcmp(got, near, sizeof near) == 0);
    CHECK(delaunay_nearest_places(c, "t", at, 3, 5000, got) == DELAUNAY_REFUSED);
    CHECK(delaunay_nearest_places(c, "t", at, 0, 1, got) == DELAUNAY_OK);
    CHECK(delaunay_locate_places(c, "no set", at, 3, got) == DELAUNAY_BADNAME);
    CHECK(delaunay_request(c, "PING", NULL, NULL) == DELAUNAY_OK);
    delaunay_close(c);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* Replies with too few bytes. */
static void answer_short(int fd)
{
    char line[200];
    while (peer_hear(fd, line, sizeof line))
        if (strncmp(line, "LOCATEB ", 8) == 0)
            peer_say(fd, "OK 0 rows=1 bytes=3\nabc");
}

TEST(client_notices_words_that_are_missing)
{
    static const double at[] = {0};
    char port[8];
    uint32_t got[3] = {7};
    peer_start(port, answer_short);
    struct delaunay_client *c = connected(port);
    CHECK(delaunay_locate_places(c, "t", at, 0, got) == DELAUNAY_BROKEN && got[0] == 7);
    delaunay_close(c);
}

TEST(client_reports_why_it_cannot_connect)
{
    char why[200], path[300];
    CHECK(delaunay_connect("127.0.0.1", "1", why, sizeof why) == NULL);
    CHECK(strstr(why, "127.0.0.1:1: ") == why);
    CHECK(delaunay_connect("127.0.0.1", "no such port", why, sizeof why) == NULL && why[0] != 0);
    CHECK(delaunay_connect("127.0.0.1", "65537", why, sizeof why) == NULL);
    CHECK_STR(why, "127.0.0.1:65537: a port is at most 65535");
    CHECK(delaunay_connect("/nonexistent/socket", "1", why, sizeof why) == NULL);
    CHECK(strstr(why, "/nonexistent/socket: ") == why);
    memset(path, '/', sizeof path);
    path[sizeof path - 1] = 0;
    CHECK(delaunay_connect(path, "1", why, sizeof why) == NULL && strstr(why, "too long") != NULL);
}

TEST(client_connects_to_a_unix_socket)
{
    char path[64], why[200];
    snprintf(path, sizeof path, "/tmp/delaunay_client_test.%d", getpid());
    peer_start_unix(path, answer);
    struct delaunay_client *c = delaunay_connect(path, "ignored", why, sizeof why);
    unlink(path);
    CHECK_MSG(c != NULL, "%s", why);
    CHECK(delaunay_request(c, "HULL t", NULL, NULL) == DELAUNAY_OK);
    delaunay_close(c);
}

TEST(request_with_a_line_feed_is_refused_and_later_replies_stay_right)
{
    char port[8];
    peer_start(port, answer);
    struct delaunay_client *c = connected(port);
    CHECK(delaunay_request(c, "RAW\nHULL t", NULL, NULL) == DELAUNAY_BADREQUEST);
    CHECK(delaunay_send(c, "RAW\r\nHULL t", 11) == DELAUNAY_BADREQUEST);
    CHECK(delaunay_send(c, "RAW\0", 4) == DELAUNAY_BADREQUEST);
    CHECK(delaunay_request(c, "NONSENSE", NULL, NULL) == DELAUNAY_REFUSED);
    CHECK(delaunay_request(c, "HULL t\r\n", NULL, NULL) == DELAUNAY_OK);
    CHECK_STR(delaunay_status(c)->text, "OK 2 boundary=2");
    delaunay_close(c);
}

TEST(request_without_a_reply_of_its_own_is_refused_at_once)
{
    static const char *const lines[] = {
        "", "\n", "  ", "# comment", "LOAD t 2", "TIMEOUT 1 LOAD t", "loadb t 1", "locateb t 1"};
    char port[8];
    peer_start(port, answer);
    struct delaunay_client *c = connected(port);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        CHECK(delaunay_request(c, lines[i], NULL, NULL) == DELAUNAY_BADREQUEST);
    CHECK(delaunay_request(c, "HULL t", NULL, NULL) == DELAUNAY_OK);
    delaunay_close(c);
}

TEST(values_are_not_sent_under_names_that_are_not_fields)
{
    static const char *const bad[] = {"a,,b", ",a", "a,", "1a", "a b", "a\nPING"};
    static const double at[] = {0, 0, 1, 2, 3, 4};
    char port[8];
    peer_start(port, answer);
    struct delaunay_client *c = connected(port);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK(delaunay_send_values(c, "t", bad[i], at, at, 1, NULL, NULL) == DELAUNAY_BADNAME);
    CHECK(delaunay_request(c, "HULL t", NULL, NULL) == DELAUNAY_OK);
    delaunay_close(c);
}

TEST(every_result_has_a_sentence_of_its_own_and_other_numbers_have_one_too)
{
    for (int i = 0; i <= (int)DELAUNAY_BADREQUEST; i++)
        for (int j = -1; j < i; j++)
            CHECK(strcmp(delaunay_result_text((enum delaunay_result)i),
                         delaunay_result_text((enum delaunay_result)j)) != 0);
    CHECK_STR(delaunay_result_text((enum delaunay_result)(DELAUNAY_BADREQUEST + 1)),
              delaunay_result_text((enum delaunay_result) - 1));
}

/* Answers the second of two requests only: after it the reply to the first. */
static void answer_late(int fd)
{
    char line[200];
    while (peer_hear(fd, line, sizeof line))
        if (strcmp(line, "CUT") == 0)
            peer_say(fd, "OK 0 bytes=4\nab");
        else if (strcmp(line, "NOW") == 0)
            peer_say(fd, "OK 0 late=1\nOK 0 now=1\n");
}

TEST(client_with_a_time_limit_can_receive_a_late_reply)
{
    char port[8];
    peer_start(port, answer_late);
    struct delaunay_client *c = connected(port);
    delaunay_set_timeout(c, 50);
    CHECK(delaunay_request(c, "LATER", NULL, NULL) == DELAUNAY_TIMEOUT);
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_TIMEOUT);
    delaunay_set_timeout(c, -1);
    CHECK(delaunay_send(c, "NOW", 3) == DELAUNAY_OK);
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_OK);
    CHECK_STR(delaunay_status(c)->text, "OK 0 late=1");
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_OK);
    CHECK_STR(delaunay_status(c)->text, "OK 0 now=1");
    delaunay_close(c);
}

TEST(bytes_of_which_a_part_arrived_in_time_are_not_continued)
{
    char port[8];
    void *bytes;
    size_t n;
    peer_start(port, answer_late);
    struct delaunay_client *c = connected(port);
    delaunay_set_timeout(c, 50);
    CHECK(delaunay_send(c, "CUT", 3) == DELAUNAY_OK);
    CHECK(delaunay_receive_bytes(c, &bytes, &n) == DELAUNAY_TIMEOUT && bytes == NULL);
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_LOST);
    delaunay_close(c);
}

/* A server that takes nothing from its queue of connections. */
TEST(client_gives_up_connecting_after_its_time_limit)
{
    char path[64], why[200] = "";
    struct sockaddr_un addr = {.sun_family = AF_UNIX};
    snprintf(path, sizeof path, "/tmp/delaunay_client_full.%d", getpid());
    snprintf(addr.sun_path, sizeof addr.sun_path, "%s", path);
    int fd = socket(AF_UNIX, SOCK_STREAM, 0), first = socket(AF_UNIX, SOCK_STREAM, 0);
    CHECK(bind(fd, (struct sockaddr *)&addr, sizeof addr) == 0 && listen(fd, 0) == 0);
    CHECK(connect(first, (struct sockaddr *)&addr, sizeof addr) == 0);
    CHECK(delaunay_connect_within(path, NULL, 20, why, sizeof why) == NULL);
    CHECK_MSG(strstr(why, "timed out") != NULL, "%s", why);
    CHECK(delaunay_connect_within(path, NULL, 0, why, sizeof why) == NULL);
    close(first);
    close(fd);
    unlink(path);
}

/* Wants the token `word`. */
static void answer_guarded(int fd)
{
    char line[200];
    while (peer_hear(fd, line, sizeof line))
        peer_say(fd, strcmp(line, "AUTH word") == 0 ? "OK 0 role=write\n" : "ERR NOAUTH who\n");
}

TEST(client_connects_to_a_url_and_sends_its_token)
{
    char port[8], url[100], why[200];
    peer_start(port, answer_guarded);
    snprintf(url, sizeof url, "delaunay://:word@127.0.0.1:%s", port);
    struct delaunay_client *c = delaunay_connect(url, NULL, why, sizeof why);
    CHECK_MSG(c != NULL, "%s", why);
    CHECK_STR(delaunay_status(c)->text, "OK 0 role=write");
    CHECK(delaunay_authenticate(c, "two words") == DELAUNAY_BADREQUEST);
    CHECK(delaunay_authenticate(c, "") == DELAUNAY_BADREQUEST);
    delaunay_close(c);
    snprintf(url, sizeof url, "delaunay://:other@127.0.0.1:%s", port);
    CHECK(delaunay_connect(url, NULL, why, sizeof why) == NULL);
    CHECK_STR(why, "ERR NOAUTH who");
    CHECK(delaunay_connect("delaunay://", NULL, why, sizeof why) == NULL);
    CHECK(strstr(why, "not delaunay://") == why);
}
