/* keys_test.c - sets as the keys of Redis's commands, in conversations with a real daemon. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <unistd.h>

/* Sends the words of the text as a request in RESP. */
static void ask(int fd, const char *text)
{
    char words[1024], out[2048];
    size_t n = 0, len = 0;
    snprintf(words, sizeof words, "%s", text);
    for (char *w = words; *w != '\0'; w++)
        n += *w == ' ';
    len = (size_t)sprintf(out, "*%zu\r\n", n + 1);
    for (char *rest = words, *w = strsep(&rest, " "); w != NULL; w = strsep(&rest, " "))
        len += (size_t)sprintf(out + len, "$%zu\r\n%s\r\n", strlen(w), w);
    say_bytes(fd, out, len);
}

static void answers(int fd, const char *request, const char *want)
{
    ask(fd, request);
    expect(fd, want);
}

TEST(keys_are_sets)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    answers(fd, "DBSIZE", ":0\r\n");
    answers(fd, "KEYS *", "*0\r\n");
    answers(fd, "SCAN 0", "*2\r\n$1\r\n0\r\n*0\r\n");
    answers(fd, "ADD t 1 2", "+OK first=0 added=1 coincident=0\r\n");
    answers(fd, "DBSIZE", ":1\r\n");
    answers(fd, "EXISTS t u t", ":2\r\n");
    answers(fd, "TYPE t", "+pointset\r\n");
    answers(fd, "TYPE u", "+none\r\n");
    answers(fd, "KEYS T*", "*0\r\n");
    answers(fd, "KEYS [s-u]", "*1\r\n$1\r\nt\r\n");
    answers(fd, "MEMORY USAGE u", "$-1\r\n");
    ask(fd, "MEMORY USAGE t SAMPLES 0");
    CHECK(hear_line(fd)[0] == ':');
    answers(fd, "DROP t", "+OK\r\n");
    answers(fd, "DBSIZE", ":0\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(commands_about_keys_refuse_wrong_arguments)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    char request[400];
    answers(fd, "DBSIZE x", "-SYNTAX usage: DBSIZE\r\n");
    answers(fd, "EXISTS", "-SYNTAX usage: EXISTS set [set ...]\r\n");
    answers(fd, "TYPE", "-SYNTAX usage: TYPE set\r\n");
    answers(fd, "MEMORY DOCTOR", "-SYNTAX usage: MEMORY USAGE set\r\n");
    answers(fd, "KEYS", "-SYNTAX usage: KEYS pattern\r\n");
    answers(fd, "SCAN", "-SYNTAX usage: SCAN cursor [MATCH pattern] [COUNT n] [TYPE type]\r\n");
    answers(fd, "SCAN x", "-NUMBER that is not a cursor of SCAN\r\n");
    answers(fd, "SCAN 99999999999999999999", "-NUMBER that is not a cursor of SCAN\r\n");
    answers(fd, "SCAN 0 COUNT 0",
            "-SYNTAX SCAN takes MATCH pattern, COUNT n with n from 1 on, TYPE type\r\n");
    sprintf(request, "KEYS %0*d", 257, 0);
    answers(fd, request, "-SYNTAX a pattern has at most 256 bytes\r\n");
    sprintf(request, "SCAN 0 MATCH %0*d", 257, 0);
    answers(fd, request, "-SYNTAX a pattern has at most 256 bytes\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(keys_expire_as_in_redis)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    answers(fd, "CREATE t", "+OK\r\n");
    answers(fd, "TTL t", ":-1\r\n");
    answers(fd, "TTL u", ":-2\r\n");
    answers(fd, "EXPIRE u 10", ":0\r\n");
    answers(fd, "EXPIRE t 1000", ":1\r\n");
    ask(fd, "PTTL t");
    unsigned long left = strtoul(hear_line(fd) + 1, NULL, 10);
    CHECK(left > 900000 && left <= 1000000);
    ask(fd, "TTL t");
    left = strtoul(hear_line(fd) + 1, NULL, 10);
    CHECK(left > 900 && left <= 1000);
    answers(fd, "PERSIST t", ":1\r\n");
    answers(fd, "PERSIST t", ":0\r\n");
    answers(fd, "PERSIST u", ":0\r\n");
    answers(fd, "TTL t", ":-1\r\n");
    answers(fd, "EXPIRE t x", "-NUMBER x is not a number\r\n");
    answers(fd, "EXPIRE t/ 1", "-SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\r\n");
    ask(fd, "EXPIRE t 5 ZZ");
    CHECK(strncmp(hear_line(fd), "-SYNTAX usage: EXPIRE|PEXPIRE|", 30) == 0);
    ask(fd, "PTTL");
    CHECK(strncmp(hear_line(fd), "-SYNTAX usage: TTL|PTTL|", 24) == 0);
    answers(fd, "PERSIST", "-SYNTAX usage: PERSIST set\r\n");
    answers(fd, "EXPIRE t 0", ":1\r\n");
    answers(fd, "KEYS *", "*0\r\n");
    answers(fd, "EXISTS t", ":0\r\n");
    answers(fd, "DBSIZE", ":0\r\n");
    answers(fd, "PERSIST t", ":0\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

static int64_t number(int fd, const char *request)
{
    ask(fd, request);
    const char *line = hear_line(fd);
    CHECK_MSG(line[0] == ':', "%s", line);
    return strtoll(line + 1, NULL, 10);
}

TEST(expire_takes_the_conditions_and_units_of_redis)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    answers(fd, "CREATE t", "+OK\r\n");
    answers(fd, "EXPIRE t 100 XX", ":0\r\n");
    answers(fd, "EXPIRE t 100 GT", ":0\r\n"); /* never is later */
    answers(fd, "EXPIRE t 100 NX", ":1\r\n");
    answers(fd, "EXPIRE t 200 NX", ":0\r\n");
    answers(fd, "EXPIRE t 50 GT", ":0\r\n");
    answers(fd, "EXPIRE t 200 LT", ":0\r\n");
    answers(fd, "EXPIRE t 50 XX LT", ":1\r\n");
    CHECK(number(fd, "TTL t") >= 49 && number(fd, "TTL t") <= 50);
    answers(fd, "EXPIRE t 500 gt", ":1\r\n");
    answers(fd, "PERSIST t", ":1\r\n");
    answers(fd, "EXPIRE t 500 LT", ":1\r\n");
    ask(fd, "EXPIRE t 5 NX GT");
    CHECK(strncmp(hear_line(fd), "-SYNTAX ", 8) == 0);
    answers(fd, "PEXPIRE t 30000", ":1\r\n");
    CHECK(number(fd, "PTTL t") > 20000 && number(fd, "PTTL t") <= 30000);
    answers(fd, "EXPIREAT t 2000000000", ":1\r\n");
    answers(fd, "EXPIRETIME t", ":2000000000\r\n");
    answers(fd, "PEXPIREAT t 2000000000123", ":1\r\n");
    int64_t at = number(fd, "PEXPIRETIME t");
    CHECK_MSG(at >= 2000000000122 && at <= 2000000000125, "%lld", (long long)at);
    answers(fd, "EXPIREAT u 2000000000", ":0\r\n");
    answers(fd, "EXPIRETIME u", ":-2\r\n");
    answers(fd, "PEXPIRE t x", "-NUMBER x is not a number\r\n");
    answers(fd, "EXPIREAT t 1", ":1\r\n"); /* long ago */
    answers(fd, "EXISTS t", ":0\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(unlink_drops_sets_and_del_names_it)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    answers(fd, "CREATE t", "+OK\r\n");
    answers(fd, "ADD u 1 1 2 2", "+OK first=0 added=2 coincident=0\r\n");
    ask(fd, "DEL t");
    CHECK(strstr(hear_line(fd), "UNLINK set [set ...] or DROP set deletes sets") != NULL);
    ask(fd, "DEL t u");
    CHECK(strstr(hear_line(fd), "DEL deletes points") != NULL);
    ask(fd, "DEL u 1");
    CHECK(strncmp(hear_line(fd), "+OK deleted=1 ", 14) == 0);
    answers(fd, "UNLINK t x u t a/b", ":2\r\n");
    answers(fd, "UNLINK t", ":0\r\n");
    answers(fd, "DBSIZE", ":0\r\n");
    say(fd, "UNLINK t\n");
    expect(fd, "ERR UNKNOWN there is no command UNLINK; try HELP\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* A stream that is not read keeps its set from being dropped for a while only if it must; a build does. */
TEST(unlink_counts_a_set_for_which_it_had_to_wait)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    answers(fd, "CREATE a", "+OK\r\n");
    load_random(fd, "b", 300000);
    answers(fd, "CREATE c", "+OK\r\n");
    await_info(&d, "jobs_running", 0);
    uint64_t jobs = daemon_info(&d, "jobs");
    say(other, "TRIANGULATE b\n");
    while (daemon_info(&d, "jobs") == jobs)
        pause_ms(1);
    answers(fd, "UNLINK a b c", ":3\r\n");
    CHECK(strncmp(hear_line(other), "OK 0 points=", 12) == 0);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* Reads an array of names `set<i>` and counts each in seen[]; returns how many there are. */
static size_t hear_names(int fd, int *seen)
{
    size_t n = strtoul(hear_line(fd) + 1, NULL, 10);
    for (size_t i = 0; i < n; i++) {
        hear_line(fd);
        const char *name = hear_line(fd);
        CHECK(strncmp(name, "set", 3) == 0);
        seen[strtoul(name + 3, NULL, 10)]++;
    }
    return n;
}

static size_t scan_all(int fd, const char *options, int *seen)
{
    char cursor[64] = "0", request[200];
    size_t n = 0;
    do {
        snprintf(request, sizeof request, "SCAN %s%s", cursor, options);
        ask(fd, request);
        hear_line(fd);
        hear_line(fd);
        snprintf(cursor, sizeof cursor, "%s", hear_line(fd));
        cursor[strcspn(cursor, "\r")] = '\0';
        n += hear_names(fd, seen);
    } while (strcmp(cursor, "0") != 0);
    return n;
}

/* More sets than KEYS lists in one piece. */
TEST(keys_scan_and_keys_find_every_set_once)
{
    enum { N = 3000 };
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), seen[N] = {0};
    char line[64];
    for (int i = 0; i < N; i++) {
        sprintf(line, "CREATE set%d\n", i);
        say(fd, line);
        expect(fd, "OK 0\n");
    }
    CHECK(scan_all(fd, "", seen) == N);
    CHECK(scan_all(fd, " COUNT 1000 TYPE pointset", seen) == N);
    CHECK(scan_all(fd, " MATCH set[0-9] COUNT 5", seen) == 10);
    CHECK(scan_all(fd, " TYPE string COUNT 1000", seen) == 0);
    ask(fd, "KEYS *");
    CHECK(hear_names(fd, seen) == N);
    for (int i = 0; i < N; i++)
        CHECK(seen[i] == (i < 10 ? 4 : 3));
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* SCAN finds each set that exists from the first SCAN to the last, while other sets are created. */
TEST(keys_scan_misses_no_set_while_others_are_created)
{
    enum { N = 100, ALL = 1000 };
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), seen[ALL] = {0}, made = 0;
    char request[64], cursor[64] = "0";
    do {
        for (int i = made == 0 ? 0 : N - 20; i < N && made < ALL; i++) {
            sprintf(request, "CREATE set%d\n", made++);
            say(fd, request);
            expect(fd, "OK 0\n");
        }
        sprintf(request, "SCAN %.40s COUNT 5", cursor);
        ask(fd, request);
        hear_line(fd);
        hear_line(fd);
        snprintf(cursor, sizeof cursor, "%s", hear_line(fd));
        cursor[strcspn(cursor, "\r")] = '\0';
        hear_names(fd, seen);
    } while (strcmp(cursor, "0") != 0);
    for (int i = 0; i < ALL; i++)
        CHECK_MSG(i < N ? seen[i] == 1 : seen[i] <= 1, "%d %d", i, seen[i]);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* ---- transactions ---- */

TEST(what_follows_multi_is_queued_and_never_carried_out)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    answers(fd, "MULTI", "+OK\r\n");
    answers(fd, "ADD t 1 2", "+QUEUED\r\n");
    answers(fd, "PING", "+QUEUED\r\n");
    answers(fd, "UNLINK t", "+QUEUED\r\n");
    answers(fd, "MULTI", "-ERR MULTI calls can not be nested\r\n");
    ask(fd, "FOO");
    CHECK(strncmp(hear_line(fd), "-ERR unknown command 'FOO'", 26) == 0);
    ask(fd, "EXEC");
    CHECK(strncmp(hear_line(fd), "-EXECABORT there are no transactions", 36) == 0);
    answers(fd, "EXISTS t", ":0\r\n");
    answers(fd, "EXEC", "-ERR EXEC without MULTI\r\n");
    answers(fd, "DISCARD", "-ERR DISCARD without MULTI\r\n");
    ask(fd, "MULTI");
    hear_line(fd);
    answers(fd, "DISCARD", "+OK\r\n");
    answers(fd, "PING", "+PONG\r\n");
    ask(fd, "WATCH t");
    CHECK(strncmp(hear_line(fd), "-UNKNOWN ", 9) == 0);
    answers(fd, "UNWATCH", "+OK\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* The points are not read as requests. */
TEST(multi_skips_bodies_and_continues_after_them)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    ask(fd, "MULTI");
    hear_line(fd);
    say(fd, "*4\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$1\r\n2\r\n$7\r\n1 2\n3 4\r\n");
    expect(fd, "+QUEUED\r\n");
    say(fd, "*3\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$1\r\n2\r\n1 2\n3 4\n");
    expect(fd, "+QUEUED\r\n");
    ask(fd, "EXEC");
    CHECK(strncmp(hear_line(fd), "-EXECABORT ", 11) == 0);
    answers(fd, "DBSIZE", ":0\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* ---- what libraries send by habit ---- */

TEST(wait_has_milliseconds_and_answers_with_a_number)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    answers(fd, "WAIT 0 0", ":0\r\n");
    answers(fd, "WAIT 1 5", ":0\r\n");
    answers(fd, "WAIT 1 x", "-ERR timeout is not an integer or out of range\r\n");
    answers(fd, "WAIT 1", "-ERR wrong number of arguments for 'wait' command\r\n");
    answers(fd, "WAIT x 1", "-NUMBER x is not a number of followers\r\n");
    say(fd, "WAIT 0 1\n");
    expect(fd, "OK 0 followers=0\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(unknown_commands_are_quoted_as_in_redis)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    answers(fd, "SET a b", "-ERR unknown command 'SET', with args beginning with: 'a' 'b' \r\n");
    answers(fd, "subscribe x",
            "-ERR unknown command 'subscribe', with args beginning with: 'x' \r\n");
    say(fd, "SET a b\n");
    expect(fd, "ERR UNKNOWN there is no command SET; try HELP\n");
    char request[700];
    sprintf(request, "FOO %0200d %0200d", 0, 0);
    ask(fd, request);
    CHECK(strlen(hear_line(fd)) < 400);
    say(fd,
        "*5\r\n$3\r\nFOO\r\n$5\r\nLOADB\r\n$1\r\nt\r\n$1\r\n1\r\n$1\r\nx\r\n"); /* a body may follow */
    hear_line(fd);
    expect_end(fd);
    close(fd);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(small_requests_of_libraries_are_answered)
{
    static const struct {
        const char *request, *reply;
    } asked[] = {
        {"CLIENT NO-EVICT ON", "+OK"},
        {"CLIENT NO-TOUCH off", "+OK"},
        {"CLIENT TRACKING OFF", "+OK"},
        {"CLIENT TRACKING ON", "-ERR there is no client-side caching; WATCH set follows a set"},
        {"CLIENT REPLY ON", "+OK"},
        {"CLIENT REPLY OFF", "-ERR every request has a reply"},
        {"CLIENT GETREDIR", ":-1"},
        {"CLIENT SETINFO lib-name x", "+OK"},
        {"READONLY", "-ERR This instance has cluster support disabled"},
        {"CLUSTER INFO", "-ERR This instance has cluster support disabled"},
        {"LATENCY LATEST", "*0"},
        {"LATENCY RESET", ":0"},
        {"MODULE LIST", "*0"},
        {"COMMAND DOCS", "*0"},
        {"OBJECT IDLETIME t", "$-1"},
        {"TOUCH t", ":0"},
        {"SELECT 0", "+OK"},
        {"HELLO 4", "-NOPROTO this server speaks RESP 2 and 3"},
        {"RESET", "+RESET"},
    };
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    for (size_t i = 0; i < sizeof asked / sizeof asked[0]; i++) {
        char want[120];
        snprintf(want, sizeof want, "%s\r\n", asked[i].reply);
        answers(fd, asked[i].request, want);
    }
    ask(fd, "TIME");
    CHECK_STR(hear_line(fd), "*2\r");
    for (int i = 0; i < 4; i++)
        hear_line(fd);
    answers(fd, "ROLE", "*3\r\n$6\r\nmaster\r\n:0\r\n*0\r\n");
    answers(fd, "COMMAND INFO nonsense", "*1\r\n$-1\r\n");
    ask(fd, "CLIENT INFO");
    hear_line(fd);
    const char *row = hear_line(fd);
    CHECK_MSG(strncmp(row, "id=", 3) == 0 && strstr(row, " multi=-1 ") && strstr(row, " resp=2"),
              "%s", row);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(reset_takes_the_role_the_name_the_types_and_the_transaction)
{
    char path[] = "/tmp/delaunayd-tokens-XXXXXX";
    int file = mkstemp(path);
    CHECK(file >= 0 && write(file, "rw secret\n", 10) == 10);
    close(file);
    const char *arguments[] = {"--auth-file", path, NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    answers(fd, "AUTH default secret", "+OK\r\n");
    answers(fd, "CLIENT SETNAME x", "+OK\r\n");
    ask(fd, "HELLO 3");
    while (strcmp(hear_line(fd), "modules\r") != 0)
        continue;
    expect(fd, "*0\r\n");
    answers(fd, "MULTI", "+OK\r\n");
    answers(fd, "RESET", "+RESET\r\n");
    ask(fd, "DBSIZE");
    CHECK(strncmp(hear_line(fd), "-NOAUTH ", 8) == 0);
    answers(fd, "AUTH wrong", "-WRONGPASS invalid username-password pair or user is disabled.\r\n");
    answers(fd, "AUTH secret", "+OK\r\n");
    answers(fd, "CLIENT GETNAME", "$-1\r\n");
    unlink(path);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* Exporters take the sections apart by their headings, and clients wait while `loading` is not 0. */
TEST(info_in_resp_has_sections_and_no_name_twice)
{
    static const char *const parts[] = {
        "# Server\r\nredis_version:7.0.0\r\n",
        "\r\n\r\n# Clients\r\nconnected_clients:1\r\n",
        "\r\n# Persistence\r\nloading:0\r\n",
        "\r\n# Durability\r\ndurability:off\r\n",
        "\r\ndelaunayd_loading:0\r\n",
        "\r\nrole:master\r\n",
        "\r\ndelaunayd_role:leader\r\n",
        "\r\n# Commandstats\r\ncmdstat_create:calls=1,usec=",
        "\r\n# Cluster\r\ncluster_enabled:0\r\n\r\n# Keyspace\r\ndb0:keys=1,"};
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    size_t n;
    answers(fd, "CREATE t", "+OK\r\n");
    answers(fd, "INFO keyspace", "$44\r\n# Keyspace\r\ndb0:keys=1,expires=0,avg_ttl=0\r\n\r\n");
    answers(fd, "INFO nonsense", "$0\r\n\r\n");
    ask(fd, "INFO");
    ask(fd, "QUIT");
    char *got = hear_all(fd, &n);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        CHECK_MSG(strstr(got, parts[i]) != NULL, "%s", parts[i]);
    for (char *rest = got, *line; (line = strsep(&rest, "\n")) != NULL && rest != NULL;) {
        char key[80];
        const char *colon = strchr(line, ':');
        if (colon == NULL || colon - line > 60)
            continue;
        snprintf(key, sizeof key, "\n%.*s:", (int)(colon - line), line);
        CHECK_MSG(strstr(rest, key) == NULL, "%s", key);
    }
    free(got);
    close(fd);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(info_in_resp_has_the_keys_that_redis_cli_stat_reads)
{
    static const char *const keys[] = {"connected_clients:1\r\n",
                                       "blocked_clients:0\r\n",
                                       "used_memory:",
                                       "total_commands_processed:",
                                       "total_connections_received:",
                                       "db0:keys=1,expires=0,avg_ttl=0\r\n"};
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    size_t n;
    answers(fd, "CREATE t", "+OK\r\n");
    ask(fd, "INFO");
    ask(fd, "QUIT");
    char *got = hear_all(fd, &n);
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        CHECK_MSG(strstr(got, keys[i]) != NULL, "%s", keys[i]);
    free(got);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}
