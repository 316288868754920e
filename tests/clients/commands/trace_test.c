/* trace_test.c - `delaunay trace`: the film of a small set, with a real daemon. */
#include <limits.h>
#include <string.h>
#include <unistd.h>

#include "tests/clients/peer.h"
#include "tests/daemon.h"
#include "tests/test.h"

static const char *run(const struct daemon *d, int *status, const char *arguments)
{
    return peer_shell(status, "%s -h 127.0.0.1 -p %s %s 2>&1", getenv("DELAUNAY"), d->port_text,
                      arguments);
}

static unsigned count(const char *text, const char *what)
{
    unsigned n = 0;
    for (; (text = strstr(text, what)) != NULL; text++)
        n++;
    return n;
}

/* The film of set t, checked to be well formed. */
static const char *film(const struct daemon *d, const char *options)
{
    int status;
    char arguments[100];
    snprintf(arguments, sizeof arguments, "trace t - %s", options);
    const char *svg = run(d, &status, arguments);
    CHECK_MSG(status == 0 && strncmp(svg, "<svg ", 5) == 0, "%s", svg);
    CHECK(strcmp(svg + strlen(svg) - 7, "</svg>\n") == 0);
    CHECK(count(svg, "<path") ==
          count(svg, "</path>") + count(svg, "\"/></marker>") + count(svg, "<path class=\"g\""));
    CHECK(count(svg, "\"") % 2 == 0 && strstr(svg, "nan") == NULL && strstr(svg, "inf") == NULL);
    CHECK(strstr(svg, "<script") == NULL && count(svg, "http") == 1);
    return svg;
}

TEST(trace_makes_the_picture_of_the_readme)
{
    struct daemon d = daemon_start(NULL);
    int status;
    run(&d, &status, "load trace clients/examples/trace.xy");
    CHECK(status == 0);
    run(&d, &status, "trace trace - | cmp - clients/examples/trace.svg");
    CHECK_MSG(status == 0,
              "no longer the same; `delaunay load trace clients/examples/trace.xy` and "
              "`delaunay trace trace clients/examples/trace.svg` make a new one");
    daemon_end(&d);
}

TEST(trace_shows_every_step)
{
    struct daemon d = daemon_start(NULL);
    int status;
    run(&d, &status, "ADD t 0 0  4 0  4 3  0 3  2 1");
    const char *svg = film(&d, "");
    CHECK(count(svg, "<circle") == 5 && count(svg, "class=\"g\"") == 1);
    CHECK(count(svg, "attributeName=\"stroke\"") == 8 && count(svg, "#e9f1fa\" d=") == 4);
    /* One point is enclosed; the others stay in the grid, so that their colour never changes. */
    CHECK(count(svg, "</circle>") == 1 && count(svg, "<text") == 7);
    /* The apex of each of the eight edges is searched for once. */
    CHECK(count(svg, "class=\"e\"") == 8 && count(svg, "class=\"c\"") == 0);
    CHECK(count(film(&d, "--numbers"), "<text") == 12);
    CHECK(strstr(film(&d, "--seconds 12.5"), " dur=\"12.5s\"") != NULL);
    daemon_end(&d);
}

TEST(trace_of_few_and_of_degenerate_points)
{
    static const char *const sets[] = {"7 -3",
                                       "7 -3  7 -3",
                                       "0 0  1 1",
                                       "0 0  1 1  2 2  3 3  5 5",
                                       "0 0  1e60 0  0 1e60",
                                       "0 0  2e-43 0  0 2e-43",
                                       "1e60 1e60  -1e60 -1e60  1 1  1e60 -1e60  -1e60 1e60",
                                       "0 0  1e9 1  2e9 0  3e9 1  4e9 0"};
    struct daemon d = daemon_start(NULL);
    int status;
    for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
        char arguments[200];
        snprintf(arguments, sizeof arguments, "ADD t %s", sets[i]);
        run(&d, &status, arguments);
        CHECK(count(film(&d, ""), "<circle") == (unsigned)(count(sets[i], "  ") + 1));
        run(&d, &status, "DROP t");
    }
    daemon_end(&d);
}

TEST(trace_that_is_refused_leaves_no_file)
{
    static const struct {
        const char *arguments;
        int status;
        const char *want;
    } cases[] = {
        {"trace u FILE", 1, "delaunay: ERR NOSET there is no set u\n"},
        {"trace empty FILE", 1, "delaunay: the set is empty\n"},
        {"trace big FILE", 1, "delaunay: ERR TOOBIG TRACE is for sets of at most 1000 points\n"},
        {"trace t FILE x", 2, NULL},
        {"trace t FILE --seconds 0", 2, NULL},
        {"trace t FILE --seconds x", 2, NULL},
        {"trace t FILE --speed 1", 2, NULL},
        {"trace t /nonexistent/FILE", 1,
         "delaunay: /nonexistent/FILE.part: No such file or directory\n"},
        {"trace t - >/dev/full", 1, NULL},
        {"trace t", 0, "OK 1\nhull 0\n"},
        {"TRACE t", 0, "OK 1\nhull 0\n"}};
    struct daemon d = daemon_start(NULL);
    int status;
    char directory[] = "/tmp/delaunay_trace_XXXXXX", command[PATH_MAX + 200], client[PATH_MAX];
    CHECK(mkdtemp(directory) != NULL && realpath(getenv("DELAUNAY"), client) != NULL);
    run(&d, &status, "CREATE empty");
    run(&d, &status, "ADD t 1 1");
    peer_shell(&status, "seq 1001 | awk '{print $1, $1 * $1}' | %s -p %s load big -",
               getenv("DELAUNAY"), d.port_text);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        snprintf(command, sizeof command, "cd %s && %s -p %s %s 2>&1", directory, client,
                 d.port_text, cases[i].arguments);
        const char *got = peer_shell(&status, "%s", command);
        CHECK_MSG(status == cases[i].status, "%s: %s", cases[i].arguments, got);
        if (cases[i].want != NULL)
            CHECK_STR(got, cases[i].want);
    }
    CHECK_STR(peer_shell(&status, "ls %s", directory), "");
    snprintf(command, sizeof command, "trace t %s/x.svg && ls %s && rm -r %s", directory, directory,
             directory);
    const char *got = run(&d, &status, command);
    CHECK_MSG(status == 0 && strstr(got, "x.svg: 1 points, 1 steps\nx.svg\n") != NULL, "%s", got);
    daemon_end(&d);
}

TEST(trace_to_a_file_that_cannot_be_written_leaves_none)
{
    struct daemon d = daemon_start(NULL);
    int status;
    char directory[] = "/tmp/delaunay_full_XXXXXX", client[PATH_MAX];
    CHECK(mkdtemp(directory) != NULL && realpath(getenv("DELAUNAY"), client) != NULL);
    run(&d, &status, "ADD t 0 0  4 0  4 3  0 3  2 1");
    const char *got = peer_shell(
        &status, "cd %s && trap '' XFSZ && ulimit -f 1 && %s -h 127.0.0.1 -p %s trace t a.svg 2>&1",
        directory, client, d.port_text);
    CHECK_STR(got, "delaunay: a.svg: File too large\n");
    CHECK(status == 1);
    CHECK_STR(peer_shell(&status, "ls %s && rm -r %s", directory, directory), "");
    daemon_end(&d);
}

/* A server whose rows are not steps. */
static void answer_nonsense(int fd)
{
    static int turn;
    char line[200];
    static const char *const rows[] = {"fly 0",          "point 0 0", "hull 9", "grid 0 0 1 2",
                                       "search 0 0 1 2", "hull 0 0",  "hull x", ""};
    while (peer_hear(fd, line, sizeof line)) {
        if (strncmp(line, "POINTS", 6) == 0) {
            peer_say(fd, "OK 0 rows=1 bytes=20\n");
            CHECK(write(fd, "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 20) == 20);
        } else {
            char reply[100];
            snprintf(reply, sizeof reply, "OK 1\n%s\n", rows[turn++ % 8]);
            peer_say(fd, reply);
        }
    }
}

TEST(trace_refuses_rows_that_are_not_steps)
{
    struct daemon d;
    int status;
    peer_start(d.port_text, answer_nonsense);
    for (int i = 0; i < 8; i++) {
        const char *got = run(&d, &status, "trace t -");
        CHECK_STR(got, "delaunay: a row is not a step, or the set was edited meanwhile\n");
        CHECK(status == 1);
    }
}
