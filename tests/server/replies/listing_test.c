/* listing_test.c - replies about many sets, clients or slow requests: complete, sorted, and made in
 * pieces. */
#include "server/command/command.h"
#include "server/replies/listing.h"
#include "tests/server/daemon.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* ---- SETS ---- */

/* Creates n sets whose names are distinct numbers in no order. */
static void create_sets(struct local *l, unsigned n)
{
    char line[40];
    for (unsigned i = 0; i < n; i++) {
        snprintf(line, sizeof line, "CREATE s%05u\n", i * 7919 % 65536);
        CHECK_STR(local_ask(l, line), "OK 0\n");
    }
}

static void check_sets(const char *reply, unsigned n)
{
    static const char rest[] = " points=0 triangulated=no\n";
    CHECK(strncmp(reply, "OK ", 3) == 0 && strtoul(reply + 3, NULL, 10) == n);
    const char *at = strchr(reply, '\n') + 1, *before = NULL;
    for (unsigned i = 0; i < n; i++) {
        const char *blank = strchr(at, ' ');
        CHECK(blank == at + 6 && strncmp(blank, rest, sizeof rest - 1) == 0);
        CHECK(before == NULL || memcmp(before, at, 6) < 0);
        before = at;
        at = blank + sizeof rest - 1;
    }
    CHECK(*at == '\0');
}

TEST(sets_are_listed_by_name_however_many_there_are)
{
    static const unsigned many[] = {0, 1, 255, 256, 257, 1000, 5000};
    for (unsigned threads = 0; threads <= 2; threads += 2) {
        for (size_t i = 0; i < sizeof many / sizeof many[0]; i++) {
            struct local l;
            local_start(&l, threads);
            create_sets(&l, many[i]);
            check_sets(local_ask(&l, "SETS\n"), many[i]);
            local_stop(&l);
        }
    }
}

TEST(long_listings_are_made_in_pieces)
{
    enum { SETS = 5000, STEPS = 10 };
    struct local l;
    local_start(&l, 0);
    create_sets(&l, SETS);
    struct buf out = {0};
    struct answer a = {.out = &out, .client.role = ROLE_WRITE};
    CHECK(request_split(&l.server.reactor->request, "SETS", 4));
    command_run(&l.server, &l.server.reactor->request, &a);
    unsigned pieces = 0;
    for (size_t before = 0; a.next == ANSWER_STREAM; before = buf_len(&out), pieces++) {
        CHECK(buf_len(&out) - before <= 66000);
        stream_refill(&l.server, &a);
    }
    CHECK(pieces >= SETS / 300);
    buf_append_char(&out, '\0');
    check_sets(buf_head(&out), SETS);
    buf_free(&out);
    local_stop(&l);
}

TEST(sets_that_stay_are_listed_once_while_others_come_and_go)
{
    enum { STAY = 2000 };
    static unsigned seen[STAY];
    struct local l;
    char line[60];
    local_start(&l, 0);
    for (unsigned i = 0; i < STAY; i++) {
        snprintf(line, sizeof line, "CREATE stay%u\nCREATE go%u\n", i, i);
        local_ask(&l, line);
    }
    struct buf out = {0};
    struct answer a = {.out = &out, .client.role = ROLE_WRITE};
    CHECK(request_split(&l.server.reactor->request, "SETS", 4));
    command_run(&l.server, &l.server.reactor->request, &a);
    for (unsigned i = 0; a.next == ANSWER_STREAM; i++) {
        stream_refill(&l.server, &a);
        for (unsigned k = 0; k < 300; k++) { /* the table of sets grows meanwhile */
            snprintf(line, sizeof line, "DROP go%u\nCREATE come%u_%u\n", i * 300 + k, i, k);
            local_ask(&l, line);
        }
    }
    buf_append_char(&out, '\0');
    unsigned n = 0, rows = (unsigned)strtoul(buf_head(&out) + 3, NULL, 10), number;
    for (const char *at = buf_head(&out); (at = strchr(at, '\n')) != NULL && at[1] != '\0'; n++)
        if (sscanf(++at, "stay%u ", &number) == 1)
            seen[number]++;
    CHECK(n == rows);
    for (unsigned i = 0; i < STAY; i++)
        CHECK_MSG(seen[i] == 1, "stay%u is listed %u times", i, seen[i]);
    buf_free(&out);
    local_stop(&l);
}

TEST(long_listing_survives_every_failed_allocation)
{
    struct local l;
    local_start(&l, 0);
    create_sets(&l, 1500);
    test_fail_alloc(0);
    bool failed = true;
    for (long n = 1; failed; n++) {
        local_ask(&l, "PING\n");
        test_fail_alloc(n);
        const char *reply = local_ask(&l, "SETS\n");
        failed = test_alloc_failed();
        test_fail_alloc(0);
        if (strncmp(reply, "ERR NOMEM ", 10) != 0 && !l.closed)
            check_sets(reply, 1500);
        CHECK(failed || !l.closed);
        l.closed = false;
    }
    CHECK(budget_of(&l.server.budget, BUDGET_REPLIES) == 0);
    local_stop(&l);
}

TEST(listing_that_does_not_fit_into_memory_is_refused)
{
    struct local l;
    local_start(&l, 0);
    create_sets(&l, 5000);
    local_limit(&l, 1);
    CHECK(strncmp(local_ask(&l, "SETS\n"), "ERR NOMEM ", 10) == 0);
    local_limit(&l, SIZE_MAX);
    check_sets(local_ask(&l, "SETS\n"), 5000);
    local_stop(&l);
}

/* ---- through sockets ---- */

/* Reads a reply of n rows; returns how many of them contain the text. */
static unsigned rows_with(int fd, unsigned n, const char *text)
{
    unsigned found = 0;
    for (; n > 0; n--)
        found += strstr(hear_line(fd), text) != NULL;
    return found;
}

TEST(clients_are_listed_in_both_framings_however_many_there_are)
{
    enum { CLIENTS = 700 };
    static int fd[CLIENTS];
    struct daemon d = daemon_start(NULL);
    for (int i = 0; i < CLIENTS; i++) {
        fd[i] = daemon_connect(&d);
        say(fd[i], "PING\n");
        expect(fd[i], "OK 0\n");
    }
    say(fd[0], "CLIENT LIST\nPING\n");
    CHECK_STR(hear_line(fd[0]), "OK 700");
    CHECK(rows_with(fd[0], CLIENTS, " requests=1 command=PING") >= CLIENTS - 1);
    CHECK_STR(hear_line(fd[0]), "OK 0");
    say(fd[0], "*2\r\n$6\r\nCLIENT\r\n$4\r\nLIST\r\n*1\r\n$4\r\nPING\r\n");
    const char *head = hear_line(fd[0]);
    size_t bytes = strtoul(head + 1, NULL, 10);
    CHECK(head[0] == '$' && bytes > CLIENTS * 100);
    for (size_t i = 0; i < CLIENTS; i++)
        bytes -= strlen(hear_line(fd[0])) + 1;
    CHECK(bytes == 0);
    expect(fd[0], "\r\n+PONG\r\n");
}

TEST(slow_requests_are_listed_in_both_framings_however_many_there_are)
{
    enum { SLOW = 1000 };
    const char *arguments[] = {"--slowlog-us", "1", "--slowlog-len", "1000", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    for (int i = 0; i < SLOW + 100; i++) {
        say(fd, "INFO memory\n");
        rows_with(fd, (unsigned)strtoul(hear_line(fd) + 3, NULL, 10), "");
    }
    say(fd, "SLOWLOG GET -1\n");
    CHECK_STR(hear_line(fd), "OK 1000");
    CHECK(rows_with(fd, SLOW, " INFO memory") >= SLOW - 1);
    say(fd, "*3\r\n$7\r\nSLOWLOG\r\n$3\r\nGET\r\n$2\r\n-1\r\n*1\r\n$4\r\nPING\r\n");
    CHECK_STR(hear_line(fd), "*1000\r");
    unsigned entries = 0;
    for (const char *line = hear_line(fd); strcmp(line, "+PONG\r") != 0; line = hear_line(fd))
        entries += strcmp(line, "*6\r") == 0;
    CHECK(entries == SLOW);
}

TEST(client_that_disconnects_during_a_listing_leaves_nothing)
{
    enum { SETS = 20000, CLIENTS = 20 };
    static char line[60 * SETS];
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    size_t n = 0;
    for (unsigned i = 0; i < SETS; i++)
        n += (size_t)snprintf(line + n, sizeof line - n, "CREATE %040u\n", i);
    say_bytes(fd, line, n);
    for (unsigned i = 0; i < SETS; i++)
        expect(fd, "OK 0\n");
    for (int i = 0; i < CLIENTS; i++) {
        int gone = daemon_connect(&d);
        say(gone, "SETS\nSETS\n");
        if (i % 2 == 0)
            hear_line(gone);
        close(gone);
    }
    await_info(&d, "clients", 2);
    await_info(&d, "memory_replies", 0);
    daemon_end(&d);
}
