/* cli_test.c - the `delaunay` command line: output, exit status, messages. */
#include <string.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

static const char *client(void)
{
    const char *path = getenv("DELAUNAY");
    CHECK_MSG(path != NULL, "DELAUNAY must name the client to test");
    return path;
}

/* Echoes each request as a row; accepts loads. */
static void answer(int fd)
{
    char line[2000], reply[3000];
    while (peer_hear(fd, line, sizeof line)) {
        unsigned long n;
        if (sscanf(line, "LOADB %*s %lu", &n) == 1) {
            for (char xy[16]; n > 0; n--)
                for (size_t have = 0; have < sizeof xy;)
                    have += (size_t)read(fd, xy + have, sizeof xy - have);
            snprintf(reply, sizeof reply, "OK 1\n%s\n", line);
        } else if (strncmp(line, "BAD", 3) == 0) {
            snprintf(reply, sizeof reply, "ERR UNKNOWN %s\n", line);
        } else if (strncmp(line, "CUT", 3) == 0) {
            peer_say(fd, "OK 3\n");
            return;
        } else {
            snprintf(reply, sizeof reply, "OK 1\n%s\n", line);
        }
        peer_say(fd, reply);
    }
}

TEST(cli_prints_the_reply_to_any_command)
{
    char port[8];
    int status;
    peer_start(port, answer);
    CHECK_STR(peer_shell(&status, "%s -p %s nearest t -1 2.5 3", client(), port),
              "OK 1\nnearest t -1 2.5 3\n");
    CHECK(status == 0);
    CHECK_STR(peer_shell(&status, "%s -h 127.0.0.1 -p %s BAD thing", client(), port),
              "ERR UNKNOWN BAD thing\n");
    CHECK(status == 1);
}

TEST(cli_takes_host_and_port_from_the_environment)
{
    char port[8];
    int status;
    peer_start(port, answer);
    CHECK_STR(
        peer_shell(&status, "DELAUNAY_HOST=127.0.0.1 DELAUNAY_PORT=%s %s PING", port, client()),
        "OK 1\nPING\n");
    peer_shell(&status, "DELAUNAY_HOST=127.0.0.1 DELAUNAY_PORT=%s %s -p 1 PING 2>&1", port,
               client());
    CHECK(status == 3);
}

TEST(cli_exit_status_differs_for_wrong_usage_and_no_connection)
{
    char port[8];
    int status;
    peer_start(port, answer);
    const char *out = peer_shell(&status, "%s -p 1 PING 2>&1", client());
    CHECK(status == 3 && strstr(out, "delaunay: ") == out);
    peer_shell(&status, "%s -p %s --nonsense 2>&1", client(), port);
    CHECK(status == 2);
    peer_shell(&status, "%s -p %s load t 2>&1", client(), port);
    CHECK(status == 2);
    out = peer_shell(&status, "%s -p %s triangulate 2>&1", client(), port);
    CHECK(status == 2 && strstr(out, "the name of a set is missing") != NULL);
    peer_shell(&status, "%s -p %s load 'a b' /dev/null 2>&1", client(), port);
    CHECK(status == 2);
    peer_shell(&status, "%s -p %s LOADB t 5 2>&1", client(), port);
    CHECK(status == 2);
    peer_shell(&status, "%s -p %s \"$(printf 'DEL t 1\\nDROP t')\" 2>&1", client(), port);
    CHECK(status == 2);
    out = peer_shell(&status, "%s -p %s CUT 2>&1", client(), port);
    CHECK(status == 3 && strstr(out, "connection was lost") != NULL);
    out = peer_shell(&status, "%s --help", client());
    CHECK(status == 0 && strstr(out, "usage: delaunay") == out);
}

TEST(cli_loads_a_file_and_standard_input)
{
    char port[8];
    int status;
    peer_start(port, answer);
    CHECK_STR(
        peer_shell(&status, "printf '1 2\\n# c\\n3 4\\n' | %s -p %s load t -", client(), port),
        "OK 1\n");
    CHECK(status == 0);
    peer_shell(&status,
               "f=$(mktemp) && printf '1 2\\n' > $f && %s -p %s load t $f; s=$?; rm $f; exit $s",
               client(), port);
    CHECK(status == 0);
    peer_shell(&status, "%s -p %s load t - < /dev/null", client(), port);
    CHECK(status == 0);
}

TEST(cli_reports_the_number_of_a_bad_line_and_loads_nothing)
{
    char port[8];
    int status;
    peer_start(port, answer);
    CHECK_STR(peer_shell(&status, "printf '1 2\\n3 x\\n' | %s -p %s load t - 2>&1", client(), port),
              "delaunay: standard input:2: not a number: \"x\" in column 2; nothing was loaded "
              "(--skip-bad leaves such out)\n");
    CHECK(status == 1);
    CHECK_STR(peer_shell(&status, "%s -p %s load t /nonexistent 2>&1", client(), port),
              "delaunay: /nonexistent: No such file or directory\n");
    CHECK(status == 1);
}

TEST(cli_draws_a_progress_bar_on_a_terminal_only)
{
    static char out[1 << 20];
    char port[8], path[64], arguments[100];
    int status;
    snprintf(path, sizeof path, "/tmp/delaunay_cli_test.%d", getpid());
    FILE *f = fopen(path, "w");
    CHECK(f != NULL);
    for (int i = 0; i < 300000; i++)
        fprintf(f, "%d %d\n", i, i / 7);
    CHECK(fclose(f) == 0);
    peer_start(port, answer);
    snprintf(arguments, sizeof arguments, "load t %s", path);
    cli_run_on_terminal(port, arguments, out, sizeof out);
    const char *piped = peer_shell(&status, "%s -p %s load t %s 2>&1", client(), port, path);
    unlink(path);
    CHECK(strstr(out, "\rreading [") != NULL && strstr(out, " % ") != NULL &&
          strstr(out, "M points") != NULL);
    CHECK(strstr(out, "\rsending [") != NULL);
    CHECK_STR(piped, "OK 1\n");
}

TEST(cli_without_a_command_reads_lines)
{
    char port[8];
    int status;
    peer_start(port, answer);
    CHECK_STR(peer_shell(&status,
                         "printf 'one 1\\r\\n\\nBAD x\\nload t\\ntwo' | %s -p %s 2>/dev/null",
                         client(), port),
              "OK 1\none 1\nERR UNKNOWN BAD x\nOK 1\ntwo\n");
    CHECK(status == 2);
    CHECK_STR(peer_shell(&status, "%s -p %s < /dev/null", client(), port), "");
    CHECK(status == 0);
    peer_shell(&status, "echo CUT | %s -p %s 2>&1", client(), port);
    CHECK(status == 3);
}
