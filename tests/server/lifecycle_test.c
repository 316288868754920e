/* lifecycle_test.c - starting, stopping, vanishing clients, and running out of system resources. */
#include "server/commands.h"
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- flags ---- */

/* Runs the daemon's program to its end; returns its exit status and what it printed on either
 * stream. */
static int run(const char *flag, const char *value, char *text, size_t size)
{
    int out[2], status;
    CHECK(pipe(out) == 0);
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0) {
        dup2(out[1], STDOUT_FILENO);
        dup2(out[1], STDERR_FILENO);
        execl(getenv("DELAUNAYD"), "delaunayd", flag, value, NULL);
        _exit(127);
    }
    close(out[1]);
    size_t n = 0;
    for (ssize_t more; (more = read(out[0], text + n, size - 1 - n)) > 0;)
        n += (size_t)more;
    text[n] = '\0';
    close(out[0]);
    CHECK(waitpid(pid, &status, 0) == pid && WIFEXITED(status));
    return WEXITSTATUS(status);
}

TEST(help_and_version_are_printed)
{
    char text[4096];
    CHECK(run("--version", NULL, text, sizeof text) == 0);
    CHECK_STR(text, "delaunayd 1.0.0\n");
    CHECK(run("--help", NULL, text, sizeof text) == 0);
    CHECK(strstr(text, "--max-memory") != NULL);
}

/* Texts that contain neither quotes nor backslashes nor control characters are JSON without escapes. */
static bool is_plain(const char *text)
{
    while (*text >= ' ' && *text != '"' && *text != '\\')
        text++;
    return *text == '\0';
}

TEST(commands_are_printed_once_each_as_json)
{
    static char text[1 << 16];
    const char *at = text;
    CHECK(run("--commands", NULL, text, sizeof text) == 0);
    for (size_t i = 0; i < command_count; i++) {
        const struct command *c = &commands[i];
        char start[1024];
        CHECK_MSG(is_plain(c->name) && is_plain(c->usage) && is_plain(c->help), "%s", c->name);
        int n =
            snprintf(start, sizeof start,
                     "%s\n{\"name\": \"%s\", \"usage\": \"%s\", \"help\": \"%s\", \"least\": %u, ",
                     i == 0 ? "[" : ",", c->name, c->usage, c->help, c->least);
        CHECK_MSG(strncmp(at, start, (size_t)n) == 0, "%s: %.200s", c->name, at);
        at += n + (int)strcspn(at + n, "}") + 1;
    }
    CHECK_STR(at, "\n]\n");
    const char *row = strstr(text, "{\"name\": \"DEL\""), *end = strchr(row, '\n');
    const char *least =
        strstr(row, "\"least\": 3, \"most\": null, \"role\": \"rw\", \"about\": \"set\", ");
    const char *exists = strstr(row, "\"exists\": true, \"changes\": true, \"body\": null}");
    CHECK(least != NULL && exists != NULL && least < exists && exists < end);
}

TEST(invalid_flags_are_refused)
{
    static const char *const bad[][2] = {
        {"--port", "65536"},     {"--port", "x"},        {"--bind", "localhost"},
        {"--threads", "0"},      {"--bind", "::2"},      {"--bind", "0.0.0.0"},
        {"--max-clients", "0"},  {"--max-points", "-1"}, {"--frob", NULL},
        {"--max-memory", "1gq"}, {"extra", NULL},        {"--fsync", "never"},
        {"--compact-at", "0"},   {"--port", NULL},       {"--max-memory", "999999999999g"},
        {"--max-memory", "255k"}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char text[4096];
        CHECK_MSG(run(bad[i][0], bad[i][1], text, sizeof text) == 2, "%s %s", bad[i][0], bad[i][1]);
        CHECK(strncmp(text, "delaunayd", 9) == 0 || strstr(text, "delaunayd: ") != NULL);
    }
}

TEST(port_in_use_is_reported)
{
    char port[16], text[512];
    struct daemon d = daemon_start(NULL);
    snprintf(port, sizeof port, "%u", d.port);
    CHECK(run("--port", port, text, sizeof text) == 1);
    CHECK(test_names_error(text, "cannot listen on 127.0.0.1", EADDRINUSE));
}

TEST(unix_socket_serves_too)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/delaunayd-test-%d.sock", (int)getpid());
    const char *arguments[] = {"--unix", path, NULL};
    for (int round = 0; round < 2; round++) { /* the second finds a socket that was left behind */
        struct daemon d = daemon_start(arguments);
        int fd = connect_unix(path);
        CHECK(fd >= 0);
        say(fd, "ADD t 1 1\n");
        expect(fd, "OK 0 first=0 added=1 coincident=0\n");
        say(fd, "LISTS t\nGET t 0");
        close(fd); /* fully: what was sent is carried out all the same */
        converse(&d, "GET t 0\n", "OK 1\n0 1 1\n");
        CHECK(daemon_stop(&d, round == 0 ? SIGKILL : SIGTERM) == (round == 0 ? -1 : 0));
    }
    CHECK(access(path, F_OK) != 0);
}

/* ---- stopping ---- */

TEST(idle_daemon_stops_at_once)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "PING\n");
    expect(fd, "OK 0\n");
    double start = seconds();
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    CHECK(seconds() - start < 2);
    expect_end(fd);
}

TEST(daemon_that_stops_finishes_what_it_has_received)
{
    enum { REQUESTS = 50000 };
    size_t n, lines = 0;
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 200000);
    char *text = malloc(REQUESTS * 10 + 100);
    say(fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    for (int i = 0; i < REQUESTS; i++)
        strcpy(text + i * 8, "GET t 0\n");
    say(fd, text);
    say(fd, "LISTS t\nGET t 1"); /* and a line that may have been cut */
    free(text);
    CHECK(kill(d.pid, SIGINT) == 0);
    text = hear_all(fd, &n);
    for (size_t i = 0; i < n; i++) {
        bool comment = text[i] == '#' && (i == 0 || text[i - 1] == '\n');
        lines += text[i] == '\n';
        lines -= comment;
    }
    CHECK_MSG(lines == 2 * REQUESTS + 200001, "%zu lines", lines);
    free(text);
    int status;
    CHECK(waitpid(d.pid, &status, 0) == d.pid && WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(daemon_that_stops_cancels_builds_and_finishes_edits)
{
    size_t n;
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    load_random(fd, "t", 1000000);
    say(other, "ADD other 0 0\n");
    CHECK(strncmp(hear_line(other), "OK 0", 4) == 0);
    say(fd, "TRIANGULATE t METHOD shelling\nTRIANGULATE t METHOD shelling\nGET t 0\n");
    pause_ms(50);
    say(other, "ADD other 1 1\nSTAT other\n");
    CHECK(kill(d.pid, SIGTERM) == 0);
    char *text = hear_all(fd, &n);
    CHECK_MSG(strncmp(text, "ERR CANCELLED ", 14) == 0 && strstr(text + 1, "\nERR CANCELLED ") &&
                  strstr(text, "\nOK 1\n0 "),
              "%s", text);
    free(text);
    text = hear_all(other, &n);
    CHECK_MSG(strncmp(text, "OK 0 first=1 ", 13) == 0 && strstr(text, "points=2 "), "%s", text);
    free(text);
    int status;
    CHECK(waitpid(d.pid, &status, 0) == d.pid && WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* Each would take about a minute; those that wait for the set end as the first one does. */
TEST_TIMEOUT(daemon_that_stops_cancels_plans_of_edits, 60)
{
    enum { POINTS = 200000, PLANS = 5, LINES = 2000 };
    size_t n;
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    load_random(fd, "t", POINTS);
    say(fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    static char request[PLANS * 64 + LINES * 20];
    char *at = request;
    for (int i = 0; i < PLANS; i++)
        at += sprintf(at, "REFINE t LENGTH 1e-4 LIMIT 50000000\n");
    at += sprintf(at, "CONSTRAIN t SPLIT");
    for (int i = 0; i < LINES; i++)
        at += sprintf(at, " %d %d", i, POINTS - 1 - i);
    strcpy(at, "\nCONSTRAINTS t\n");
    say(fd, request);
    say(other, "ADD t 5 5\n");
    await_info(&d, "jobs_running", 1);
    CHECK(kill(d.pid, SIGTERM) == 0);
    char *text = hear_all(fd, &n);
    at = text;
    for (int i = 0; i < PLANS + 1; i++, at = strchr(at, '\n') + 1)
        CHECK_MSG(strncmp(at, "ERR CANCELLED ", 14) == 0, "%d: %s", i, text);
    CHECK_MSG(strcmp(at, "OK 0\n") == 0, "%s", text);
    free(text);
    text = hear_all(other, &n);
    CHECK_MSG(strncmp(text, "OK 0 first=200000 ", 18) == 0, "%s", text);
    free(text);
    int status;
    CHECK(waitpid(d.pid, &status, 0) == d.pid && WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* It does so without waiting for the half minute that edits have. */
TEST_TIMEOUT(daemon_that_stops_breaks_off_replies_that_are_not_read_or_take_long, 20)
{
    static const char *const requests[] = {"POINTS t\n", "RASTER t z 0 0 1 1 11000 11000\n"};
    for (int i = 0; i < 2; i++) {
        struct daemon d = daemon_start(NULL);
        int fd = daemon_connect(&d);
        load_random(fd, "t", 300000);
        say(fd, "FSET t z 0 1\nTRIANGULATE t\n");
        CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
        CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
        say(fd, requests[i]);
        CHECK(strncmp(hear_line(fd), "OK ", 3) == 0);
        CHECK(daemon_stop(&d, SIGTERM) == 0);
        close(fd);
    }
}

/* Its end is noticed when the line about the job's progress cannot be delivered. */
TEST(job_of_a_client_that_has_closed_its_connection_ends)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 3000000);
    int gone = daemon_connect(&d);
    say(gone, "TRIANGULATE t METHOD shelling\n");
    pause_ms(20);
    close(gone);
    await_info(&d, "clients", 2);
    await_info(&d, "jobs_running", 0);
    say(fd, "STAT t\n");
    CHECK(strstr(hear_line(fd), "triangulated=no") != NULL);
}

TEST(second_signal_stops_the_daemon_in_the_middle_of_work)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 1000000);
    say(fd, "TRIANGULATE t METHOD shelling\nTRIANGULATE t METHOD shelling\nTRIANGULATE t METHOD "
            "shelling\n");
    pause_ms(50);
    CHECK(kill(d.pid, SIGTERM) == 0);
    pause_ms(50);
    double start = seconds();
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    CHECK(seconds() - start < 5);
}

/* ---- vanishing ---- */

/* Closes with a reset, as a crashed client's system would. */
static void vanish(int fd)
{
    struct linger now = {1, 0};
    setsockopt(fd, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    close(fd);
}

TEST(client_that_vanishes_during_its_job_leaves_nothing)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    load_random(fd, "t", 500000);
    for (int i = 0; i < 5; i++) {
        int gone = daemon_connect(&d);
        say(gone, "TRIANGULATE t METHOD shelling\nLISTS t\n");
        pause_ms(20);
        vanish(gone);
    }
    say(other, "TRIANGULATE t\nCHECK t\n");
    CHECK(strncmp(hear_line(other), "OK 0 points=500000", 18) == 0);
    CHECK(strncmp(hear_line(other), "OK 0 delaunay=yes", 17) == 0);
    await_info(&d, "clients", 3);
}

TEST(client_that_vanishes_during_a_load_leaves_nothing)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "LOAD t 1000000\n1 1\n2 2\n3");
    await_info_least(&d, "loading", 1);
    vanish(fd);
    await_info(&d, "loading", 0);
    converse(&d, "SETS\n", "OK 0\n");
}

TEST(clients_that_vanish_during_a_reply_leave_nothing)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 200000);
    say(fd, "TRIANGULATE t\n");
    hear_line(fd);
    for (int i = 0; i < 50; i++) {
        int gone = daemon_connect(&d);
        say(gone, "LISTS t\nLISTS t\n");
        expect(gone, "OK 200000 ");
        if (i % 2)
            vanish(gone);
        else
            close(gone);
    }
    say(fd, "DROP t\n");
    expect(fd, "OK 0\n");
    await_info(&d, "memory", 0);
    await_info(&d, "clients", 2);
}

TEST(storm_of_connections_leaves_nothing)
{
    struct daemon d = daemon_start(NULL);
    for (int i = 0; i < 3000; i++) {
        int fd = daemon_connect(&d);
        if (i % 3 == 0)
            say(fd, "PING\n");
        if (i % 3 == 1)
            vanish(fd);
        else
            close(fd);
    }
    await_info(&d, "clients", 1);
}

/* ---- limits of the system ---- */

TEST(clients_beyond_the_limit_get_an_error)
{
    const char *arguments[] = {"--max-clients", "3", NULL};
    struct daemon d = daemon_start(arguments);
    int fd[3];
    for (int i = 0; i < 3; i++) {
        fd[i] = daemon_connect(&d);
        say(fd[i], "PING\n");
        expect(fd[i], "OK 0\n");
    }
    converse(&d, "", "ERR BUSY too many clients\n");
    close(fd[1]);
    while (info_of(fd[0], "clients") > 2)
        pause_ms(10);
    converse(&d, "PING\n", "OK 0\n");
    say(fd[0], "PING\n");
    expect(fd[0], "OK 0\n");
}

TEST(daemon_without_descriptors_refuses_clients_without_busy_waiting)
{
    enum { CLIENTS = 90 };
    int fd[CLIENTS], welcome = 0;
    struct daemon d = daemon_start(NULL);
    int known = daemon_connect(&d);
    say(known, "PING\n");
    expect(known, "OK 0\n");
    struct rlimit few = {64, 64};
    CHECK(prlimit(d.pid, RLIMIT_NOFILE, &few, NULL) == 0);
    for (int i = 0; i < CLIENTS; i++) {
        fd[i] = daemon_connect(&d);
        send(fd[i], "PING\n", 5, MSG_NOSIGNAL);
    }
    for (int i = 0; i < CLIENTS; i++) {
        const char *line = hear_line(fd[i]);
        welcome += strcmp(line, "OK 0") == 0;
        CHECK_MSG(strcmp(line, "OK 0") == 0 || strncmp(line, "ERR BUSY ", 9) == 0, "%s", line);
    }
    CHECK(welcome > 40 && welcome < 64);
    double cpu = daemon_cpu_seconds(&d);
    pause_ms(500);
    CHECK(daemon_cpu_seconds(&d) - cpu < 0.1 || test_is_sanitized());
    for (int i = 0; i < CLIENTS; i++)
        close(fd[i]);
    while (info_of(known, "clients") > 1)
        pause_ms(10);
    converse(&d, "PING\n", "OK 0\n");
}

TEST(thousands_of_idle_clients_cost_little)
{
    enum { CLIENTS = 4000 };
    static int fd[CLIENTS];
    struct rlimit many = {CLIENTS + 200, CLIENTS + 200}, now;
    CHECK(getrlimit(RLIMIT_NOFILE, &now) == 0);
    if (now.rlim_max < many.rlim_max)
        SKIP("this machine allows only %ju open files", (uintmax_t)now.rlim_max);
    many.rlim_max = now.rlim_max;
    CHECK(setrlimit(RLIMIT_NOFILE, &many) == 0);
    struct daemon d = daemon_start(NULL);
    fd[0] = daemon_connect(&d);
    say(fd[0], "PING\n");
    expect(fd[0], "OK 0\n");
    size_t before = daemon_resident(&d);
    for (int i = 1; i < CLIENTS; i++) {
        fd[i] = daemon_connect(&d);
        say(fd[i], "PING\nPI");
        expect(fd[i], "OK 0\n");
    }
    size_t each = (daemon_resident(&d) - before) / CLIENTS;
    if (!test_is_sanitized())
        CHECK_MSG(each < 2048, "%zu bytes each", each);
    double cpu = daemon_cpu_seconds(&d);
    pause_ms(500);
    CHECK(daemon_cpu_seconds(&d) - cpu < 0.05 || test_is_sanitized());
}
