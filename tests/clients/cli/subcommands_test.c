/* subcommands_test.c - URLs, copy, show, top, help and completion, with a real daemon. */
#include <string.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

TEST(url_identifies_daemon_and_set)
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

/* Its reply has no binary part, which a client would wait for. */
TEST(backup_prints_what_was_written)
{
    int status;
    char data[100], backups[100];
    cli_begin();
    snprintf(data, sizeof data, "%s", cli_path("data"));
    snprintf(backups, sizeof backups, "%s", cli_path("backups"));
    struct daemon d =
        daemon_start((const char *const[]){"--data", data, "--backup-dir", backups, NULL});
    CHECK_STR(peer_shell(&status, "%s -p %s backup x 2>&1", getenv("DELAUNAY"), d.port_text),
              "OK 0 lsn=0 files=1 size=64 copied=64\n");
    peer_shell(&status, "%s --check %s/x", getenv("DELAUNAYD"), backups);
    CHECK(status == 0);
    daemon_end(&d);
    peer_shell(&status, "rm -r %s %s", data, backups);
    cli_finish();
}

TEST(token_comes_from_the_url_or_the_environment)
{
    int status;
    char path[100];
    cli_begin();
    cli_write("tokens", "rw let-me-in\n");
    snprintf(path, sizeof path, "%s", cli_path("tokens"));
    const char *arguments[] = {"--auth-file", path, NULL};
    struct daemon d = daemon_start(arguments);
    const char *client = getenv("DELAUNAY"), *port = d.port_text;
    const char *got = peer_shell(&status, "%s -p %s sets 2>&1", client, port);
    CHECK(status == 1 && strncmp(got, "ERR NOAUTH ", 11) == 0);
    got = peer_shell(&status, "%s -u delaunay://:let-me-in@127.0.0.1:%s sets 2>&1", client, port);
    CHECK_STR(got, "OK 0\n");
    got = peer_shell(&status, "DELAUNAY_TOKEN=let-me-in %s -p %s sets 2>&1", client, port);
    CHECK_STR(got, "OK 0\n");
    got = peer_shell(&status, "DELAUNAY_TOKEN=open-sesame %s -p %s sets 2>&1", client, port);
    CHECK_MSG(status == 3 && strncmp(got, "delaunay: ERR ", 14) == 0, "%s", got);
    daemon_end(&d);
    cli_finish();
}

/* A server whose binary replies have a size that does not match their rows. */
static void answer_odd_sizes(int fd)
{
    char line[200], point[20] = {0};
    while (peer_hear(fd, line, sizeof line)) {
        if (strncmp(line, "POINTS odd", 10) == 0 || strncmp(line, "POINTS none", 11) == 0) {
            peer_say(fd, line[7] == 'o' ? "OK 0 rows=1 bytes=16\n" : "OK 1\n0 0 0\n");
            peer_send(fd, point, line[7] == 'o' ? 16 : 0);
        } else if (strncmp(line, "POINTS", 6) == 0) {
            peer_say(fd, "OK 0 rows=1 bytes=20\n");
            peer_send(fd, point, 20);
        } else if (strncmp(line, "TRIANGLES", 9) == 0) {
            peer_say(fd, "OK 0 rows=1 bytes=8\n");
            peer_send(fd, point, 8);
        } else {
            peer_say(fd, "OK 1\n0 0 0\n");
        }
    }
}

TEST(export_refuses_replies_whose_size_does_not_match_their_rows)
{
    static const struct {
        const char *set, *want;
    } cases[] = {{"odd", "delaunay: a row of another size\n"},
                 {"none", "delaunay: the server sends no binary replies\n"},
                 {"t", "delaunay: a row of another size\n"}};
    char port[8];
    int status;
    peer_start(port, answer_odd_sizes);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CHECK_STR(peer_shell(&status, "%s -p %s export %s - 2>&1", getenv("DELAUNAY"), port,
                             cases[i].set),
                  cases[i].want);
        CHECK(status == 1);
    }
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
    CHECK(status == 1); /* the set exists already, and stays unchanged */
    cli_expect("points u", "OK 4\n1 4 0\n3 0 4\n4 0.25 0\n6 2 2\n");
    daemon_end(&first);
    cli_finish();
}

/* Copies the set t to the set u of the same daemon. */
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

TEST(copy_keeps_fields)
{
    cli_begin();
    cli_run_well("ADD t FIELDS t,z  0 0 1.5 nan  4 0 7 7  0 4 nan -3  0 4 8 9");
    cli_run_well("DEL t 1");
    cli_run_well("FSET t empty 0 nan");
    copy_to_u();
    expect_equal_sets("FIELDS");
    cli_expect("points u fields t,z", "OK 3\n0 0 0 1.5 nan\n2 0 4 nan -3\n3 0 4 8 9\n");
    cli_run_well("DEL t 0 2 3");
    cli_run_well("drop u");
    copy_to_u();
    expect_equal_sets("POINTS");
    cli_finish();
}

TEST(copy_keeps_constraints)
{
    cli_begin();
    cli_run_well("ADD t 0 0  4 0  4 4  0 4  2 1  9 9");
    cli_run_well("DEL t 4");
    cli_run_well("triangulate t");
    cli_run_well("constrain t BORDER OF 7 RING 0 1 2 3");
    cli_run_well("constrain t BORDER OF 8 0 1");
    cli_run_well("constrain t 0 5");
    copy_to_u();
    cli_expect("constraints u", "OK 6\n0 1 border 7\n0 1 border 8\n0 3 border 7\n0 5 line 0\n"
                                "1 2 border 7\n2 3 border 7\n");
    expect_equal_sets("LISTS");
    cli_finish();
}

TEST(copy_keeps_constraints_of_the_first_points_after_a_gap)
{
    cli_begin();
    cli_run_well("ADD t 7 7  0 0  4 0  0 0  1 1  4 4");
    cli_run_well("constrain t 3 2");
    cli_run_well("constrain t BORDER OF 2 1 5");
    cli_run_well("DEL t 0 4");
    copy_to_u();
    cli_expect("constraints u", "OK 2\n1 5 border 2\n2 3 line 0\n");
    cli_expect("points u", "OK 4\n1 0 0\n2 4 0\n3 0 0\n5 4 4\n");
    cli_expect("coincident u", "OK 1\n3 1\n");
    cli_expect("ttl u", "OK 0\n");
    cli_finish();
}

TEST(copy_places_filler_points_farther_from_the_points_than_the_tolerance)
{
    cli_begin();
    cli_run_well("CREATE t TOL 10");
    cli_run_well("ADD t 500 500  9 0  8 0  -9 0  0 5"); /* all but the first are near 0 */
    cli_run_well("DEL t 0");
    cli_run_well("triangulate t");
    copy_to_u();
    expect_equal_sets("points");
    expect_equal_sets("coincident");
    expect_equal_sets("triangles");
    cli_finish();
}

/* Beyond 2^200 there is no place with twice the coordinate. */
TEST(copy_keeps_ids_of_points_at_the_limits_of_coordinates)
{
    static const char *const sets[] = {
        "ADD t 1 1  3.2138760885179806e60 0  0 -3.2138760885179806e60  7 7  1.7936620343357659e-43 "
        "0",
        "ADD t 3.2138760885179806e60 3.2138760885179806e60  -3.2138760885179806e60 "
        "3.2138760885179806e60  0 0  5 5  5 5"};
    cli_begin();
    for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
        cli_run_well(sets[i]);
        cli_run_well("DEL t 0 3");
        cli_run_well("triangulate t");
        copy_to_u();
        expect_equal_sets("points");
        expect_equal_sets("coincident");
        expect_equal_sets("triangles");
        cli_run_well("drop t");
        cli_run_well("drop u");
    }
    cli_finish();
}

TEST(copy_keeps_fields_of_a_set_without_points_and_that_it_is_not_triangulated)
{
    int status;
    cli_begin();
    cli_run_well("ADD t FIELDS a,z  0 0 1.5 nan  4 0 7 7");
    cli_run_well("DEL t 0 1");
    copy_to_u();
    expect_equal_sets("fields");
    expect_equal_sets("points");
    CHECK(strstr(cli_run(&status, "stat u"), "triangulated=no") != NULL);
    cli_finish();
}

TEST(copy_keeps_when_a_set_expires)
{
    int status;
    cli_begin();
    cli_run_well("ADD t 0 0  4 0");
    copy_to_u();
    cli_expect("ttl u", "OK 0\n");
    cli_run_well("drop u");
    cli_run_well("expire t 5000");
    copy_to_u();
    const char *got = cli_run(&status, "ttl u");
    double left = strtod(got + strlen("OK 0 ttl="), NULL);
    CHECK_MSG(left > 4000 && left <= 5000, "%s", got);
    cli_finish();
}

/* Point 1 was an alias of point 0; so points 1 and 2 are both representatives, although they are nearer than the tolerance. */
TEST(copy_that_would_have_other_aliases_is_refused_and_leaves_nothing)
{
    char command[200];
    int status;
    cli_begin();
    cli_run_well("CREATE t TOL 0.5");
    cli_run_well("ADD t 0 0  0.4 0  0.8 0  9 9");
    cli_run_well("DEL t 0");
    snprintf(command, sizeof command,
             "copy t delaunay://127.0.0.1:%s delaunay://127.0.0.1:%s/u 2>&1", cli_daemon.port_text,
             cli_daemon.port_text);
    const char *got = cli_run(&status, command);
    CHECK_MSG(status != 0 && strstr(got, "depends on deleted points") != NULL, "%s", got);
    CHECK(strstr(cli_run(&status, "stat u 2>&1"), "NOSET") != NULL);
    cli_finish();
}

TEST(copy_deletes_in_requests_that_are_short_enough_for_the_server)
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

TEST(show_fits_wide_and_high_sets_and_single_places)
{
    cli_begin();
    show("5 5", "⠁   \n");
    show("0 3  7 3", "⠉⠉⠉⠉\n");
    show("3 0  3 70", "⡇   \n⡇   \n");
    show("0 0  7 0  7 1  0 1", "⠛⠛⠛⠛\n");
    show("0 0  7 3.6", "⢀⡠⠔⠊\n⠁   \n");
    show("0 0  3 0  3 7  0 7", "⣯⢹  \n⣇⣻  \n");
    show("0 0  1 0  1 70  0 70", "⡇   \n⡇   \n");
    cli_finish();
}

TEST(show_accepts_sizes_from_1_to_2000)
{
    static const char *const wrong[] = {"--width 0", "--width 2001", "--height 0", "--height x",
                                        "--width -1"};
    cli_begin();
    cli_run_well("ADD t 0 0  1 0  0 1");
    cli_run_well("triangulate t");
    cli_run_well("show t --width 1 --height 1");
    cli_run_well("show t --width 2000 --height 1");
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char arguments[60];
        int status;
        snprintf(arguments, sizeof arguments, "show t %s", wrong[i]);
        cli_run(&status, arguments);
        CHECK_MSG(status == 2, "%s", wrong[i]);
    }
    cli_finish();
}

/* The colour of a cell is that of the hull, else that of a point, else that of an edge. */
TEST(show_draws_the_hull_over_points_over_edges_in_colour)
{
    char out[4000];
    cli_begin();
    cli_run_well("ADD t 0 0  39 0  39 39  0 39  20 20");
    cli_run_well("triangulate t");
    cli_run_on_terminal(cli_daemon.port_text, "show t --width 20 --height 10", out, sizeof out);
    CHECK(strncmp(out, "\033[0m\033[31m", 9) == 0);  /* the corner is on the hull, and a point */
    CHECK(strstr(out, "\033[0m\033[2;34m") != NULL); /* edges */
    const char *point = strstr(out, "\033[0m\033[1;33m");
    CHECK(point != NULL && strstr(point + 1, "\033[0m\033[1;33m") == NULL); /* the interior point */
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
    const char *got =
        peer_shell(&status,
                   "bash -c 'source <(%s completion); COMP_WORDS=(%s tri); COMP_CWORD=1; "
                   "COMP_LINE=${COMP_WORDS[*]}; _delaunay; echo ${COMPREPLY[*]}'",
                   getenv("DELAUNAY"), getenv("DELAUNAY"));
    CHECK_STR(got, "triangulate triangles\n");
    CHECK(strstr(cli_run(&status, "top --once"), "uptime_s ") != NULL);
    cli_finish();
}

/* Counters grow by ten with every INFO. */
static void inform_of_progress(int fd)
{
    char line[100], reply[100];
    for (int commands = 100; peer_hear(fd, line, sizeof line); commands += 10) {
        snprintf(reply, sizeof reply, "OK 2\nuptime_s:5\ncommands:%d\n", commands);
        peer_say(fd, reply);
    }
}

TEST(top_shows_the_counts_of_the_last_second)
{
    char port[8];
    int status;
    peer_start(port, inform_of_progress);
    const char *out =
        peer_shell(&status, "timeout 2.6 %s -p %s top 2>&1", getenv("DELAUNAY"), port);
    CHECK(strstr(out, "110   +10/s\n") != NULL && strstr(out, "120   +10/s\n") != NULL);
    CHECK(strstr(out, " 100\n") != NULL);
    peer_shell(&status, "%s -p %s top --always 2>&1", getenv("DELAUNAY"), port);
    CHECK(status == 2);
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

TEST(top_shows_as_many_facts_as_fit)
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

TEST(files_of_others_are_replaced_only_by_force)
{
    static const char *const commands[] = {"export", "trace"};
    char file[100], command[200], forced[220];
    int status;
    cli_begin();
    snprintf(file, sizeof file, "%s", cli_path("a.svg"));
    cli_run_well("ADD t 0 0  1 0  0 1");
    cli_run_well("triangulate t");
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        cli_write("a.svg", "my drawing");
        snprintf(command, sizeof command, "%s t %s", commands[i], file);
        const char *got = cli_run(&status, command);
        CHECK_MSG(status == 1 && strstr(got, "--force replaces it") != NULL, "%s", got);
        CHECK_STR(peer_shell(&status, "cat %s", file), "my drawing");
        snprintf(forced, sizeof forced, "%s --force", command);
        cli_run_well(forced);
        peer_shell(&status, "grep -q svg %s", file);
        CHECK(status == 0);
    }
    cli_finish();
}

TEST(version_is_that_of_the_daemon)
{
    int status;
    char version[100];
    snprintf(version, sizeof version, "%s",
             peer_shell(&status, "%s --version", getenv("DELAUNAYD")));
    CHECK(status == 0);
    const char *got = peer_shell(&status, "%s --version", getenv("DELAUNAY"));
    CHECK_MSG(status == 0 && strncmp(got, "delaunay ", 9) == 0 &&
                  strcmp(strrchr(got, ' '), strrchr(version, ' ')) == 0,
              "%s", got);
}

TEST(no_color_switches_colours_off)
{
    char out[4000];
    cli_begin();
    cli_run_well("ADD t 0 0  9 0  0 9");
    cli_run_well("triangulate t");
    CHECK(setenv("NO_COLOR", "1", 1) == 0);
    cli_run_on_terminal(cli_daemon.port_text, "show t", out, sizeof out);
    CHECK(out[0] != 0 && strchr(out, '\033') == NULL);
    CHECK(setenv("NO_COLOR", "", 1) == 0); /* as if it were not set */
    cli_run_on_terminal(cli_daemon.port_text, "show t", out, sizeof out);
    CHECK(strchr(out, '\033') != NULL);
    cli_finish();
}
