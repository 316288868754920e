/* operator_test.c - what an operator sees: INFO's sections, the slow log, connected clients. */
#include "server/ops/stats.h"
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#define SQUARE "ADD t 0 0  4 0  4 4  0 4\nTRIANGULATE t\n"

/* The whole reply to a request on a connection of its own; the caller frees it. */
static char *reply_to(const struct daemon *d, const char *request)
{
    size_t n;
    char end[8] = "QUIT\n";
    int fd = daemon_connect(d);
    say(fd, request);
    say(fd, end);
    char *text = hear_all(fd, &n);
    close(fd);
    return text;
}

static void expect_part(const struct daemon *d, const char *request, const char *part)
{
    char *text = reply_to(d, request);
    CHECK_MSG(strstr(text, part) != NULL, "%s gives %s, without %s", request, text, part);
    free(text);
}

/* ---- time ---- */

TEST(time_in_the_queue_is_counted_apart_from_time_at_work)
{
    struct stats st;
    struct stats_pause p = {0};
    CHECK(stats_init(&st));
    stats_look(&st);
    stats_pause(&st, &p, true);
    pause_ms(30);
    stats_look(&st);
    stats_resume(&st, &p);
    pause_ms(2);
    struct stats_outcome took = stats_end(&st, &p, 3, false, false);
    CHECK(took.wait_ns >= 30000000 && took.work_ns >= 2000000 && p.began_ns == 0);
    CHECK(st.of[3].wait.total == 1 && st.of[3].work.total == 1 && st.of[3].calls == 1);
    CHECK(st.of[3].wait.max >= 30000000);
    took = stats_end(&st, &p, 3, false, true);
    CHECK(took.wait_ns == 0 && st.of[3].wait.total == 1 && st.of[3].errors == 1);
    stats_clear(&st);
}

TEST(quick_requests_share_the_time_of_their_run)
{
    struct stats st;
    struct stats_pause p = {0};
    CHECK(stats_init(&st));
    stats_look(&st);
    for (int i = 0; i < 10; i++) {
        stats_begin(&st, 5);
        stats_end(&st, &p, 5, true, false);
    }
    pause_ms(10);
    CHECK(st.of[5].calls == 10 && st.of[5].work.total == 0);
    stats_begin(&st, 6);
    CHECK(st.of[5].work.total == 10 && st.of[5].work.max >= 1000000 && st.run == 0);
    stats_clear(&st);
}

/* ---- INFO ---- */

TEST(info_returns_the_requested_sections)
{
    struct daemon d = daemon_start(NULL);
    converse(&d, "INFO Clients\n",
             "OK 9\nclients:1\nmax_clients:10000\nconnections:1\nrefused:0\n"
             "killed:0\nwrong_tokens:0\ndelayed_tokens:0\nwatchers:0\nevents:0\n");
    char *all = reply_to(&d, "INFO all\n"), *plain = reply_to(&d, "INFO\n");
    static const char *const keys[] = {"version:",  "clients:", "memory:",     "resident:",
                                       "commands:", "sets:",    "durability:", "command_INFO:"};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        CHECK_MSG(strstr(all, keys[i]) != NULL && strstr(plain, keys[i]) != NULL, "%s", keys[i]);
    char *some = reply_to(&d, "INFO memory sets\n");
    CHECK(strstr(some, "\nmemory_kept:0\n") != NULL);
    CHECK(strstr(some, "version:") == NULL && strstr(some, "\nsets:0\n") != NULL);
    free(some);
    free(all);
    free(plain);
}

TEST(info_shows_a_section_once_however_often_it_is_requested)
{
    enum { TIMES = 16000 };
    static char request[4 * TIMES + 16] = "INFO";
    struct daemon d = daemon_start(NULL);
    for (int i = 0; i < TIMES; i++)
        strcpy(request + 4 + 4 * i, " all");
    strcat(request, " clients\n");
    free(reply_to(&d, "INFO\n")); /* INFO shows the calls of INFO from then on */
    char *once = reply_to(&d, "INFO all\n"), *often = reply_to(&d, request);
    CHECK_MSG(strtol(often + 3, NULL, 10) == strtol(once + 3, NULL, 10), "%.40s", often);
    free(often);
    often = reply_to(&d, "INFO sets sets clients sets\n");
    CHECK_MSG(strncmp(often, "OK 12\nsets:", 11) == 0, "%s", often);
    free(often);
    free(once);
}

/* In RESP it is empty, as in Redis. */
TEST(info_of_an_unknown_section_is_refused_in_lines_and_empty_in_resp)
{
    struct daemon d = daemon_start(NULL);
    static const char resp[] = "*2\r\n$4\r\nINFO\r\n$5\r\na\0b\r\n\r\n*1\r\n$4\r\nPING\r\n";
    converse(&d, "INFO clients nosuch\n",
             "ERR SYNTAX INFO has no section nosuch; it has server clients memory stats sets "
             "durability replication commands all\n");
    int fd = daemon_connect(&d);
    say_bytes(fd, resp, sizeof resp - 1);
    expect(fd, "$0\r\n\r\n+PONG\r\n");
}

TEST(info_counts_every_command_with_its_errors)
{
    struct daemon d = daemon_start(NULL);
    converse(&d, "PING\nPING\n*1\r\n$4\r\nPING\r\nGET t 0\nFROB\nPING\n",
             "OK 0\nOK 0\n+PONG\r\nERR NOSET there is no set t\nERR UNKNOWN there is no command "
             "FROB; try HELP\nOK 0\n");
    expect_part(&d, "INFO commands\n", "\ncommand_PING:calls=4,errors=0,p50_us=");
    expect_part(&d, "INFO commands\n", "\ncommand_GET:calls=1,errors=1,p50_us=");
    expect_part(&d, "INFO commands\n", "\ncommand_OTHER:calls=1,errors=1,p50_us=");
    expect_part(&d, "INFO stats\n", "\nerrors:2\n");
    char *text = reply_to(&d, "INFO commands\n");
    CHECK(strstr(text, "command_CHECK") == NULL);
    free(text);
}

TEST(errors_of_heavy_requests_are_counted)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    char line[8000] = "DEL t";
    load_random(fd, "t", 1000);
    for (int i = 0; i < 1001; i++)
        sprintf(line + strlen(line), " %d", i);
    strcat(line, "\n");
    say(fd, line);
    expect(fd, "ERR NOPOINT there is no point 1000; nothing was deleted\n");
    CHECK(daemon_info(&d, "errors") == 1 && daemon_info(&d, "jobs") >= 1);
    expect_part(&d, "INFO commands\n", "\ncommand_DEL:calls=1,errors=1,");
    expect_part(&d, "INFO commands\n", "\ncommand_LOADB:calls=1,errors=0,");
}

TEST(request_whose_rows_come_in_pieces_is_counted_once)
{
    enum { N = 25000 };
    static const char *const arguments[] = {"--slowlog-us", "1", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    load_random(fd, "t", N);
    for (int i = 0; i < 3; i++) {
        char *rows = reply_to(&d, i < 2 ? "POINTS t\n" : "*2\r\n$6\r\nPOINTS\r\n$1\r\nt\r\n");
        CHECK(strncmp(rows, i < 2 ? "OK 25000" : "*25000\r", i < 2 ? 8 : 7) == 0);
        CHECK(strlen(rows) > N * 20);
        free(rows);
    }
    expect_part(&d, "INFO commands\n", "\ncommand_POINTS:calls=3,errors=0,");
    char *slow = reply_to(&d, "SLOWLOG GET -1\n");
    CHECK(strstr(slow, " POINTS t\n") != NULL);
    free(slow);
}

/* ---- SLOWLOG ---- */

TEST(slow_requests_are_kept_with_their_words)
{
    static const char *const arguments[] = {"--slowlog-us", "1", "--slowlog-len", "4", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    load_random(fd, "slow", 20000);
    say(fd, "TRIANGULATE slow METHOD divide\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=20000 ", 18) == 0);
    say(fd, "SLOWLOG GET 1\n");
    CHECK_STR(hear_line(fd), "OK 1");
    const char *row = hear_line(fd);
    CHECK_MSG(strstr(row, " TRIANGULATE slow METHOD divide") != NULL, "%s", row);
    CHECK(strstr(row, " addr=127.0.0.1:") != NULL && strstr(row, " wait_us=") != NULL);
    for (int i = 0; i < 6; i++) {
        say(fd, "CHECK slow\n");
        hear_line(fd);
    }
    say(fd, "SLOWLOG LEN\n");
    expect(fd, "OK 0 len=4\n");
    say(fd, "SLOWLOG GET -1\n");
    CHECK_STR(hear_line(fd), "OK 4");
    for (int i = 0; i < 4; i++)
        hear_line(fd);
    CHECK(daemon_info(&d, "slow") >= 8);
}

TEST(slow_loads_are_kept_with_their_first_line)
{
    static const char *const arguments[] = {"--slowlog-us", "1", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    load_random(fd, "big", 100000);
    say(fd, "SLOWLOG GET 1\n");
    CHECK_STR(hear_line(fd), "OK 1");
    CHECK(strstr(hear_line(fd), " LOADB big 100000") != NULL);
}

TEST(slowlog_keeps_no_tokens)
{
    static const char *const arguments[] = {"--slowlog-us", "1", NULL};
    struct daemon d = daemon_start(arguments);
    free(reply_to(
        &d, "AUTH secret\nTIMEOUT x AUTH secret\n*3\r\n$4\r\nauth\r\n$2\r\nme\r\n$6\r\nsecret\r\n"
            "*5\r\n$5\r\nHELLO\r\n$1\r\n3\r\n$4\r\nAUTH\r\n$2\r\nme\r\n$6\r\nsecret\r\n"));
    char *slow = reply_to(&d, "SLOWLOG GET -1\n");
    CHECK(strstr(slow, " AUTH\n") != NULL && strstr(slow, " TIMEOUT x AUTH\n") != NULL);
    CHECK(strstr(slow, " auth\n") != NULL);
    CHECK(strstr(slow, " HELLO 3 AUTH\n") != NULL && strstr(slow, "secret") == NULL);
    free(slow);
}

TEST(slowlog_can_be_cleared_and_switched_off)
{
    static const char *const off[] = {"--slowlog-us", "0", NULL};
    struct daemon d = daemon_start(off);
    int fd = daemon_connect(&d);
    say(fd, SQUARE "CHECK t\nSLOWLOG LEN\nSLOWLOG RESET\nSLOWLOG GET\nSLOWLOG FROB\n");
    expect(fd, "OK 0 first=0 added=4 coincident=0\n");
    hear_line(fd);
    hear_line(fd);
    expect(fd, "OK 0 len=0\nOK 0\nOK 0\nERR SYNTAX usage: SLOWLOG GET [n] | LEN | RESET\n");
}

TEST(slowlog_has_the_format_of_redis_in_resp)
{
    static const char *const arguments[] = {"--slowlog-us", "1", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    say(fd, SQUARE "*2\r\n$7\r\nSLOWLOG\r\n$5\r\nRESET\r\n");
    expect(fd, "OK 0 first=0 added=4 coincident=0\n");
    hear_line(fd);
    expect(fd, "+OK\r\n");
    say(fd, "*2\r\n$5\r\nCHECK\r\n$1\r\nt\r\n");
    expect(fd, "+OK delaunay=yes points=4 coincident=0 triangles=2 edges=5 hull=4\r\n");
    say(fd, "*3\r\n$7\r\nSLOWLOG\r\n$3\r\nGET\r\n$1\r\n1\r\n");
    expect(fd, "*1\r\n*6\r\n:");
    hear_line(fd); /* id, time, microseconds */
    hear_line(fd);
    hear_line(fd);
    expect(fd, "*2\r\n$5\r\nCHECK\r\n$1\r\nt\r\n$");
    hear_line(fd);
    CHECK(strncmp(hear_line(fd), "127.0.0.1:", 10) == 0);
    expect(fd, "$0\r\n\r\n");
    say(fd, "*2\r\n$7\r\nSLOWLOG\r\n$4\r\nFROB\r\n");
    expect(fd, "-SYNTAX usage: SLOWLOG GET [n] | LEN | RESET\r\n");
}

/* ---- CLIENT ---- */

static uint64_t id_of(int fd)
{
    uint64_t id;
    say(fd, "CLIENT ID\n");
    CHECK(sscanf(hear_line(fd), "OK 0 id=%" SCNu64, &id) == 1);
    return id;
}

TEST(clients_are_listed_with_their_names)
{
    struct daemon d = daemon_start(NULL);
    int a = daemon_connect(&d), b = daemon_connect(&d);
    say(a, "CLIENT SETNAME left\n");
    expect(a, "OK 0\n");
    say(b, "*3\r\n$6\r\nCLIENT\r\n$7\r\nSETNAME\r\n$5\r\nright\r\n");
    expect(b, "+OK\r\n");
    say(a, "CLIENT LIST\n");
    CHECK_STR(hear_line(a), "OK 2");
    bool left = false, right = false;
    for (int i = 0; i < 2; i++) {
        const char *row = hear_line(a);
        left = left || strstr(row, " name=left ") != NULL;
        right = right || (strstr(row, " name=right ") && strstr(row, " framing=resp state=idle "));
    }
    CHECK(left && right);
    say(b, "*2\r\n$6\r\nCLIENT\r\n$7\r\nGETNAME\r\n");
    expect(b, "$5\r\nright\r\n");
    say(b, "*3\r\n$6\r\nCLIENT\r\n$7\r\nSETNAME\r\n$3\r\na b\r\n");
    expect(b, "-SYNTAX a client name has at most 64 printable characters and no blank\r\n");
    say(b, "*2\r\n$6\r\nCLIENT\r\n$4\r\nLIST\r\n");
    expect(b, "$");
    hear_line(b);
    expect(b, "id=");
}

TEST(clients_are_listed_with_their_last_commands)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    static const char *const want[] = {" requests=0 command=", " requests=1 command=CLIENT",
                                       " requests=3 command=OTHER"};
    for (int i = 0; i < 3; i++) {
        say(fd, "CLIENT LIST\n");
        expect(fd, "OK 1\n");
        const char *row = hear_line(fd), *at = strstr(row, " requests=");
        CHECK_STR(at != NULL ? at : row, want[i]);
        if (i == 1) {
            say(fd, "FROB\n");
            expect(fd, "ERR UNKNOWN there is no command FROB; try HELP\n");
        }
    }
    close(fd);
}

TEST(clients_can_be_killed_by_id_and_by_address)
{
    struct daemon d = daemon_start(NULL);
    int me = daemon_connect(&d), a = daemon_connect(&d), b = daemon_connect(&d);
    char line[128], address[64];
    uint64_t id = id_of(a), other = id_of(b);
    snprintf(line, sizeof line, "CLIENT KILL %" PRIu64 "\n", id);
    say(me, line);
    expect(me, "OK 0 killed=1\n");
    expect_end(a);
    say(me, line);
    expect(me, "OK 0 killed=0\n");
    say(b, "CLIENT LIST\n");
    CHECK_STR(hear_line(b), "OK 2");
    bool found = false;
    for (int i = 0; i < 2; i++) {
        const char *row = hear_line(b), *at = strstr(row, " addr=");
        snprintf(line, sizeof line, "id=%" PRIu64 " ", other);
        if (strncmp(row, line, strlen(line)) == 0 && at != NULL)
            found = sscanf(at, " addr=%63s", address) == 1;
    }
    CHECK(found);
    snprintf(line, sizeof line, "CLIENT KILL ADDR %s\n", address);
    say(me, line);
    expect(me, "OK 0 killed=1\n");
    expect_end(b);
    CHECK(daemon_info(&d, "killed") == 2);
}

TEST(client_kill_refuses_a_word_that_is_neither_id_nor_address)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "CLIENT KILL ID 99999999999999999999999999999999999999999999999999999999\n"
            "CLIENT KILL ID 18446744073709551616\nCLIENT KILL ID 4294967296x\n"
            "CLIENT KILL TYPE 1\n"
            "CLIENT KILL ID 18446744073709551615\nCLIENT KILL unix\nCLIENT KILL ADDR 4294967296\n");
    for (int i = 0; i < 4; i++)
        CHECK(strncmp(hear_line(fd), "ERR SYNTAX usage: CLIENT ", 25) == 0);
    for (int i = 0; i < 3; i++)
        CHECK_STR(hear_line(fd), "OK 0 killed=0");
}

TEST(client_that_kills_itself_gets_its_reply)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    char line[128];
    snprintf(line, sizeof line, "CLIENT KILL ID %" PRIu64 "\nPING\n", id_of(fd));
    say(fd, line);
    expect(fd, "OK 0 killed=1\n");
    expect_end(fd);
}

TEST(client_that_is_killed_during_its_job_leaves_nothing)
{
    struct daemon d = daemon_start(NULL);
    int me = daemon_connect(&d), busy = daemon_connect(&d);
    char line[128];
    uint64_t id = id_of(busy);
    load_random(busy, "t", 300000);
    say(busy, "TRIANGULATE t METHOD shelling\n");
    snprintf(line, sizeof line, "CLIENT KILL %" PRIu64 "\n", id);
    say(me, line);
    expect(me, "OK 0 killed=1\n");
    await_info(&d, "jobs_running", 0);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(readers_may_not_manage_clients_or_see_the_slow_log)
{
    char path[] = "/tmp/delaunayd-tokens-XXXXXX";
    int file = mkstemp(path);
    CHECK(file >= 0 && write(file, "ro secret\n", 10) == 10);
    close(file);
    const char *arguments[] = {"--auth-file", path, NULL};
    struct daemon d = daemon_start(arguments);
    converse(
        &d,
        "CLIENT LIST\nAUTH secret\nCLIENT LIST\nCLIENT KILL 1\nSLOWLOG LEN\n"
        "CLIENT SETNAME x\n*2\r\n$7\r\nSLOWLOG\r\n$3\r\nLEN\r\n",
        "ERR NOAUTH authenticate first: AUTH token\nOK 0 role=ro\n"
        "ERR DENIED your token is for reading only\nERR DENIED your token is for reading only\n"
        "ERR DENIED your token is for reading only\nOK 0\n"
        "-DENIED your token is for reading only\r\n");
    unlink(path);
}
