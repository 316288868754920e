/* config_test.c - settings that change while the daemon runs, and reloading tokens. */
#include "server/ops/auth.h"
#include "server/ops/glob.h"
#include "server/ops/setting.h"
#include "tests/server/daemon.h"
#include "tests/server/said.h"
#include "tests/test.h"

#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

static bool matches(const char *name, const char *pattern)
{
    return glob_matches(pattern, strlen(pattern), name, strlen(name), GLOB_CASELESS);
}

TEST(patterns_of_settings_match_names)
{
    CHECK(matches("port", "port") && matches("port", "PORT") && !matches("port", "por"));
    CHECK(!matches("port", "ports") && !matches("port", "") && matches("", ""));
    CHECK(matches("max-memory", "*") && matches("max-memory", "max*") && matches("", "**"));
    CHECK(matches("max-memory", "*mem*y") && !matches("max-memory", "*mem*x"));
    CHECK(matches("max-memory", "m?x?mem*") && !matches("max", "????") && !matches("max", "max?"));
    CHECK(matches("abab", "*ab") && matches("aab", "*ab") && !matches("aba", "*ab"));
}

TEST(pattern_of_many_stars_is_matched_quickly)
{
    static char pattern[60000];
    for (size_t i = 0; i < sizeof pattern; i += 2)
        memcpy(pattern + i, "*a", 2);
    for (int i = 0; i < 100; i++)
        CHECK(!glob_matches(pattern, sizeof pattern, "aaaaaaaaaaaaaaaaaaaaaaaaaaaaab", 30,
                            GLOB_CASELESS));
}

/* The name after the two dashes of a line of --help; "" if the line has no flag. */
static const char *flag_of(const char *line)
{
    static char name[40];
    size_t n = strncmp(line, "  --", 4) == 0 ? strcspn(line + 4, " \n") : 0;
    snprintf(name, sizeof name, "%.*s", (int)n, line + 4);
    return name;
}

TEST(every_flag_is_a_setting)
{
    char line[200];
    size_t flags = 0;
    FILE *f = popen("\"$DELAUNAYD\" --help", "r");
    CHECK(f != NULL);
    while (fgets(line, sizeof line, f) != NULL) {
        const char *name = flag_of(line);
        bool other = strcmp(name, "check") == 0 || strcmp(name, "repair") == 0 ||
                     strcmp(name, "commands") == 0 || strcmp(name, "version") == 0 ||
                     strcmp(name, "help") == 0;
        if (*name == '\0' || other)
            continue;
        CHECK_MSG(setting_find(name, strlen(name)) != NULL, "%s is no setting", name);
        flags++;
    }
    CHECK(pclose(f) == 0 && flags == setting_count);
}

static void ask(int fd, const char *request, const char *want)
{
    say(fd, request);
    CHECK_STR(hear_line(fd), want);
}

TEST(settings_that_change_take_effect_at_once)
{
    const char *arguments[] = {"--max-clients", "1", "--slowlog-us", "0", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    ask(fd, "PING\n", "OK 0");
    int second = daemon_connect(&d);
    CHECK_STR(hear_line(second), "ERR BUSY too many clients");
    close(second);
    ask(fd, "CONFIG SET max-clients 2\n", "OK 0");
    second = daemon_connect(&d);
    ask(second, "PING\n", "OK 0");

    load_random(fd, "u", 20000); /* they take more memory than that */
    ask(fd, "CONFIG SET max-memory 256k max-points 2\n", "OK 0");
    ask(fd, "ADD t 1 1  2 2  3 3\n", "ERR TOOBIG a set holds at most 2 points (--max-points)");
    CHECK(strncmp(hear_line((say(fd, "ADD t 1 1\n"), fd)), "ERR NOMEM ", 10) == 0);
    ask(fd, "CONFIG SET max-memory 1g\n", "OK 0");
    ask(fd, "ADD t 1 1\n", "OK 0 first=0 added=1 coincident=0");

    ask(fd, "CONFIG SET slowlog-us 1 slowlog-len 2\n", "OK 0");
    for (int i = 0; i < 5; i++)
        ask(fd, "STAT t\n", hear_line((say(fd, "STAT t\n"), fd)));
    ask(fd, "SLOWLOG LEN\n", "OK 0 len=2");
    ask(fd, "CONFIG SET slowlog-len 100\n", "OK 0");
    ask(fd, "SLOWLOG GET 1\n", "OK 1");
    CHECK(strstr(hear_line(fd), " CONFIG SET slowlog-len 100") != NULL);
    ask(fd, "CONFIG SET slowlog-len 1\n", "OK 0");
    ask(fd, "SLOWLOG GET\n", "OK 1");
    CHECK(strstr(hear_line(fd), " CONFIG SET slowlog-len 1") != NULL);

    ask(second, "CONFIG SET idle-timeout 1\n", "OK 0");
    CHECK_STR(hear_line(second), "ERR TIMEOUT idle for too long");
}

TEST(settings_are_changed_all_or_none)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    ask(fd, "CONFIG SET max-points 7 slowlog-len many\n",
        "ERR RANGE slowlog-len many: from 0 to 1000000");
    ask(fd, "CONFIG SET max-points 7 port 1\n",
        "ERR SYNTAX port cannot be changed while the server runs");
    ask(fd, "CONFIG SET max-points 7 speed high\n",
        "ERR SYNTAX there is no setting speed; try CONFIG GET *");
    ask(fd, "CONFIG GET max-points slowlog-len\n", "OK 2");
    CHECK_STR(hear_line(fd), "max-points 268435455");
    CHECK_STR(hear_line(fd), "slowlog-len 128");
    ask(fd, "CONFIG SET max-points 7 slowlog-len 3\n", "OK 0");
    ask(fd, "CONFIG GET max-points slowlog-len\n", "OK 2");
    CHECK_STR(hear_line(fd), "max-points 7");
    CHECK_STR(hear_line(fd), "slowlog-len 3");
}

/* With nothing for replies and clients, nobody could connect to undo it. */
TEST(least_memory_that_can_be_set_lets_a_client_connect_and_raise_it)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 100000);
    ask(fd, "CONFIG SET max-memory 1\n",
        "ERR RANGE max-memory 1: bytes, at least 256k, as in 4096m or 2g");
    ask(fd, "CONFIG SET max-memory 262143\n",
        "ERR RANGE max-memory 262143: bytes, at least 256k, as in 4096m or 2g");
    ask(fd, "CONFIG SET max-memory 262144\n", "OK 0");
    close(fd);
    fd = daemon_connect(&d);
    ask(fd, "CONFIG SET max-memory 1g\n", "OK 0");
}

TEST(limit_of_clients_is_not_raised_beyond_the_limit_of_descriptors)
{
    struct daemon d = daemon_start(NULL);
    struct rlimit few = {200, 200};
    int fd = daemon_connect(&d);
    CHECK(prlimit(d.pid, RLIMIT_NOFILE, &few, NULL) == 0);
    ask(fd, "CONFIG SET max-clients 100\n", "OK 0");
    ask(fd, "CONFIG SET max-clients 1000\n",
        "ERR RANGE max-clients 1000: there are descriptors for 168");
    ask(fd, "CONFIG SET max-clients 168\n", "OK 0");
}

TEST(settings_have_the_format_of_redis_in_resp)
{
    struct daemon d = daemon_start(NULL);
    converse(&d,
             "*4\r\n$6\r\nCONFIG\r\n$3\r\nSET\r\n$9\r\nmaxmemory\r\n$2\r\n1g\r\n"
             "*4\r\n$6\r\nconfig\r\n$3\r\nget\r\n$9\r\nmaxmemory\r\n$4\r\nsave\r\n"
             "*3\r\n$6\r\nCONFIG\r\n$3\r\nGET\r\n$8\r\nMAX-MEM*\r\n"
             "*3\r\n$6\r\nCONFIG\r\n$3\r\nGET\r\n$4\r\nno*e\r\n"
             "*4\r\n$6\r\nCONFIG\r\n$3\r\nSET\r\n$4\r\nport\r\n$1\r\n7\r\n"
             "*2\r\n$6\r\nCONFIG\r\n$6\r\nRELOAD\r\n",
             "+OK\r\n"
             "*4\r\n$9\r\nmaxmemory\r\n$10\r\n1073741824\r\n$4\r\nsave\r\n$0\r\n\r\n"
             "*2\r\n$10\r\nmax-memory\r\n$10\r\n1073741824\r\n"
             "*0\r\n"
             "-SYNTAX port cannot be changed while the server runs\r\n"
             "-SYNTAX there is no --auth-file to reload\r\n");
}

/* ---- tokens ---- */

static char token_path[] = "/tmp/delaunayd-test-XXXXXX";

static void write_tokens(const char *text)
{
    FILE *f = fopen(token_path, "w");
    CHECK(f != NULL && fputs(text, f) >= 0 && fclose(f) == 0);
}

static struct daemon start_with_tokens(const char *text)
{
    const char *arguments[] = {"--auth-file", token_path, "--log-level", "info", NULL};
    CHECK(close(mkstemp(token_path)) == 0);
    write_tokens(text);
    return daemon_start(arguments);
}

static int connect_as(const struct daemon *d, const char *token, const char *want)
{
    char request[100];
    int fd = daemon_connect(d);
    snprintf(request, sizeof request, "AUTH %s\n", token);
    ask(fd, request, want);
    return fd;
}

TEST(tokens_are_reloaded_on_sighup)
{
    struct daemon d = start_with_tokens("rw one\nrw two\nro three\n");
    int one = connect_as(&d, "one", "OK 0 role=rw"), two = connect_as(&d, "two", "OK 0 role=rw");
    int three = connect_as(&d, "three", "OK 0 role=ro"), stranger = daemon_connect(&d);
    write_tokens("# two is gone\nrw three\n\nro one\nrw four\n");
    CHECK(kill(d.pid, SIGHUP) == 0);
    expect_end(two);
    ask(one, "CREATE t\n", "ERR DENIED your token is for reading only");
    ask(three, "CREATE t\n", "OK 0");
    ask(stranger, "AUTH two\n", "ERR DENIED no such token");
    ask(stranger, "AUTH four\n", "OK 0 role=rw");
    daemon_end(&d);
    unlink(token_path);
}

/* Tokens of up to three letters, some of them twice. */
static struct auth random_tokens(char name[][4], size_t n)
{
    char text[4000], *to = text;
    struct auth a;
    for (size_t i = 0; i < n; i++) {
        uint32_t letters = 1 + test_below(3);
        memset(name[i], 0, 4);
        for (uint32_t k = 0; k < letters; k++)
            name[i][k] = (char)('a' + test_below(3));
        to += sprintf(to, "%s %s\n", test_below(2) == 0 ? "ro" : "rw", name[i]);
    }
    write_tokens(text);
    CHECK(auth_load(&a, token_path));
    return a;
}

TEST(tokens_are_found_again_after_a_reload_as_a_client_would_find_them)
{
    enum { TOKENS = 30 };
    char old[TOKENS][4], fresh[TOKENS][4];
    CHECK(close(mkstemp(token_path)) == 0);
    for (int round = 0; round < 50; round++) {
        unsigned number[TOKENS];
        struct auth before = random_tokens(old, 1 + test_below(TOKENS)),
                    now = random_tokens(fresh, 1 + test_below(TOKENS));
        CHECK(auth_renumber(&now, &before, number));
        for (size_t i = 0; i < before.n; i++) {
            unsigned want;
            struct word w = {old[i], strlen(old[i])};
            CHECK(auth_role(&now, number[i]) == auth_check(&now, &w, &want) && number[i] == want);
        }
        auth_clear(&before);
        auth_clear(&now);
    }
    unlink(token_path);
}

TEST(tokens_stay_when_the_new_file_is_invalid)
{
    static const char *const bad[] = {"", "# none\n", "rw\n", "rw one\nwr two\n", "rw a b\n"};
    struct said said = said_begin();
    struct daemon d = start_with_tokens("rw one\n");
    said_end(&said);
    int one = connect_as(&d, "one", "OK 0 role=rw");
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        write_tokens(bad[i]);
        ask(one, "CONFIG RELOAD\n",
            "ERR IO the token file is not valid; the old tokens stay: see the log");
        close(connect_as(&d, "one", "OK 0 role=rw"));
    }
    unlink(token_path);
    ask(one, "CONFIG RELOAD\n",
        "ERR IO the token file is not valid; the old tokens stay: see the log");
    close(connect_as(&d, "one", "OK 0 role=rw"));
    daemon_end(&d);
    CHECK(said_lines(&said, ": the old tokens stay") == sizeof bad / sizeof bad[0] + 1);
}

TEST(client_that_removes_its_own_token_gets_its_reply)
{
    struct daemon d = start_with_tokens("rw one\n");
    int one = connect_as(&d, "one", "OK 0 role=rw");
    write_tokens("ro two\nrw three\n");
    ask(one, "CONFIG RELOAD\nCREATE t\n", "OK 0 tokens=2");
    expect_end(one);
    close(connect_as(&d, "two", "OK 0 role=ro"));
    unlink(token_path);
}

TEST(readers_may_see_settings_but_not_change_them)
{
    struct daemon d = start_with_tokens("ro one\nrw two\n");
    int one = connect_as(&d, "one", "OK 0 role=ro");
    ask(one, "CONFIG GET log-level\n", "OK 1");
    CHECK_STR(hear_line(one), "log-level info");
    ask(one, "CONFIG SET log-level error\n", "ERR DENIED your token is for reading only");
    ask(one, "CONFIG RELOAD\n", "ERR DENIED your token is for reading only");
    int stranger = daemon_connect(&d);
    ask(stranger, "CONFIG GET log-level\n", "ERR NOAUTH authenticate first: AUTH token");
    unlink(token_path);
}

TEST(sighup_of_a_daemon_without_tokens_changes_nothing)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    CHECK(kill(d.pid, SIGHUP) == 0);
    ask(fd, "CREATE t\n", "OK 0");
    daemon_end(&d);
}
