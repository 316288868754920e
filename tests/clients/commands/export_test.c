/* export_test.c - loading and drawing with a real daemon, and the whole demonstration. */
#include <string.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/daemon.h"
#include "tests/test.h"

/* Runs `delaunay ARGUMENTS` with the daemon; the output includes its messages. */
static const char *run(const struct daemon *d, int *status, const char *arguments)
{
    return peer_shell(status, "%s -h 127.0.0.1 -p %s %s 2>&1", getenv("DELAUNAY"), d->port_text,
                      arguments);
}

static void check_run(const struct daemon *d, const char *arguments, int status, const char *want)
{
    int got_status;
    const char *got = run(d, &got_status, arguments);
    CHECK_STR(got, want);
    CHECK_MSG(got_status == status, "%s: status %d", arguments, got_status);
}

static unsigned count(const char *text, const char *what)
{
    unsigned n = 0;
    for (; (text = strstr(text, what)) != NULL; text++)
        n++;
    return n;
}

TEST(export_draws_a_triangulated_set)
{
    struct daemon d = daemon_start(NULL);
    int status;
    run(&d, &status, "ADD t 0 0  4 0  4 4  0 4  2 2");
    run(&d, &status, "TRIANGULATE t");
    const char *svg = run(&d, &status, "export t -");
    CHECK(status == 0 && strstr(svg, "<svg ") == svg);
    CHECK(count(svg, "h0") == 5 && count(svg, "</text>\n<text") == 4 && count(svg, "zM") == 3);
    CHECK(strstr(svg, "<title>t: Delaunay triangulation of 5 points</title>") != NULL);
    daemon_end(&d);
}

TEST(export_follows_ids_that_have_gaps)
{
    struct daemon d = daemon_start(NULL);
    int status;
    run(&d, &status, "ADD t 9 9  0 0  4 0  7 7  4 4  4 4  0 4");
    run(&d, &status, "DEL t 0 3");
    run(&d, &status, "TRIANGULATE t");
    const char *svg = run(&d, &status, "export t -");
    CHECK(status == 0 && count(svg, "h0") == 5 && strstr(svg, ">6</text>") != NULL);
    daemon_end(&d);
}

TEST(pictures_draw_constraints_bold_and_borders_unlike_lines)
{
    struct daemon d = daemon_start(NULL);
    int status;
    run(&d, &status, "ADD t 0 0  8 0  8 8  0 8  2 2");
    run(&d, &status, "TRIANGULATE t");
    const char *svg = run(&d, &status, "export t -");
    CHECK(status == 0 && count(svg, "class=\"c\"") == 0 && count(svg, "class=\"b\"") == 0);
    run(&d, &status, "CONSTRAIN t OF 3 0 4");
    run(&d, &status, "CONSTRAIN t BORDER RING 0 1 2");
    svg = run(&d, &status, "export t - --viewport -2,-2,4,4");
    CHECK(status == 0 && count(svg, "class=\"c\"") == 1 && count(svg, "class=\"b\"") >= 1);
    CHECK(strstr(svg, "class=\"c\" stroke=\"#1f1f1f\"") != NULL);
    CHECK(strstr(svg, "class=\"b\" stroke=\"#7b2d8b\"") != NULL);
    svg = run(&d, &status, "export t -");
    CHECK(status == 0 && strstr(svg, "M400 16400L4400 12400\"") != NULL); /* 0 to 4 */
    daemon_end(&d);
}

TEST(show_draws_constraints_also_where_there_are_too_many_edges_to_draw)
{
    struct daemon d = daemon_start(NULL);
    int status;
    run(&d, &status, "ADD t 0 0  1 0  2 0  3 0  0 3  1 3  2 3  3 3");
    run(&d, &status, "TRIANGULATE t");
    check_run(&d, "show t --width 2 --height 1", 0, "\xE2\xA3\x8F\xE2\xA3\xB9\n");
    run(&d, &status, "CONSTRAIN t 0 7");
    check_run(&d, "show t --width 2 --height 1", 0, "\xE2\xA3\xAF\xE2\xA3\xBB\n");
    daemon_end(&d);
}

TEST(show_draws_regions_in_colours_and_the_outside_pale_on_a_terminal)
{
    static const char outside[] = "\033[2;37m", edge[] = "\033[2;34m", first[] = "\033[0m\033[34m",
                      third[] = "\033[0m\033[36m";
    char out[20000];
    int status;
    struct daemon d = daemon_start(NULL);
    run(&d, &status, "ADD t 0 0  8 0  8 8  0 8  40 0  40 8");
    run(&d, &status, "TRIANGULATE t");
    cli_run_on_terminal(d.port_text, "show t --width 60 --height 12", out, sizeof out);
    CHECK_MSG(strstr(out, outside) == NULL && strstr(out, edge) != NULL, "%s", out);
    CHECK(strstr(out, first) == NULL && strstr(out, third) == NULL);
    run(&d, &status, "ADD t 24 0");
    run(&d, &status, "CONSTRAIN t BORDER RING 0 1 2 3");
    run(&d, &status, "CONSTRAIN t BORDER OF 8 RING 6 4 5"); /* the colours repeat after six */
    cli_run_on_terminal(d.port_text, "show t --width 60 --height 12", out, sizeof out);
    CHECK_MSG(strstr(out, outside) != NULL && strstr(out, edge) == NULL, "%s", out);
    CHECK_MSG(strstr(out, first) != NULL && strstr(out, third) == NULL, "%s", out);
    run(&d, &status, "ADD t 35 3");
    cli_run_on_terminal(d.port_text, "show t --width 60 --height 12", out, sizeof out);
    CHECK_MSG(strstr(out, first) != NULL && strstr(out, third) != NULL, "%s", out);
    daemon_end(&d);
}

TEST(show_draws_heights_outside_borders_pale_on_a_terminal)
{
    char plain[20000], pale[20000], again[20000];
    int status;
    struct daemon d = daemon_start(NULL);
    run(&d, &status, "ADD t FIELDS z 0 0 1 8 0 1 8 8 1 0 8 1 40 0 1 40 8 1");
    run(&d, &status, "TRIANGULATE t");
    cli_run_on_terminal(d.port_text, "show t --width 60 --height 12", plain, sizeof plain);
    run(&d, &status, "CONSTRAIN t BORDER RING 0 1 2 3");
    cli_run_on_terminal(d.port_text, "show t --width 60 --height 12", pale, sizeof pale);
    CHECK_MSG(strlen(pale) > strlen(plain), "%s%s", plain, pale); /* a second colour in each line */
    run(&d, &status, "RELEASE t ALL");
    cli_run_on_terminal(d.port_text, "show t --width 60 --height 12", again, sizeof again);
    CHECK_STR(again, plain);
    daemon_end(&d);
}

TEST(export_that_is_refused_leaves_no_file)
{
    struct daemon d = daemon_start(NULL);
    int status;
    char path[64], part[80], arguments[100];
    snprintf(path, sizeof path, "/tmp/delaunay_export_test.%d.svg", getpid());
    snprintf(part, sizeof part, "%s.part", path);
    snprintf(arguments, sizeof arguments, "export t %s", path);
    check_run(&d, arguments, 1, "delaunay: ERR NOSET there is no set t\n");
    run(&d, &status, "CREATE t");
    check_run(&d, arguments, 1, "delaunay: the set is empty\n");
    run(&d, &status, "ADD t 0 0");
    check_run(&d, arguments, 1, "delaunay: ERR UNTRIANGULATED TRIANGULATE the set first\n");
    CHECK(access(path, F_OK) != 0 && access(part, F_OK) != 0);
    run(&d, &status, "TRIANGULATE t");
    run(&d, &status, arguments);
    CHECK(status == 0 && access(path, F_OK) == 0 && access(part, F_OK) != 0);
    unlink(path);
    check_run(&d, "export t /nonexistent/x.svg", 1,
              "delaunay: /nonexistent/x.svg.part: No such file or directory\n");
    daemon_end(&d);
}

static uint32_t big_endian(const unsigned char *b)
{
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

/* The width and height in the first chunk of the PNG must be those that the drawing gives. */
static void check_png(const char *path, const char *svg)
{
    unsigned char head[24];
    unsigned width, height;
    CHECK(sscanf(strstr(svg, " width=\""), " width=\"%u\" height=\"%u\"", &width, &height) == 2);
    FILE *f = fopen(path, "rb");
    CHECK(f != NULL && fread(head, 1, sizeof head, f) == sizeof head);
    CHECK(memcmp(head, "\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16) == 0);
    CHECK_MSG(big_endian(head + 16) == width && big_endian(head + 20) == height, "%u x %u",
              big_endian(head + 16), big_endian(head + 20));
    CHECK(fseek(f, 0, SEEK_END) == 0 && ftell(f) > 1000); /* an empty picture is smaller */
    fclose(f);
}

TEST(export_png_by_way_of_a_converter)
{
    struct daemon d = daemon_start(NULL);
    int status;
    char directory[] = "/tmp/delaunay_png_XXXXXX", command[300], png[64];
    CHECK(mkdtemp(directory) != NULL);
    snprintf(png, sizeof png, "%s/t.png", directory);
    run(&d, &status, "ADD t 0 0  4 0  4 3  0 3  2 1");
    run(&d, &status, "TRIANGULATE t");
    snprintf(command, sizeof command, "export t %s", png);
    const char *got = peer_shell(&status, "PATH=/nonexistent %s -h 127.0.0.1 -p %s %s 2>&1",
                                 getenv("DELAUNAY"), d.port_text, command);
    CHECK(status == 1 && strstr(got, "PNG needs rsvg-convert (Debian: librsvg2-bin)") != NULL);
    CHECK_STR(peer_shell(&status, "ls %s", directory), "");
    check_run(&d, "export t - --format png", 2,
              "delaunay: a PNG needs a file\nTry 'delaunay export --help'.\n");
    peer_shell(&status, "command -v rsvg-convert || command -v inkscape");
    bool can_convert = status == 0;
    if (can_convert) {
        got = run(&d, &status, command);
        CHECK_MSG(status == 0, "%s", got);
        check_png(png, run(&d, &status, "export t -"));
        CHECK_STR(peer_shell(&status, "ls %s", directory), "t.pgw\nt.png\n");
    }
    peer_shell(&status, "rm -r %s", directory);
    daemon_end(&d);
    if (!can_convert)
        SKIP("the Debian package librsvg2-bin is missing");
}

TEST(export_to_a_full_disk_fails)
{
    struct daemon d = daemon_start(NULL);
    int status;
    run(&d, &status, "ADD t 0 0  1 0  0 1");
    run(&d, &status, "TRIANGULATE t");
    if (access("/dev/full", W_OK) == 0) {
        run(&d, &status, "export t - > /dev/full");
        CHECK(status == 1);
        static const char *const commands[] = {
            "POINTS t", "--version", "metrics", "stat t --json", "export t -", "--help", "ping"};
        for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
            const char *got = peer_shell(&status, "%s -h 127.0.0.1 -p %s %s 2>&1 > /dev/full",
                                         getenv("DELAUNAY"), d.port_text, commands[i]);
            CHECK_MSG(status == 1 && strncmp(got, "delaunay: standard output: ", 27) == 0, "%s: %s",
                      commands[i], got);
        }
    }
    daemon_end(&d);
}

/* A file that cannot grow beyond 1024 bytes, as on a full disk: with a small set closing the file fails,
 * with a large one an earlier write. */
TEST(export_to_a_file_that_cannot_be_written_leaves_none)
{
    char *client = realpath(getenv("DELAUNAY"), NULL);
    CHECK(client != NULL);
    struct daemon d = daemon_start(NULL);
    int status;
    char directory[] = "/tmp/delaunay_full_XXXXXX";
    CHECK(mkdtemp(directory) != NULL);
    for (int points = 100; points <= 30000; points *= 300) {
        peer_shell(&status,
                   "seq -f '%%g 0' %d | %s -h 127.0.0.1 -p %s load t - && %s -p %s add t 1 1",
                   points, getenv("DELAUNAY"), d.port_text, getenv("DELAUNAY"), d.port_text);
        CHECK(status == 0);
        run(&d, &status, "triangulate t");
        const char *got = peer_shell(
            &status,
            "cd %s && trap '' XFSZ && ulimit -f 1 && %s -h 127.0.0.1 -p %s export t a.svg 2>&1",
            directory, client, d.port_text);
        CHECK_STR(got, "delaunay: a.svg: File too large\n");
        CHECK(status == 1);
        CHECK_STR(peer_shell(&status, "ls %s", directory), "");
        run(&d, &status, "drop t");
    }
    free(client);
    peer_shell(&status, "rm -r %s", directory);
    daemon_end(&d);
}

TEST(load_gives_points_the_numbers_of_their_lines_as_ids)
{
    struct daemon d = daemon_start(NULL);
    int status;
    const char *out =
        peer_shell(&status, "printf '5 6\\n7 8\\n5 6\\n' | %s -h 127.0.0.1 -p %s load t -",
                   getenv("DELAUNAY"), d.port_text);
    CHECK_STR(out, "OK 0 first=0 added=3 coincident=1\n");
    check_run(&d, "POINTS t", 0, "OK 3\n0 5 6\n1 7 8\n2 5 6\n");
    check_run(
        &d, "load t /dev/null", 0,
        "delaunay: /dev/null: there are no points in it\nOK 0 first=3 added=0 coincident=0\n");
    daemon_end(&d);
}

TEST_TIMEOUT(demo_shows_the_whole_service, 60)
{
    int status;
    char svg[64], contours[64], cells[64];
    snprintf(svg, sizeof svg, "/tmp/delaunay_demo_test.%d.svg", getpid());
    snprintf(contours, sizeof contours, "/tmp/delaunay_demo_contours.%d.svg", getpid());
    snprintf(cells, sizeof cells, "/tmp/delaunay_demo_cells.%d.svg", getpid());
    const char *out =
        peer_shell(&status, "clients/demo.sh %s %s tests/data/cities.xy %s %s %s 2>&1",
                   getenv("DELAUNAYD"), getenv("DELAUNAY"), svg, contours, cells);
    CHECK_MSG(status == 0, "%s", out);
    CHECK(strstr(out, "OK 0 first=0 added=171075 coincident=37 version=") != NULL);
    CHECK(strstr(out, "OK 0 delaunay=yes points=171075 coincident=37 triangles=") != NULL);
    CHECK(strstr(out, "\nParis (FR): Paris 03 Temple (FR), ") != NULL && access(svg, F_OK) == 0);
    /* distances on a sphere, not in degrees */
    const char *near = strstr(out, "delaunay NEAREST around 0 0 5\nOK 5\nParis 16 Passy (FR) ");
    double km = 0;
    CHECK(near != NULL && sscanf(strstr(near, "(FR)") + 4, "%lf km", &km) == 1);
    CHECK(km > 1.41 && km < 1.43 && strstr(near, "Paris 07 Palais-Bourbon (FR)") != NULL);
    CHECK(strstr(out, "\xE2\xA3\xBF\xE2\xA3\xBF") != NULL); /* the map */
    CHECK(strstr(out, ": 517 lines, 337 of them closed\n") != NULL && access(contours, F_OK) == 0);
    CHECK(strstr(out, " cells\n") != NULL && access(cells, F_OK) == 0);
    unlink(svg);
    unlink(contours);
    unlink(cells);
}

TEST(demo_fails_if_a_step_fails)
{
    int status;
    const char *out = peer_shell(&status, "clients/demo.sh %s %s /dev/null /nonexistent/x.svg 2>&1",
                                 getenv("DELAUNAYD"), getenv("DELAUNAY"));
    CHECK_MSG(status == 1 && strstr(out, "demo: failed") != NULL, "%s", out);
    out = peer_shell(&status, "clients/demo.sh /bin/false %s /dev/null /tmp/x.svg 2>&1",
                     getenv("DELAUNAY"));
    CHECK_MSG(status == 1 && strstr(out, "did not start") != NULL, "%s", out);
}
