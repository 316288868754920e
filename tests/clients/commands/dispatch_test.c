/* dispatch_test.c - `delaunay` with a private server. */
#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/clients/terminal.h"
#include "tests/test.h"

#include <stdlib.h>
#include <string.h>

TEST(lines_of_a_pipe_can_have_a_private_server)
{
    int status;
    const char *got = peer_shell(&status,
                                 "printf 'ADD t 0 0 1 0 0 1\\nTRIANGULATE t\\nHULL t\\nCONFIG GET "
                                 "port\\n' | %s -u private: 2>&1",
                                 getenv("DELAUNAY"));
    CHECK_MSG(status == 0 && strstr(got, "\n0 0 0\n1 1 0\n2 0 1\n") != NULL, "%s", got);
    CHECK_STR(peer_shell(&status, "%s -u private: SETS 2>&1", getenv("DELAUNAY")), "OK 0\n");
}

TEST(only_the_default_address_is_replaced_by_a_private_server)
{
    int status;
    unsetenv("DELAUNAY_URL");
    const char *got = peer_shell(&status, "%s -p 1 HELP 2>&1", getenv("DELAUNAY"));
    CHECK_MSG(status == 3 && strstr(got, "TRIANGULATE") == NULL, "%s", got);
    got = peer_shell(&status, "%s -h 127.9.9.9 HELP 2>&1", getenv("DELAUNAY"));
    CHECK_MSG(status == 3 && strstr(got, "TRIANGULATE") == NULL, "%s", got);
}

TEST(prompt_without_a_server_has_a_private_one_and_a_script_has_none)
{
    int status;
    unsetenv("DELAUNAY_URL");
    peer_shell(&status, "%s ping 2>&1", getenv("DELAUNAY"));
    if (status == 0)
        SKIP("this machine has a server at the default address");
    peer_shell(&status, "echo ADD t 0 0 | %s 2>&1", getenv("DELAUNAY"));
    CHECK(status == 3);
    cli_begin();
    terminal_start("-h localhost -p 6374");
    terminal_wait_for("private server");
    terminal_wait_for("delaunay> ");
    terminal_type("add t 1 2\r");
    terminal_wait_for("first=0");
    terminal_type("exit\r");
    CHECK(terminal_finish() == 0);
    cli_finish();
    const char *got = peer_shell(&status, "%s HELP 2>&1", getenv("DELAUNAY"));
    CHECK(status == 0 && strstr(got, "TRIANGULATE") != NULL);
}
