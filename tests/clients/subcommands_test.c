/* subcommands_test.c - URLs, copy, show, top, help and completion, by way of a real daemon. */
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

TEST(url_names_daemon_and_set)
{
    int status;
    cli_begin();
    const char *got = peer_shell(&status, "%s add delaunay://127.0.0.1:%s/t 1 2 2>&1",
                                 getenv("DELAUNAY"), cli_daemon.port_text);
    CHECK_STR(got, "OK 0 first=0 added=1 coincident=0\n");
    got = peer_shell(&status, "%s points delaunay://127.0.0.1:%s/t 2>&1", getenv("DELAUNAY"),
                     cli_daemon.port_text);
    CHECK_STR(got, "OK 1\n0 1 2\n");
    got = peer_shell(&status, "%s -u delaunay://:token@127.0.0.1:%s points t 2>&1",
                     getenv("DELAUNAY"), cli_daemon.port_text);
    CHECK_STR(got, "OK 1\n0 1 2\n");
    got = peer_shell(&status, "DELAUNAY_URL=delaunay://127.0.0.1:%s %s sets 2>&1",
                     cli_daemon.port_text, getenv("DELAUNAY"));
    CHECK_STR(got, "OK 1\nt points=1 triangulated=no\n");
    static const char *const bad[] = {"delaunay://",   "delaunay://h:x/t",  "delaunay://h:1/a/b",
                                      "delaunay://h/", "delaunay://[::1/t", "delaunay://u@h/t"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        peer_shell(&status, "%s points %s 2>&1", getenv("DELAUNAY"), bad[i]);
        CHECK_MSG(status == 2, "%s", bad[i]);
    }
    cli_finish();
}

TEST(copy_keeps_ids_tolerance_and_triangulation)
{
    int status;
    char from[64];
    cli_begin();
    struct daemon first = cli_daemon;
    cli_run_well("CREATE t TOL 0.5");
    cli_run_well("ADD t 0 0  4 0  4 4  0 4  0.25 0  9 9  2 2");
    cli_run_well("DEL t 0 5 2");
    cli_run_well("triangulate t");
    snprintf(from, sizeof from, "delaunay://127.0.0.1:%s", first.port_text);
    cli_daemon = daemon_start(NULL);
    const char *got = peer_shell(&status, "%s copy t %s delaunay://127.0.0.1:%s/u 2>&1",
                                 getenv("DELAUNAY"), from, cli_daemon.port_text);
    CHECK_MSG(status == 0 && strstr(got, "t: 4 points copied") == got, "%s", got);
    cli_expect("points u", "OK 4\n1 4 0\n3 0 4\n4 0.25 0\n6 2 2\n");
    CHECK(strstr(cli_run(&status, "stat u"), "triangulated=yes") != NULL);
    CHECK(strstr(cli_run(&status, "stat u"), "tol=0.5") != NULL);
    cli_run_well("check u");
    peer_shell(&status, "%s copy t %s delaunay://127.0.0.1:%s/u 2>&1", getenv("DELAUNAY"), from,
               cli_daemon.port_text);
    CHECK(status == 1); /* it is there already */
    daemon_end(&first);
    cli_finish();
}

/* Copies the set t beside itself. */
static void copy_to_u(void)
{
    char command[200];
    snprintf(command, sizeof command, "copy t delaunay://127.0.0.1:%s delaunay://127.0.0.1:%s/u",
             cli_daemon.port_text, cli_daemon.port_text);
    cli_run_well(command);
}

/* Runs a query of the sets t and u; both replies must be the same. */
static void expect_equal_sets(const char *query)
{
    char command[40], want[4000];
    int status;
    snprintf(command, sizeof command, "%s t", query);
    snprintf(want, sizeof want, "%s", cli_run(&status, command));
    CHECK(status == 0);
    snprintf(command, sizeof command, "%s u", query);
    cli_expect(command, want);
}

TEST(copy_keeps_its_fillers_farther_from_the_points_than_the_tolerance)
{
    cli_begin();
    cli_run_well("CREATE t TOL 10");
    cli_run_well("ADD t 500 500  9 0  8 0  -9 0  0 5"); /* near 0 but for the first */
    cli_run_well("DEL t 0");
    cli_run_well("triangulate t");
    copy_to_u();
    expect_equal_sets("points");
    expect_equal_sets("coincident");
    expect_equal_sets("triangles");
    cli_finish();
}

TEST(copy_deletes_in_requests_that_are_short_enough_to_be_taken)
{
    enum { POINTS = 30000 };
    char command[200];
    int status;
    cli_begin();
    FILE *f = fopen(cli_path("del"), "w");
    CHECK(f != NULL);
    fprintf(f, "ADD t");
    for (int i = 0; i < POINTS; i++)
        fprintf(f, "%s %d %d", i % 1000 == 999 ? "\nADD t" : "", i % 200, i / 200);
    for (int i = 0; i < POINTS; i++)
        fprintf(f, "%s %d", i % 1000 == 0 ? "\nDEL t" : "", i == 12345 ? i + 1 : i);
    CHECK(fprintf(f, "\nADD t 7 8\n") > 0 && fclose(f) == 0);
    snprintf(command, sizeof command, "< %s", cli_path("del"));
    cli_run(&status, command);
    copy_to_u();
    cli_expect("points u", "OK 2\n12345 145 61\n30000 7 8\n");
    cli_finish();
}

TEST(show_draws_in_braille)
{
    cli_begin();
    cli_run_well("ADD t 0 0  10 0  10 10  0 10");
    cli_run_well("triangulate t");
    cli_expect("show t --width 4 --height 2 --plain", "⡟⢍⠉⢹\n⣇⣀⣑⣼\n");
    cli_finish();
}

/* The drawing of these points, 4 columns wide and 2 lines high at most. */
static void show(const char *points, const char *want)
{
    char command[100];
    snprintf(command, sizeof command, "ADD t %s", points);
    cli_run_well(command);
    cli_run_well("triangulate t");
    cli_expect("show t --width 4 --height 2 --plain", want);
    cli_run_well("drop t");
}

TEST(show_fits_points_that_are_wide_high_or_at_one_place)
{
    cli_begin();
    show("5 5", "⠁   \n");
    show("0 3  7 3", "⠉⠉⠉⠉\n");
    show("3 0  3 70", "⡇   \n⡇   \n");
    show("0 0  7 0  7 1  0 1", "⠛⠛⠛⠛\n");
    show("0 0  3 0  3 7  0 7", "⣯⢹  \n⣇⣻  \n");
    show("0 0  1 0  1 70  0 70", "⡇   \n⡇   \n");
    cli_finish();
}

TEST(every_subcommand_has_help_and_completion)
{
    int status;
    char all[8000], name[32];
    cli_begin();
    snprintf(all, sizeof all, "%s", cli_run(&status, "--help"));
    const char *p = strstr(all, "\n\n  ");
    CHECK(status == 0 && p != NULL);
    for (p++; sscanf(p, "\n  %31[a-z]", name) == 1; p = strchr(p + 1, '\n')) {
        char command[64];
        snprintf(command, sizeof command, "%s --help", name);
        CHECK(strncmp(cli_run(&status, command), "usage: delaunay ", 16) == 0 && status == 0);
    }
    cli_run(&status, "completion | bash -n");
    CHECK(status == 0);
    const char *got = peer_shell(
        &status,
        "bash -c 'source <(%s completion); COMP_WORDS=(delaunay tri); COMP_CWORD=1; _delaunay; "
        "echo ${COMPREPLY[*]}'",
        getenv("DELAUNAY"));
    CHECK_STR(got, "triangulate triangles\n");
    CHECK(strstr(cli_run(&status, "top --once"), "uptime_s ") != NULL);
    cli_finish();
}

/* Answers INFO with more facts than there is room for, some of them long. */
static void inform(int fd)
{
    char line[100], long_text[301];
    peer_hear(fd, line, sizeof line);
    memset(long_text, 'v', 300);
    long_text[300] = '\0';
    peer_say(fd, "OK 202\n");
    for (int i = 0; i < 200; i++) {
        char row[32];
        snprintf(row, sizeof row, "key%d:%d\n", i, i);
        peer_say(fd, row);
        if (i == 1 || i == 2) {
            peer_say(fd, i == 1 ? "long:" : long_text);
            peer_say(fd, i == 1 ? long_text : ":2");
            peer_say(fd, "\n");
        }
    }
}

TEST(top_shows_as_many_facts_as_it_has_room_for)
{
    char port[8];
    int status;
    peer_start(port, inform);
    const char *out = peer_shell(&status, "%s -p %s top --once 2>&1", getenv("DELAUNAY"), port);
    unsigned lines = 0;
    for (const char *p = out; (p = strchr(p, '\n')) != NULL; p++)
        lines++;
    CHECK_MSG(status == 0 && lines == 64, "%u lines, status %d", lines, status);
    CHECK(strstr(out, "key0 ") == out && strstr(out, "\nkey61 ") != NULL);
    CHECK(strstr(out, "key62") == NULL);
}
