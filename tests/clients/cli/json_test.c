/* json_test.c - `delaunay --json`: every reply and result is one JSON object on a line. */
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

static void expect(const char *arguments, int want_status, const char *want)
{
    int status;
    const char *got = cli_run(&status, arguments);
    CHECK_STR(got, want);
    CHECK_MSG(status == want_status, "%s: status %d", arguments, status);
}

TEST(json_has_numbers_booleans_names_and_rows)
{
    cli_begin();
    expect("--json add t 0 0  1 0  0.5 1e3", 0,
           "{\"ok\":true,\"first\":0,\"added\":3,\"coincident\":0,\"rows\":[]}\n");
    cli_run_well("triangulate t");
    expect("points t --json", 0, "{\"ok\":true,\"rows\":[[0,0,0],[1,1,0],[2,0.5,1000]]}\n");
    expect("--json sets", 0,
           "{\"ok\":true,\"rows\":[{\"name\":\"t\",\"points\":3,\"triangulated\":true}]}\n");
    expect("--json locate t 0.5 1", 0, "{\"ok\":true,\"where\":\"inside\",\"rows\":[[0,1,2]]}\n");
    expect("--json help ping", 0, "{\"ok\":true,\"rows\":[\"PING - answers OK 0\"]}\n");
    cli_finish();
}

TEST(json_has_facts_as_a_map)
{
    int status;
    cli_begin();
    cli_run_well("add t 0 0");
    const char *got = cli_run(&status, "--json info");
    CHECK(status == 0 && strncmp(got, "{\"ok\":true,\"info\":{\"version\":\"", 30) == 0);
    CHECK(strstr(got, ",\"sets\":1,") != NULL);
    CHECK(strstr(got, ",\"command_ADD\":{\"calls\":1,\"errors\":0,") != NULL);
    CHECK(strcmp(got + strlen(got) - 3, "}}\n") == 0 ||
          strcmp(got + strlen(got) - 4, "}}}\n") == 0);
    got = cli_run(&status, "--json top --once");
    CHECK(status == 0 && strncmp(got, "{\"ok\":true,\"info\":{", 19) == 0);
    cli_finish();
}

TEST(json_reports_refused_requests)
{
    cli_begin();
    expect("--json points t", 1,
           "{\"ok\":false,\"error\":\"NOSET\",\"message\":\"there is no set t\"}\n");
    expect("--json export t -", 1,
           "{\"ok\":false,\"error\":\"NOSET\",\"message\":\"there is no set t\"}\n");
    expect("--json load t /none", 1,
           "delaunay: /none: No such file or directory\n{\"ok\":false,\"error\":\"REFUSED\","
           "\"message\":\"/none: No such file or "
           "directory\",\"input\":{\"name\":\"/none\",\"points\":0,"
           "\"skipped\":0,\"skipped_lines\":[],\"notes\":[]}}\n");
    expect("--json load t", 2,
           "delaunay: load takes a set and a file\nTry 'delaunay load "
           "--help'.\n{\"ok\":false,\"error\":\"USAGE\",\"message\":\"load takes a set and a "
           "file\"}\n");
    expect("-p 1 --json sets", 3,
           "delaunay: 127.0.0.1:1: Connection "
           "refused\n{\"ok\":false,\"error\":\"CONNECTION\",\"message\":\"127.0.0.1:1: Connection "
           "refused\"}\n");
    expect(
        "--json points t binary", 2,
        "delaunay: a binary reply cannot be "
        "JSON\n{\"ok\":false,\"error\":\"USAGE\",\"message\":\"a binary reply cannot be JSON\"}\n");
    cli_finish();
}

TEST(json_is_printed_by_every_subcommand)
{
    char command[300], url[64];
    cli_begin();
    cli_write("a.csv", "x,y\n0,0\n1,0\n0,1\n");
    char want[600];
    snprintf(command, sizeof command, "--json load t %s", cli_path("a.csv"));
    snprintf(want, sizeof want,
             "{\"ok\":true,\"first\":0,\"added\":3,\"coincident\":0,\"input\":{\"name\":\"%s\","
             "\"points\":3,\"skipped\":0,\"skipped_lines\":[],\"heading_line\":1,\"columns\":["
             "{\"column\":1,\"heading\":\"x\",\"use\":\"x\",\"from\":0,\"to\":1,\"missing\":0},"
             "{\"column\":2,\"heading\":\"y\",\"use\":\"y\",\"from\":0,\"to\":1,\"missing\":0}],"
             "\"notes\":[]},\"rows\":[]}\n",
             cli_path("a.csv"));
    expect(command, 0, want);
    cli_run_well("triangulate t");
    snprintf(command, sizeof command, "--json export t %s", cli_path("a.svg"));
    snprintf(want, sizeof want,
             "{\"ok\":true,\"file\":\"%s\",\"points\":3,\"shown\":3,\"triangles\":1,\"hull\":3}\n",
             cli_path("a.svg"));
    expect(command, 0, want);
    snprintf(command, sizeof command, "--json trace t %s --force", cli_path("b.svg"));
    int status;
    const char *got = cli_run(&status, command);
    CHECK_MSG(status == 0 && strstr(got, ",\"points\":3,\"steps\":") != NULL, "%s", got);
    expect("--json show t --width 2 --height 1", 0,
           "{\"ok\":true,\"lines\":[\"\xE2\xA3\x97\xE2\xA3\x84\"]}\n");
    snprintf(url, sizeof url, "delaunay://127.0.0.1:%s", cli_daemon.port_text);
    snprintf(command, sizeof command, "--json copy t %s %s/u", url, url);
    expect(command, 0, "{\"ok\":true,\"from\":\"t\",\"to\":\"u\",\"points\":3}\n");
    got = peer_shell(&status, "printf 'ping\\nget t 9\\n' | %s -p %s --json", getenv("DELAUNAY"),
                     cli_daemon.port_text);
    CHECK_MSG(status == 1 &&
                  strncmp(got, "{\"ok\":true,\"rows\":[]}\n{\"ok\":false,\"error\":\"", 41) == 0,
              "%s", got);
    cli_finish();
}

/* Rows with characters that JSON must escape, and numbers that JSON does not have. */
static void answer(int fd)
{
    char line[100];
    while (peer_hear(fd, line, sizeof line))
        peer_say(fd, "OK 3 digest=1234567890123456 version=7\na\"b\\c\td 01 1. .5 -1 1e5 nan\n0 "
                     "at=5 us=7 NEAREST t \"1\" 2\n"
                     "id=1 name= flag=no\n");
}

TEST(json_escapes_strings_and_prints_only_valid_numbers_as_numbers)
{
    char port[8];
    int status;
    peer_start(port, answer);
    CHECK_STR(peer_shell(&status, "%s -p %s --json anything", getenv("DELAUNAY"), port),
              "{\"ok\":true,\"digest\":\"1234567890123456\",\"version\":7,\"rows\":[["
              "\"a\\\"b\\\\c\\u0009d\",\"01\",\"1.\",\".5\",-1,1e5,\"nan\"],"
              "{\"name\":\"0\",\"at\":5,\"us\":7,\"request\":\"NEAREST t \\\"1\\\" 2\"},"
              "{\"id\":1,\"name\":\"\",\"flag\":false}]}\n");
}
