/* auth_delay_test.c - clients that guess tokens are slowed down on every path, and other clients are not. */
#include "server/ops/auth_delay.h"
#include "tests/server/daemon.h"
#include "tests/server/said.h"
#include "tests/test.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* ---- the queue of an address ---- */

static struct auth_delay delay;

static struct sock_peer v4(uint32_t address)
{
    struct sock_peer p = {.kind = SOCK_V4};
    memcpy(p.address, &address, sizeof address);
    return p;
}

static struct sock_peer v6(const char *text)
{
    struct sock_peer p = {.kind = SOCK_V6};
    CHECK(inet_pton(AF_INET6, text, p.address) == 1);
    return p;
}

/* Returns how long a token of a new connection from that address waits. */
static int64_t line_of(struct sock_peer from, int64_t now)
{
    return auth_delay_charge(&delay, &from, 0, now) - now;
}

TEST(wrong_tokens_of_a_connection_wait_twice_as_long_each_time)
{
    static const int64_t wait[] = {0, 100, 200, 400, 800, 1600, 3000, 3000};
    struct sock_peer peer = v4(1);
    for (unsigned i = 0; i < sizeof wait / sizeof wait[0]; i++)
        CHECK(auth_delay_charge(&delay, &peer, i, 5000) == 5000 + wait[i]);
    CHECK(auth_delay_charge(&delay, &peer, UINT32_MAX, 5000) == 8000);
}

TEST(address_may_send_20_wrong_tokens_and_then_ten_a_second)
{
    int64_t now = 1000000;
    for (int i = 0; i < AUTH_DELAY_BURST; i++)
        CHECK(line_of(v4(1), now) == 0);
    for (int i = 1; i <= 30; i++)
        CHECK(line_of(v4(1), now) == 100 * i);
    for (int i = 0; i < 1000; i++) /* other clients of the address wait no longer than that */
        CHECK(line_of(v4(1), now) == AUTH_DELAY_LONGEST_MS);
    CHECK(line_of(v4(2), now) == 0);
    CHECK(line_of(v4(1), now + 1000) == 2100);
    now += 60000; /* the delays have expired */
    for (int i = 0; i < AUTH_DELAY_BURST; i++)
        CHECK(line_of(v4(1), now) == 0);
    CHECK(line_of(v4(1), now) == 100);
}

TEST(right_tokens_cause_no_delay)
{
    struct sock_peer peer = v4(1);
    for (int i = 0; i < 1000; i++) {
        CHECK(auth_delay_charge(&delay, &peer, 0, 777) == 777);
        auth_delay_refund(&delay, &peer, 777);
    }
    for (int i = 0; i < AUTH_DELAY_BURST; i++)
        CHECK(line_of(peer, 777) == 0);
    CHECK(line_of(peer, 777) == 100);
}

TEST(addresses_of_one_client_share_a_queue)
{
    struct sock_peer unix_peer = {.kind = SOCK_UNIX};
    for (int i = 0; i < AUTH_DELAY_BURST; i++) {
        line_of(v6("2001:db8:1:2::1"), 9);
        line_of(v6("::ffff:10.0.0.1"), 9);
        line_of(unix_peer, 9);
    }
    CHECK(line_of(v6("2001:db8:1:2:3:4:5:6"), 9) > 0);
    CHECK(line_of(v6("2001:db8:1:3::1"), 9) == 0);
    CHECK(line_of(v4(htonl(0x0A000001)), 9) > 0); /* the same through an IPv4 socket */
    CHECK(line_of(v6("::ffff:10.0.0.2"), 9) == 0);
    CHECK(line_of(unix_peer, 9) > 0);
}

TEST(addresses_that_do_not_fit_into_the_table_replace_those_with_shorter_delays)
{
    for (int i = 0; i < 2 * AUTH_DELAY_BURST; i++)
        line_of(v4(1), 50);
    for (uint32_t i = 2; i < 100 * AUTH_DELAY_SETS; i++)
        CHECK(line_of(v4(i), 50) == 0);
    CHECK(line_of(v4(1), 50) > 0);
}

/* ---- conversations ---- */

static struct daemon start_with_token(struct said *said)
{
    char path[] = "/tmp/delaunayd-test-XXXXXX";
    const char *arguments[] = {"--auth-file", path, NULL};
    static const char tokens[] = "rw secret\nro reader\n";
    int file = mkstemp(path);
    CHECK(file >= 0 && write(file, tokens, sizeof tokens - 1) == (ssize_t)sizeof tokens - 1);
    close(file);
    *said = said_begin();
    struct daemon d = daemon_start(arguments);
    said_end(said);
    unlink(path);
    return d;
}

/* The number of lines of text that arrive within `ms` milliseconds. */
static unsigned lines_within(int fd, unsigned ms)
{
    char text[4096];
    unsigned n = 0;
    double end = seconds() + ms / 1000.0;
    struct pollfd p = {.fd = fd, .events = POLLIN};
    while (seconds() < end && poll(&p, 1, (int)(1000 * (end - seconds())) + 1) == 1) {
        ssize_t got = recv(fd, text, sizeof text, MSG_DONTWAIT);
        if (got <= 0)
            break;
        for (ssize_t i = 0; i < got; i++)
            n += text[i] == '\n';
    }
    return n;
}

static void say_often(int fd, const char *text, int n)
{
    while (n-- > 0)
        say(fd, text);
}

TEST(guesses_on_one_connection_become_slow_in_both_framings)
{
    static const char hello[] = "*5\r\n$5\r\nHELLO\r\n$1\r\n2\r\n$4\r\nAUTH\r\n$1\r\n"
                                "u\r\n$2\r\nno\r\n";
    static const char *const guess[] = {"AUTH no\n", "*2\r\n$4\r\nAUTH\r\n$2\r\nno\r\n", hello};
    struct said said;
    struct daemon d = start_with_token(&said);
    for (size_t i = 0; i < sizeof guess / sizeof guess[0]; i++) {
        int fd = daemon_connect(&d);
        say_often(fd, guess[i], 1000);
        unsigned n = lines_within(fd, 1200); /* after 0, 100, 300, 700, 1500 ms */
        CHECK_MSG(n >= 1 && n <= 5, "%u guesses in 1.2 s", n);
        close(fd);
    }
}

TEST(reader_that_guesses_the_token_of_writers_is_slow_too)
{
    struct said said;
    struct daemon d = start_with_token(&said);
    int fd = daemon_connect(&d);
    say(fd, "AUTH reader\n");
    expect(fd, "OK 0 role=ro\n");
    say_often(fd, "AUTH no\n", 1000);
    CHECK(lines_within(fd, 1200) <= 5);
}

/* A client with the right token. */
static int known_client(const struct daemon *d)
{
    int fd = daemon_connect(d);
    say(fd, "AUTH secret\n");
    expect(fd, "OK 0 role=rw\n");
    return fd;
}

static uint64_t info(int known, const char *key)
{
    uint64_t value = UINT64_MAX;
    size_t len = strlen(key);
    say(known, "INFO clients\n");
    for (unsigned n = (unsigned)strtoul(hear_line(known) + 3, NULL, 10); n > 0; n--) {
        const char *line = hear_line(known);
        if (strncmp(line, key, len) == 0 && line[len] == ':')
            value = strtoull(line + len + 1, NULL, 10);
    }
    CHECK_MSG(value != UINT64_MAX, "INFO has no %s", key);
    return value;
}

/* Opens connections that each send many wrong tokens. */
static void guess_on(const struct daemon *d, int *fd, int n)
{
    for (int i = 0; i < n; i++) {
        fd[i] = daemon_connect(d);
        say_often(fd[i], "AUTH no\n", 10);
    }
}

TEST(guesses_on_many_connections_share_the_queue_of_their_address)
{
    enum { CONNECTIONS = 100 };
    int fd[CONNECTIONS];
    struct said said;
    struct daemon d = start_with_token(&said);
    int known = known_client(&d);
    double start = seconds();
    guess_on(&d, fd, CONNECTIONS);
    pause_ms(2000);
    uint64_t wrong = info(known, "wrong_tokens");
    double most = AUTH_DELAY_BURST + 1000.0 / AUTH_DELAY_EACH_MS * (seconds() - start) + 1;
    CHECK_MSG(wrong >= AUTH_DELAY_BURST && (double)wrong <= most, "%d guesses", (int)wrong);
    CHECK(info(known, "delayed_tokens") >= CONNECTIONS - AUTH_DELAY_BURST);
}

TEST(guesses_of_clients_that_disconnect_at_once_share_the_queue_too)
{
    struct said said;
    struct daemon d = start_with_token(&said);
    int known = known_client(&d);
    double start = seconds();
    for (int i = 0; i < 300; i++) {
        int fd = daemon_connect(&d);
        say(fd, "AUTH no\n");
        close(fd);
    }
    uint64_t wrong = info(known, "wrong_tokens");
    CHECK((double)wrong <=
          AUTH_DELAY_BURST + 1000.0 / AUTH_DELAY_EACH_MS * (seconds() - start) + 1);
}

/* Connects as if from another machine. */
static int connect_from(const struct daemon *d, uint32_t address)
{
    struct sockaddr_in from = {.sin_family = AF_INET};
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((in_port_t)d->port)};
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    from.sin_addr.s_addr = htonl(address);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    CHECK(fd >= 0 && bind(fd, (struct sockaddr *)&from, sizeof from) == 0);
    CHECK(connect(fd, (struct sockaddr *)&to, sizeof to) == 0);
    return fd;
}

TEST(clients_with_a_token_get_in_while_strangers_guess)
{
    enum { CONNECTIONS = 200 };
    int fd[CONNECTIONS];
    struct said said;
    struct daemon d = start_with_token(&said);
    int known = known_client(&d);
    guess_on(&d, fd, CONNECTIONS);
    double start = seconds();
    int other = connect_from(&d, INADDR_LOOPBACK + 1);
    say(other, "AUTH secret\n");
    expect(other, "OK 0 role=rw\n");
    CHECK(1000 * (seconds() - start) < AUTH_DELAY_LONGEST_MS / 2);
    int neighbour = daemon_connect(&d);
    say(neighbour, "AUTH secret\n");
    expect(neighbour, "OK 0 role=rw\n");
    CHECK(1000 * (seconds() - start) < 2 * AUTH_DELAY_LONGEST_MS);
    say(known, "PING\n");
    expect(known, "OK 0\n");
}

TEST(strangers_make_room_for_others_and_clients_with_a_token_do_not)
{
    enum { MOST = 4 };
    static const char evicted[] = "ERR BUSY too many clients, and this one has not authenticated\n";
    int stranger[MOST], known[MOST];
    struct said said;
    struct daemon d = start_with_token(&said);
    known[0] = known_client(&d);
    say(known[0], "CONFIG SET max-clients 4\n");
    expect(known[0], "OK 0\n");
    for (int i = 1; i < MOST; i++) {
        stranger[i] = daemon_connect(&d);
        say(stranger[i], i == 1 ? "*1\r\n$4\r\nPING\r\n" : "PING\n");
        expect(stranger[i], i == 1 ? "+PONG\r\n" : "OK 0\n");
    }
    known[1] = known_client(&d);
    expect(stranger[1], "-BUSY too many clients, and this one has not authenticated\r\n");
    expect_end(stranger[1]);
    say(stranger[2], "AUTH reader\nPING\n"); /* it has a token now, although it came first */
    expect(stranger[2], "OK 0 role=ro\nOK 0\n");
    known[2] = known_client(&d);
    expect(stranger[3], evicted);
    expect_end(stranger[3]);
    int one_more = daemon_connect(&d);
    expect(one_more, "ERR BUSY too many clients\n");
    expect_end(one_more);
    CHECK(info(known[0], "refused") == 3 && info(known[0], "clients") == MOST);
    close(known[2]);
    for (int i = 0; i < 20; i++) { /* one place is left, which a client without a token has */
        while (info(known[0], "clients") >= MOST) /* one that is evicted still counts */
            pause_ms(1);
        int last = daemon_connect(&d);
        say(last, "PING\n");
        expect(last, "OK 0\n");
        close(known_client(&d));
        expect(last, evicted);
        close(last);
    }
    say(known[1], "PING\n");
    expect(known[1], "OK 0\n");
    daemon_end(&d);
}

TEST(wrong_tokens_are_reported_with_their_address_and_do_not_flood_the_log)
{
    struct said said;
    struct daemon d = start_with_token(&said);
    for (int i = 0; i < 15; i++)
        converse(&d, "AUTH no\n", "ERR DENIED no such token\n");
    CHECK(info(known_client(&d), "wrong_tokens") == 15);
    daemon_end(&d);
    CHECK(said_lines(&said, "warning: client ") == 1 && said_lines(&said, " of 127.0.0.1:") == 1);
    CHECK(said_lines(&said, " sent a wrong token ") == 1 && said_lines(&said, "no ") == 0);
    CHECK(said_lines(&said, "") == 1);
}

TEST(token_that_waits_is_abandoned_with_its_request)
{
    struct said said;
    struct daemon d = start_with_token(&said);
    int fd = daemon_connect(&d);
    say_often(fd, "AUTH no\n", 4);
    for (int i = 0; i < 4; i++)
        CHECK_STR(hear_line(fd), "ERR DENIED no such token");
    say(fd, "TIMEOUT 0.1 AUTH secret\nPING\n");
    CHECK_STR(hear_line(fd), "ERR TIMEOUT the request took too long; nothing has changed");
    CHECK_STR(hear_line(fd), "OK 0");
    say(fd, "AUTH secret\n"); /* is answered after its delay, even after half-close */
    shutdown(fd, SHUT_WR);
    expect(fd, "OK 0 role=rw\n");
    expect_end(fd);
    daemon_end(&d);
}
