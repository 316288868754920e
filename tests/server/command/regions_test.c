/* regions_test.c - REGIONS, INSIDE and LOCATE through the server: beside ray casting, with workers and without, after restarts and
 * on followers. */
#include "core/delaunay_constraints.h"
#include "tests/server/follow/node.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The beginning of the last line of the replies to several requests. */
static void expect_last(struct local *l, const char *requests, const char *want)
{
    const char *got = local_ask(l, requests), *at = got;
    for (const char *next; (next = strstr(at, "\n")) != NULL && next[1] != '\0';)
        at = next + 1;
    CHECK_MSG(strncmp(at, want, strlen(want)) == 0, "%s gave %s", requests, got);
}

#define SQUARE                                                                                     \
    "ADD t FIELDS z 0 0 1 4 0 2 4 4 3 0 4 4 9 9 5\nTRIANGULATE t\nCONSTRAIN t BORDER OF 1 "        \
    "RING 0 1 2 3\n"

TEST(requests_about_regions_of_another_form_are_refused)
{
    static const char *const cases[][2] = {{"REGIONS t IN", "ERR SYNTAX usage: REGIONS set |"},
                                           {"REGIONS t AT", "ERR SYNTAX usage"},
                                           {"REGIONS t AT 1", "ERR SYNTAX odd"},
                                           {"REGIONS t AT 1 x", "ERR NUMBER"},
                                           {"REGIONS t AT 1 1e300", "ERR RANGE"},
                                           {"REGIONS u", "ERR NOSET"},
                                           {"TRIANGLES t INSIDE 1 1", "ERR SYNTAX"},
                                           {"TRIANGLES t INSIDE x", "ERR SYNTAX"},
                                           {"TRIANGLES t INSIDE 1x", "ERR NUMBER"},
                                           {"TRIANGLES t INSIDE 2147483648", "ERR RANGE"},
                                           {"TRIANGLES t INSIDE 2", "ERR NOREGION"},
                                           {"LISTS t INSIDE", "ERR NUMBER"},
                                           {"EDGES t INSIDE 1 BINARY BINARY", "ERR SYNTAX"},
                                           {"INTERPOLATE t z INSIDE", "ERR SYNTAX"},
                                           {"INTERPOLATE t z 1 1 INSIDE INSIDE", "ERR SYNTAX"},
                                           {"INTERPOLATE t z 1 1 INSIDE 2", "ERR NOREGION"},
                                           {"RASTER t z 0 0 1 1 2 2 INSIDE 2", "ERR NOREGION"},
                                           {"RASTER t y 0 0 1 1 2 2 INSIDE 2", "ERR NOFIELD"},
                                           {"CONTOUR t z INSIDE", "ERR SYNTAX"},
                                           {"CONTOUR t z 1 INSIDE 2", "ERR NOREGION"},
                                           {"CONTOUR t z EVERY 1 INSIDE 2", "ERR NOREGION"}};
    struct local l;
    char line[100];
    local_start(&l, 0);
    local_ask(&l, SQUARE);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(line, sizeof line, "%s\n", cases[i][0]);
        expect_last(&l, line, cases[i][1]);
    }
    local_ask(&l, "RELEASE t BORDER OF 1\nCONSTRAIN t OF 1 RING 0 1 2 3\n");
    expect_last(&l, "REGIONS t\n", "ERR NOREGION the set has no borders");
    expect_last(&l, "CONTOUR t z 1 INSIDE 1\n", "ERR NOREGION the set has no borders");
    local_stop(&l);
}

TEST(locate_says_nothing_of_regions_in_a_set_without_borders)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, SQUARE "CONSTRAIN t 1 3\n");
    CHECK_STR(local_ask(&l, "LOCATE t 1 1\n"), "OK 1 where=inside region=inside\n0 1 3\n");
    CHECK_STR(local_ask(&l, "LOCATE t 4 4\n"), "OK 1 where=vertex region=border\n2\n");
    CHECK_STR(local_ask(&l, "LOCATE t -1 0\n"), "OK 0 where=outside region=outside\n");
    local_ask(&l, "RELEASE t BORDER OF 1\n");
    CHECK_STR(local_ask(&l, "LOCATE t 1 1\n"), "OK 1 where=inside\n0 1 3\n");
    local_stop(&l);
}

TEST(regions_in_resp_are_typed)
{
    struct daemon d = daemon_start((const char *const[]){NULL});
    int fd = daemon_connect(&d);
    say(fd, "ADD t 0 0 4 0 4 4 0 4.5\nTRIANGULATE t\nCONSTRAIN t BORDER OF 1 RING 0 1 2 3\n");
    for (int i = 0; i < 3; i++)
        CHECK(strncmp(hear_line(fd), "OK", 2) == 0);
    say(fd, "*2\r\n$7\r\nREGIONS\r\n$1\r\nt\r\n");
    expect(fd, "*1\r\n$13\r\n1 closed 2 17\r\n");
    say(fd, "*2\r\n$5\r\nHELLO\r\n$1\r\n3\r\n*1\r\n$4\r\nPING\r\n");
    while (strncmp(hear_line(fd), "+PONG", 5) != 0)
        ;
    say(fd, "*2\r\n$7\r\nREGIONS\r\n$1\r\nt\r\n");
    expect(fd, "*1\r\n*4\r\n:1\r\n$6\r\nclosed\r\n:2\r\n:17\r\n");
    say(fd, "*5\r\n$7\r\nREGIONS\r\n$1\r\nt\r\n$2\r\nAT\r\n$1\r\n1\r\n$1\r\n1\r\n");
    expect(fd, "*1\r\n*2\r\n:1\r\n:1\r\n");
    close(fd);
    daemon_end(&d);
}

/* ---- ray casting ---- */

enum { SIDE = 12, NUMBERS = 4 };

struct at {
    long x, y;
};

struct border {
    struct at a, b;
    uint32_t number;
};

struct borders {
    struct border *v; /* owns */
    size_t n;
};

static struct at place_of(const struct dt *t, uint32_t id)
{
    struct dt_point p;
    uint32_t rep;
    CHECK(dt_representative(t, id, &rep) == DT_OK && dt_get(t, rep, &p) == DT_OK);
    return (struct at){(long)p.x * 4, (long)p.y * 4};
}

/* With coordinates times 4. */
static struct borders borders_of(const struct dt *t)
{
    struct dt_constraint *c;
    struct borders b = {0};
    size_t n;
    CHECK(dt_constraints(t, NULL, DT_NONE, &c, &n) == DT_OK);
    b.v = malloc((n + 1) * sizeof *b.v);
    for (size_t i = 0; i < n; i++)
        if (c[i].border)
            b.v[b.n++] = (struct border){place_of(t, c[i].a), place_of(t, c[i].b), c[i].number};
    free(c);
    return b;
}

static long turn(struct at a, struct at b, struct at c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static bool is_on(const struct border *b, struct at q)
{
    bool x = (b->a.x <= q.x && q.x <= b->b.x) || (b->b.x <= q.x && q.x <= b->a.x);
    bool y = (b->a.y <= q.y && q.y <= b->b.y) || (b->b.y <= q.y && q.y <= b->a.y);
    return x && y && turn(b->a, b->b, q) == 0;
}

static bool is_closed(const struct borders *b, uint32_t number)
{
    int odd[SIDE * SIDE] = {0}, open = 0;
    for (size_t i = 0; i < b->n; i++) {
        const struct border *k = &b->v[i];
        if (k->number != number || (k->a.x == k->b.x && k->a.y == k->b.y))
            continue;
        odd[k->a.y / 4 * SIDE + k->a.x / 4] ^= 1;
        odd[k->b.y / 4 * SIDE + k->b.x / 4] ^= 1;
    }
    for (int i = 0; i < SIDE * SIDE; i++)
        open |= odd[i];
    return !open;
}

/* Crossings with the ray to the right. */
static bool cast(const struct borders *b, uint32_t number, struct at q)
{
    bool in = false;
    for (size_t i = 0; i < b->n; i++) {
        struct at p = b->v[i].a, r = b->v[i].b;
        if (b->v[i].number == number && (p.y <= q.y) != (r.y <= q.y))
            in ^= p.y < r.y ? turn(p, r, q) > 0 : turn(r, p, q) > 0;
    }
    return in && is_closed(b, number);
}

/* The row of REGIONS AT, of a place that is on no border; *n: how many regions. */
static void row_of(const struct borders *b, struct at q, char *row, int *n)
{
    char *to = row + 1;
    *n = 0;
    *to = '\0';
    for (uint32_t k = 0; k < NUMBERS; k++)
        if (cast(b, k, q)) {
            to += sprintf(to, " %u", k);
            ++*n;
        }
    row[0] = (char)('0' + *n);
    strcpy(to, "\n");
}

static bool has_borders(const struct borders *b)
{
    return b->n > 0;
}

static void check_place(struct local *l, const struct borders *b, struct at q)
{
    char line[200], row[50];
    int n;
    for (size_t i = 0; i < b->n; i++)
        if (is_on(&b->v[i], q))
            return;
    row_of(b, q, row, &n);
    double x = (double)q.x / 4, y = (double)q.y / 4;
    snprintf(line, sizeof line, "REGIONS t AT %g %g\n", x, y);
    expect_last(l, line, has_borders(b) ? row : "ERR NOREGION");
    snprintf(line, sizeof line, "LOCATE t %g %g\n", x, y);
    const char *got = local_ask(l, line), *region = strstr(got, "region=");
    CHECK_MSG(has_borders(b) ? region != NULL && strncmp(region + 7, n > 0 ? "in" : "ou", 2) == 0
                             : region == NULL,
              "%s: %s", line, got);
    if (!has_borders(b))
        return;
    snprintf(line, sizeof line, "INTERPOLATE t z %g %g INSIDE\n", x, y);
    CHECK_MSG((strstr(local_ask(l, line), "nan") == NULL) == (n > 0), "%s", line);
    for (uint32_t k = 0; k < NUMBERS; k++) {
        snprintf(line, sizeof line, "INTERPOLATE t z %g %g METHOD nearest INSIDE %u\n", x, y, k);
        got = local_ask(l, line);
        if (strncmp(got, "OK", 2) == 0)
            CHECK_MSG((strstr(got, "nan") == NULL) == cast(b, k, q), "%s", line);
        else
            CHECK(!is_closed(b, k) || strncmp(got, "ERR NOREGION", 12) == 0);
    }
}

/* A random edit, which may be refused. */
static void edit(struct local *l, unsigned points)
{
    char line[200];
    unsigned a = test_below(points), b = test_below(points), c = test_below(points),
             d = test_below(points), k = test_below(NUMBERS), x = test_below(SIDE),
             y = test_below(SIDE);
    switch (test_below(9)) {
    case 0:
    case 1:
        snprintf(line, sizeof line, "ADD t FIELDS z %u %u 7\n", x, y);
        break;
    case 2:
        snprintf(line, sizeof line, "DEL t %u\n", a);
        break;
    case 3:
        snprintf(line, sizeof line, "MOVE t %u %u %u\n", a, x, y);
        break;
    case 4:
        snprintf(line, sizeof line, "CONSTRAIN t OF %u %u %u\n", k, a, b);
        break;
    case 5:
        snprintf(line, sizeof line, "RELEASE t BORDER OF %u\n", k);
        break;
    case 6:
        snprintf(line, sizeof line, "CONSTRAIN t BORDER OF %u %u %u\n", k, a, b);
        break;
    case 7:
        snprintf(line, sizeof line, "CONSTRAIN t BORDER OF %u RING %u %u %u %u\n", k, a, b, c, d);
        break;
    default:
        snprintf(line, sizeof line, "CONSTRAIN t BORDER OF %u RING %u %u %u\n", k, a, b, c);
    }
    local_ask(l, line);
}

TEST_TIMEOUT(what_is_inside_after_random_edits_is_that_of_ray_casting, 60)
{
    struct local l;
    local_start(&l, 0);
    for (int round = 0; round < 6; round++) {
        char line[100];
        unsigned points = 30;
        local_ask(&l, round > 0 ? "DROP t\nCREATE t\n" : "CREATE t\n");
        for (unsigned i = 0; i < points; i++) {
            snprintf(line, sizeof line, "ADD t FIELDS z %u %u %u\n", test_below(SIDE),
                     test_below(SIDE), i);
            local_ask(&l, line);
        }
        local_ask(&l, "TRIANGULATE t\n");
        for (int i = 0; i < 60; i++) {
            edit(&l, points);
            local_ask(&l, "REGIONS t\n");
            struct borders b = borders_of(local_set(&l, "t")->current->dt);
            for (int k = 0; k < 4; k++)
                check_place(&l, &b,
                            (struct at){(long)test_below(4 * SIDE + 8) - 4,
                                        (long)test_below(4 * SIDE + 8) - 4});
            free(b.v);
        }
        CHECK(strncmp(local_ask(&l, "CHECK t\n"), "OK", 2) == 0);
    }
    local_stop(&l);
}

/* ---- many points ---- */

/* Requests for a set with nested and overlapping borders, in one of several orders. The caller frees them. */
static char *large_set(unsigned points, bool later)
{
    char *text = malloc(points * 60 + 4000), *to = text;
    static const char borders[] = "CONSTRAIN t BORDER OF 1 RING 0 1 2 3\n"
                                  "CONSTRAIN t BORDER OF 1 RING 4 5 6 7\n"
                                  "CONSTRAIN t BORDER OF 2 RING 0 1 5\n"
                                  "CONSTRAIN t BORDER OF 3 RING 8 9 10\n"
                                  "CONSTRAIN t BORDER OF 4 PATH 4 8\n";
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t FIELDS z\n0 0 1\n100 0 2\n100 100 3\n0 100 4\n30 30 1\n70 30 5\n"
                      "70 70 2\n30 70 2\n40 40 6\n60 40 1\n50 60 2\n");
    for (unsigned i = 0; i < points; i++)
        to += sprintf(to, "%u.%03u %u.%03u %u\n", i * 7919 % 100, i * 31 % 1000, i * 104729 % 100,
                      i * 71 % 1000, i % 17);
    to += sprintf(to, ".\n");
    if (!later)
        to += sprintf(to, "%s", borders);
    to += sprintf(to, "TRIANGULATE t\n");
    if (later)
        to += sprintf(to, "%sREGIONS t\n", borders);
    return text;
}

TEST_TIMEOUT(replies_about_regions_do_not_depend_on_order_or_threads, 60)
{
    static const char *const requests[] = {
        "REGIONS t\n",
        "REGIONS t AT 50 50 20 20 0 0 30 50 100 100 150 0\n",
        "TRIANGLES t INSIDE\n",
        "TRIANGLES t INSIDE 1 CW\n",
        "EDGES t INSIDE 3\n",
        "TRIANGLES t INSIDE 4\n",
        "RASTER t z -10 -10 110 110 100 100 INSIDE\n",
        "RASTER t z -10 -10 110 110 50 50 METHOD nearest INSIDE 2 MAXEDGE 9\n",
        "CONTOUR t z EVERY 3 INSIDE 1\n",
        "CONTOUR t z 8 INSIDE\n",
        "CONTOUR t z EVERY 3 BANDS INSIDE 1\n",
        "CONTOUR t z -inf 2 8 inf BANDS INSIDE\n",
        "CONTOUR t z EVERY 1 BANDS MAXEDGE 5\n",
        "LOCATE t 50 50\n",
        "LOCATE t 30 50\n",
        "INTERPOLATE t z 50 50 20 20 31 32 200 200 INSIDE 1\n",
    };
    struct local none, some;
    char *early = large_set(3000, false), *later = large_set(3000, true);
    local_start(&none, 0);
    local_start(&some, 3);
    local_ask(&none, early);
    local_ask(&some, later);
    for (int round = 0; round < 2; round++) {
        for (size_t i = 0; i < sizeof requests / sizeof *requests; i++) {
            char *want = strdup(local_ask(&none, requests[i]));
            CHECK_STR(local_ask(&some, requests[i]), want);
            free(want);
        }
        static const char edits[] = "DEL t 20 30 40\nADD t 50.5 50.25 40 40.125\nMOVE t 9 60 41\n";
        local_ask(&none, edits);
        local_ask(&some, edits);
    }
    free(early);
    free(later);
    local_stop(&none);
    local_stop(&some);
}

/* The body stays until the regions are known. */
TEST_TIMEOUT(places_in_binary_wait_for_regions_and_are_missing_outside, 60)
{
    struct daemon d = daemon_start((const char *const[]){"--threads", "2", NULL});
    int fd = daemon_connect(&d);
    char *text = large_set(3000, true);
    double value[3];
    say(fd, text);
    say(fd, "PING\nECHO\n");
    while (strncmp(hear_line(fd), "ERR UNKNOWN", 11) != 0)
        ;
    for (int round = 0; round < 2; round++) {
        say(fd, "RELEASE t BORDER OF 3\nINTERPOLATEB t z 3 INSIDE 1\n");
        say_bytes(fd, (const double[]){20, 20, 50, 45, 200, 200}, 48);
        say(fd, "CONSTRAIN t BORDER OF 3 RING 8 9 10\n");
        CHECK(strncmp(hear_line(fd), "OK 0 released=", 14) == 0);
        CHECK_STR(hear_line(fd), "OK 0 rows=3 bytes=24");
        CHECK(read(fd, value, sizeof value) == sizeof value);
        CHECK(value[0] >= 0 && value[0] < 17 && value[1] != value[1] && value[2] != value[2]);
        CHECK(strncmp(hear_line(fd), "OK 0 added=3", 12) == 0);
    }
    free(text);
    close(fd);
    daemon_end(&d);
}

/* A place at a point with very many neighbours. */
TEST_TIMEOUT(regions_at_a_hub_are_found_by_a_worker, 60)
{
    enum { N = 5000 };
    struct local l;
    char *text = malloc(N * 60 + 200), *to = text;
    CHECK(text != NULL);
    to += sprintf(to, "LOAD t\n0 0\n");
    for (int i = 0; i < N; i++) /* on a parabola, so that all are neighbours of the hub */
        to += sprintf(to, "%d %.17g\n", i - N / 2, 1e6 + 0.001 * (i - N / 2) * (i - N / 2));
    sprintf(to, ".\nTRIANGULATE t\nCONSTRAIN t BORDER OF 3 RING 0 1 %d\nREGIONS t\n", N / 2);
    local_start(&l, 2);
    local_ask(&l, text);
    uint64_t jobs = l.server.count.jobs;
    CHECK_STR(local_ask(&l, "LOCATE t 0 0\n"), "OK 1 where=vertex region=border\n0\n");
    CHECK_STR(local_ask(&l, "REGIONS t AT 0 0 0 0\n"), "OK 2\n1 3\n1 3\n");
    CHECK(l.server.count.jobs == jobs + 2);
    CHECK_STR(local_ask(&l, "REGIONS t AT 0 -1\n"), "OK 1\n0\n");
    CHECK(l.server.count.jobs == jobs + 2);
    free(text);
    local_stop(&l);
}

/* ---- daemons ---- */

static char *answers_of(const struct daemon *d)
{
    int fd = daemon_connect(d);
    size_t n;
    say(fd, "REGIONS t\nREGIONS t AT 50 50 20 20 1 1\nTRIANGLES t INSIDE 3\nLOCATE t 30 50\n"
            "RASTER t z 0 0 100 100 20 20 INSIDE 1\nQUIT\n");
    char *all = hear_all(fd, &n);
    close(fd);
    CHECK(strstr(all, "ERR") == NULL && strstr(all, "region=border") != NULL);
    return all;
}

TEST_TIMEOUT(regions_are_the_same_after_kill_9_and_on_a_follower, 60)
{
    struct node l = node_new(NULL), f = node_follower_of(&l);
    char *text = large_set(500, true);
    int fd = daemon_connect(&l.d);
    say(fd, text);
    say(fd, "MOVE t 4 30 31\nADD t 35 35\nQUIT\n");
    free(hear_all(fd, &(size_t){0}));
    close(fd);
    char *want = answers_of(&l.d);
    node_await_position(&l, &f);
    char *got = answers_of(&f.d);
    CHECK_STR(got, want);
    free(got);
    daemon_stop(&l.d, SIGKILL);
    node_start(&l, NULL);
    got = answers_of(&l.d);
    CHECK_STR(got, want);
    free(got);
    free(want);
    free(text);
    node_end(&f);
    node_end(&l);
}
