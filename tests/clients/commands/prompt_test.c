/* prompt_test.c - `delaunay` without a command, on a terminal and from a pipe. */
#include <string.h>
#include <sys/stat.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/clients/terminal.h"
#include "tests/test.h"

/* Skips the test if the client was built without a library for line editing. */
static void need_editing(void)
{
    int status;
    peer_shell(&status, "ldd %s | grep -qE 'libedit|libreadline'", getenv("DELAUNAY"));
    if (status != 0)
        SKIP("the Debian package libedit-dev is missing");
}

TEST(prompt_carries_out_requests_and_subcommands_until_exit)
{
    char line[200];
    cli_begin();
    cli_write("a b.csv", "x,y\n0,0\n4,0\n0,4\n");
    terminal_start("");
    terminal_wait_for("delaunay> ");
    terminal_type("ping\r");
    terminal_wait_for("OK 0");
    terminal_wait_for("delaunay> ");
    snprintf(line, sizeof line, "load t \"%s\"\r", cli_path("a b.csv"));
    terminal_type(line);
    terminal_wait_for("OK 0 first=0 added=3");
    terminal_wait_for("delaunay> ");
    terminal_type("triangulate t\r");
    terminal_wait_for("triangles=1");
    terminal_type("show t --width 4 --height 2 --plain\r");
    terminal_wait_for("\xE2\xA3"); /* braille */
    terminal_wait_for("delaunay> ");
    terminal_type("points delaunay://elsewhere/t\r");
    terminal_wait_for("ERR");
    terminal_type("export t\r");
    terminal_wait_for("export takes a set and a file");
    terminal_wait_for("delaunay> ");
    terminal_type("exit\r");
    CHECK(terminal_finish() == 2); /* the exit status of the last failure */
    cli_finish();
}

TEST(prompt_has_history_and_editing)
{
    need_editing();
    cli_begin();
    terminal_start("");
    terminal_wait_for("delaunay> ");
    terminal_type("add t 1 2\r");
    terminal_wait_for("first=0");
    terminal_wait_for("delaunay> ");
    terminal_type("\033[A\r"); /* the previous line */
    terminal_wait_for("first=1");
    terminal_wait_for("delaunay> ");
    terminal_type("pinx\177g\r");
    terminal_wait_for("OK 0");
    terminal_wait_for("delaunay> ");
    terminal_type("auth secret\r");
    terminal_wait_for("OK 0 role");
    terminal_wait_for("delaunay> ");
    terminal_type("poi\t t\r"); /* completes the command */
    terminal_wait_for("OK 2");
    terminal_wait_for("delaunay> ");
    terminal_type("quit\r");
    terminal_finish();
    terminal_start("");
    terminal_wait_for("delaunay> ");
    terminal_type("\033[A\033[A\r"); /* the line before quit, from the previous session */
    terminal_wait_for("OK 2");
    terminal_wait_for("delaunay> ");
    terminal_type("exit\r");
    terminal_finish();
    int status;
    struct stat st;
    peer_shell(&status, "grep -q secret %s", cli_path(".delaunay_history"));
    CHECK(status == 1);
    CHECK(stat(cli_path(".delaunay_history"), &st) == 0 && (st.st_mode & 0077) == 0);
    cli_finish();
}

TEST(prompt_reads_lines_with_subcommands_from_a_pipe)
{
    int status;
    cli_begin();
    cli_write("a.xy", "0 0\n4 0\n0 4\n");
    const char *got = peer_shell(&status,
                                 "printf 'load t %s\\ntriangulate t\\nexport t - -f ele\\nhull "
                                 "--help\\nexit\\nping\\n' | %s -p %s 2>&1",
                                 cli_path("a.xy"), getenv("DELAUNAY"), cli_daemon.port_text);
    CHECK_MSG(status == 0 && strstr(got, "added=3") != NULL &&
                  strstr(got, "\n1 3 0\n0 0 1 2\nusage: ") != NULL,
              "%s", got);
    got = peer_shell(&status, "printf '\\033[Aping\\n' | %s -p %s 2>&1", getenv("DELAUNAY"),
                     cli_daemon.port_text);
    CHECK_STR(got, "delaunay: a control character in the line; nothing was sent\n");
    got = peer_shell(&status,
                     "printf 'load t \"a\\nLOADB t 1\\ntimeout 5 locateb t 1\\n' | %s -p %s 2>&1",
                     getenv("DELAUNAY"), cli_daemon.port_text);
    CHECK_STR(
        got,
        "delaunay: a quote is open, or too many words\n"
        "delaunay: a request is one line, not blank, not a comment, and without a body; nothing "
        "was sent\n"
        "delaunay: a request is one line, not blank, not a comment, and without a body; nothing "
        "was sent\n");
    CHECK(status == 2);
    got = peer_shell(&status, "printf '# a\\r\\n\\r\\n \\t\\n\\t# b\\nping\\r\\n' | %s -p %s 2>&1",
                     getenv("DELAUNAY"), cli_daemon.port_text);
    CHECK_STR(got, "OK 0\n");
    CHECK(status == 0);
    cli_finish();
}

TEST(control_c_at_the_prompt_discards_the_line_and_keeps_a_private_server)
{
    static const char *const places[] = {"", "-u private:"};
    cli_begin();
    for (int i = 0; i < 2; i++) {
        terminal_start(places[i]);
        terminal_wait_for("delaunay> ");
        terminal_type("add t 1 1\r");
        terminal_wait_for("OK 0 first=0 added=1");
        terminal_wait_for("delaunay> ");
        terminal_type("drop t");
        terminal_wait_for("drop t");
        terminal_type("\x03");
        terminal_wait_for("\n");
        terminal_wait_for("delaunay> ");
        terminal_type("\x03");
        terminal_wait_for("delaunay> ");
        terminal_type("points t\r");
        terminal_wait_for("0 1 1");
        terminal_wait_for("delaunay> ");
        terminal_type("drop t\r");
        terminal_wait_for("OK 0");
        terminal_wait_for("delaunay> ");
        terminal_type("exit\r");
        CHECK(terminal_finish() == 0);
    }
    cli_finish();
}
