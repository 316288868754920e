/* delaunay_mirror_test.c - mirrors: equal to POINTS, LISTS, TRIANGLES and CONSTRAINTS after every edit, over connections that end, with
 * servers that are faulty, and out of memory. */
#include "clients/lib/delaunay_mirror.h"

#include <math.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "clients/lib/mirror_copy.h"
#include "tests/clients/peer.h"
#include "tests/daemon.h"
#include "tests/test.h"

enum { MOST = 2000 }; /* triangles and rows of these tests */

static struct delaunay_client *client;

static struct delaunay_mirror *mirror_of(const char *port, const char *set,
                                         const struct delaunay_mirror_options *options)
{
    char why[200];
    struct delaunay_mirror *m =
        delaunay_mirror_open("127.0.0.1", port, set, options, why, sizeof why);
    CHECK_MSG(m != NULL, "%s", why);
    return m;
}

static void connect_to(const char *port)
{
    char why[200];
    client = delaunay_connect("127.0.0.1", port, why, sizeof why);
    CHECK_MSG(client != NULL, "%s", why);
}

static void ask(const char *line)
{
    CHECK_MSG(delaunay_request(client, line, NULL, NULL) == DELAUNAY_OK, "%s: %s", line,
              delaunay_status(client)->text);
}

static uint64_t version_of(const char *set)
{
    char line[100];
    uint64_t version;
    snprintf(line, sizeof line, "STAT %s", set);
    ask(line);
    CHECK(delaunay_key_number(delaunay_status(client), "version", &version));
    return version;
}

/* ---- the triangles that changes report ---- */

struct ledger {
    uint32_t t[MOST][3];
    size_t n, points, constraints;
};

static size_t position(const struct ledger *l, const uint32_t *t)
{
    size_t k = 0;
    while (k < l->n && memcmp(l->t[k], t, sizeof l->t[k]) != 0)
        k++;
    return k;
}

/* An added triangle must be new, a removed one must have been in the ledger. */
static void note(struct ledger *l, const struct delaunay_change *change)
{
    for (size_t i = 0; i < change->n_triangles_removed; i++) {
        size_t k = position(l, change->triangles_removed + 3 * i);
        CHECK(k < l->n);
        memcpy(l->t[k], l->t[--l->n], sizeof l->t[k]);
    }
    for (size_t i = 0; i < change->n_triangles_added; i++) {
        CHECK(l->n < MOST && position(l, change->triangles_added + 3 * i) == l->n);
        memcpy(l->t[l->n++], change->triangles_added + 3 * i, sizeof l->t[0]);
    }
    for (size_t i = 0; i < change->n_triangles_removed; i++) {
        for (size_t k = 0; k < change->n_triangles_added; k++)
            CHECK(memcmp(change->triangles_removed + 3 * i, change->triangles_added + 3 * k,
                         sizeof l->t[0]) != 0);
    }
    l->points += change->n_added - change->n_gone;
    l->constraints += change->n_constraints_added - change->n_constraints_released;
}

/* ---- comparison with replies ---- */

struct comparison {
    const struct delaunay_mirror *m;
    const struct ledger *l;
    char kind; /* p, l, t */
    size_t rows, interior;
};

static void check_point(const struct comparison *c, const char *row)
{
    char *at;
    double xy[2], z = 0;
    uint32_t id = (uint32_t)strtoul(row, &at, 10);
    CHECK_MSG(delaunay_mirror_point(c->m, id, xy, &z), "%s", row);
    CHECK(xy[0] == strtod(at, &at) && xy[1] == strtod(at, &at));
    double value = *at == ' ' ? strtod(at, &at) : 0;
    CHECK_MSG(z == value || (isnan(z) && isnan(value)), "%s, not %g", row, z);
}

static void check_ring(const struct comparison *c, const char *row)
{
    char *at;
    const uint32_t *ring;
    bool interior;
    uint32_t id = (uint32_t)strtoul(row, &at, 10);
    size_t k = 0, n = delaunay_mirror_ring(c->m, id, &ring, &interior);
    for (; *at == ' '; k++)
        CHECK_MSG(k < n && ring[k] == strtoul(at, &at, 10), "%s", row);
    CHECK_MSG(k == n && (n == 0 || interior == (c->rows < c->interior)), "%s", row);
}

static bool check_row(void *ctx, const struct delaunay_part *part)
{
    struct comparison *c = ctx;
    uint64_t interior;
    char row[1000];
    uint32_t t[3];
    if (part->kind == DELAUNAY_PART_OK && delaunay_key_number(part, "interior", &interior))
        c->interior = (size_t)interior;
    if (part->kind != DELAUNAY_PART_ROW)
        return true;
    snprintf(row, sizeof row, "%.*s", (int)part->len, part->text);
    if (c->kind == 'p')
        check_point(c, row);
    else if (c->kind == 'l')
        check_ring(c, row);
    else
        CHECK_MSG(sscanf(row, "%u %u %u", t, t + 1, t + 2) == 3 && position(c->l, t) < c->l->n,
                  "%s", row);
    c->rows++;
    return true;
}

/* The number of rows of a reply, all of which the mirror has. */
static size_t compare_rows(const struct delaunay_mirror *m, const struct ledger *l, char kind,
                           const char *line)
{
    struct comparison c = {m, l, kind, 0, 0};
    CHECK(delaunay_request(client, line, check_row, &c) == DELAUNAY_OK);
    return c.rows;
}

static size_t rings_of(const struct delaunay_mirror *m)
{
    const uint32_t *ring;
    bool interior;
    size_t n = 0;
    for (uint32_t id = 0; id < delaunay_mirror_ids(m); id++)
        n += delaunay_mirror_ring(m, id, &ring, &interior) > 0;
    return n;
}

struct constraint_rows {
    const struct delaunay_segment *at;
    size_t n, seen;
};

static bool check_constraint(void *ctx, const struct delaunay_part *part)
{
    struct constraint_rows *c = ctx;
    char want[80];
    if (part->kind != DELAUNAY_PART_ROW)
        return true;
    CHECK(c->seen < c->n);
    const struct delaunay_segment *row = &c->at[c->seen++];
    snprintf(want, sizeof want, "%u %u %s %u", row->a, row->b, row->border ? "border" : "line",
             row->number);
    CHECK_MSG(strlen(want) == part->len && memcmp(want, part->text, part->len) == 0, "%s, not %.*s",
              want, (int)part->len, part->text);
    return true;
}

static void compare_constraints(struct delaunay_mirror *m, const struct ledger *l)
{
    struct constraint_rows c = {.seen = 0};
    CHECK(delaunay_mirror_constraints(m, &c.at, &c.n) == DELAUNAY_OK);
    CHECK(delaunay_request(client, "CONSTRAINTS t", check_constraint, &c) == DELAUNAY_OK);
    CHECK(c.seen == c.n && c.n == l->constraints);
}

/* Follows up to the version that the set has now, and compares. */
static void compare(struct delaunay_mirror *m, struct ledger *l, const char *fields)
{
    struct delaunay_change change;
    char line[100];
    for (uint64_t version = version_of("t"); delaunay_mirror_version(m) < version; note(l, &change))
        CHECK(delaunay_mirror_next(m, -1, &change) == DELAUNAY_OK);
    snprintf(line, sizeof line, "POINTS t%s", fields);
    size_t points = compare_rows(m, l, 'p', line);
    CHECK(points == delaunay_mirror_points(m) && points == l->points);
    compare_constraints(m, l);
    if (delaunay_request(client, "TRIANGLES t", NULL, NULL) == DELAUNAY_REFUSED) {
        CHECK(l->n == 0 && rings_of(m) == 0);
        return;
    }
    CHECK(compare_rows(m, l, 't', "TRIANGLES t") == l->n);
    size_t rings = compare_rows(m, l, 'l', "LISTS t");
    CHECK(rings == rings_of(m) || (rings == 1 && l->n == 0)); /* a single point has no neighbours */
}

/* ---- histories ---- */

/* One edit of a set with few places, so that there are coincident points and points on a line; it may be refused. */
static void edit(const struct delaunay_mirror *m)
{
    char line[1000];
    unsigned ids = delaunay_mirror_ids(m) + 1, x = test_below(6), y = test_below(5);
    int n = 0;
    switch (test_below(13)) {
    case 10:
    case 11:
        snprintf(line, sizeof line, "CONSTRAIN t%s OF %u %u %u", x % 2 == 0 ? " BORDER" : "", y % 3,
                 test_below(ids), test_below(ids));
        break;
    case 12:
        snprintf(line, sizeof line, y == 0 ? "RELEASE t ALL" : "RELEASE t OF %u", y % 3);
        break;
    case 0:
    case 1:
    case 2:
        snprintf(line, sizeof line, "DEL t %u CASCADE", test_below(ids));
        break;
    case 3:
    case 4:
    case 5:
        snprintf(line, sizeof line, "MOVE t %u %u %u", test_below(ids), x, y);
        break;
    case 6:
        snprintf(line, sizeof line, "TRIANGULATE t");
        break;
    case 7:
        n = snprintf(line, sizeof line, "ADD t");
        for (int k = 0; k < 20; k++)
            n +=
                snprintf(line + n, sizeof line - (size_t)n, " %u %u", test_below(6), test_below(5));
        break;
    default:
        snprintf(line, sizeof line, "ADD t %u %u", x, y);
    }
    CHECK(delaunay_request(client, line, NULL, NULL) <= DELAUNAY_REFUSED);
}

static void follow(const char *port, int edits)
{
    struct ledger l = {0};
    ask("CREATE t");
    struct delaunay_mirror *m = mirror_of(port, "t", NULL);
    for (int i = 0; i < edits; i++) {
        edit(m);
        compare(m, &l, "");
    }
    struct delaunay_change change;
    ask("DROP t");
    enum delaunay_result r;
    while ((r = delaunay_mirror_next(m, -1, &change)) == DELAUNAY_OK)
        ;
    CHECK(r == DELAUNAY_DROPPED && delaunay_mirror_next(m, 0, &change) == DELAUNAY_DROPPED);
    delaunay_mirror_close(m);
}

TEST_TIMEOUT(mirror_is_what_points_lists_and_triangles_say_after_every_edit, 120)
{
    struct daemon d = daemon_start(NULL);
    connect_to(d.port_text);
    for (int round = 0; round < 20; round++)
        follow(d.port_text, 40);
    delaunay_close(client);
    daemon_end(&d);
}

TEST_TIMEOUT(mirror_has_the_values_of_fields, 60)
{
    struct daemon d = daemon_start(NULL);
    struct ledger l = {0};
    struct delaunay_mirror_options options = {.fields = "z"};
    char line[100];
    connect_to(d.port_text);
    ask("ADD t FIELDS z 0 0 1  4 0 2  0 4 3  5 4 nan");
    ask("TRIANGULATE t");
    struct delaunay_mirror *m = mirror_of(d.port_text, "t", &options);
    for (int i = 0; i < 60; i++) {
        snprintf(line, sizeof line, "FSET t z %u %d.5", test_below(4), i);
        CHECK(delaunay_request(client, line, NULL, NULL) <= DELAUNAY_REFUSED);
        compare(m, &l, " FIELDS z");
        edit(m);
        compare(m, &l, " FIELDS z");
    }
    delaunay_mirror_close(m);
    delaunay_close(client);
    daemon_end(&d);
}

static unsigned behind; /* the port of the daemon behind the relay */

static int connect_behind(void)
{
    struct sockaddr_in addr = {.sin_family = AF_INET,
                               .sin_port = htons((uint16_t)behind),
                               .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    if (fd < 0 || connect(fd, (struct sockaddr *)&addr, sizeof addr) != 0)
        _exit(1);
    return fd;
}

/* Passes bytes to the daemon and back, and ends after some thousands of them. */
static void relay(int fd)
{
    static int connections;
    char bytes[512];
    int daemon = connect_behind(), left = 2000 + 777 * (connections++ % 5);
    struct pollfd p[2] = {{fd, POLLIN, 0}, {daemon, POLLIN, 0}};
    while (left > 0 && poll(p, 2, -1) > 0) {
        int from = p[0].revents != 0 ? 0 : 1;
        ssize_t n = read(p[from].fd, bytes, sizeof bytes);
        if (n <= 0)
            break;
        if (from == 1 && n > left)
            n = left;
        left -= from == 1 ? (int)n : 0;
        peer_send(p[1 - from].fd, bytes, (size_t)n);
    }
    close(daemon);
}

TEST_TIMEOUT(mirror_goes_on_after_connections_that_end_in_the_middle_of_events, 120)
{
    char port[8];
    struct daemon d = daemon_start(NULL);
    connect_to(d.port_text);
    behind = d.port;
    peer_start(port, relay);
    follow(port, 60);
    delaunay_close(client);
    daemon_end(&d);
}

TEST(mirror_waits_as_long_as_it_is_told_and_has_a_descriptor)
{
    struct daemon d = daemon_start(NULL);
    struct delaunay_change change;
    connect_to(d.port_text);
    ask("ADD t 0 0 4 0 0 4");
    struct delaunay_mirror *m = mirror_of(d.port_text, "t", NULL);
    CHECK(delaunay_mirror_next(m, -1, &change) == DELAUNAY_OK && change.reset);
    CHECK(change.n_added == 3 && change.n_moved == 0 && change.n_gone == 0);
    CHECK(delaunay_mirror_next(m, 0, &change) == DELAUNAY_TIMEOUT);
    CHECK(delaunay_mirror_next(m, 5, &change) == DELAUNAY_TIMEOUT);
    ask("MOVE t 1 5 5");
    struct pollfd p = {delaunay_mirror_descriptor(m), POLLIN, 0};
    CHECK(poll(&p, 1, -1) == 1);
    CHECK(delaunay_mirror_next(m, -1, &change) == DELAUNAY_OK);
    CHECK(change.n_moved == 1 && change.moved[0] == 1 && change.version == version_of("t"));
    delaunay_mirror_close(m);
    delaunay_close(client);
    daemon_end(&d);
}

/* ---- servers that are faulty ---- */

#define SET                                                                                        \
    "EVENT 5 set=t version=7 reset\npoint 0 0 0\npoint 1 4 0\npoint 2 0 4\nlist 0 b 1 2\nlist 1 "  \
    "b 2 0\n"

/* The first connection gets a set and ends in the middle of an event; the second one is refused; the third one gets another event;
 * the set of the fourth one is gone. */
static void end_slowly(int fd)
{
    static int connections;
    char line[200];
    CHECK(peer_hear(fd, line, sizeof line));
    switch (connections++) {
    case 0:
        CHECK_STR(line, "WATCH t WITHIN 0 0 1 0.5 CONSTRAINTS");
        peer_say(fd, "OK 0 version=7\n" SET "EVENT 2 set=t version=8\npoint 1 9 9\n");
        break;
    case 1:
        CHECK_STR(line, "WATCH t SINCE 7 WITHIN 0 0 1 0.5 CONSTRAINTS");
        peer_say(fd, "ERR LOADING try again later\n");
        break;
    case 2:
        peer_say(fd, "OK 0 version=9\nEVENT 2 set=t version=9\npoint 2 0 5\nlist 2 b 0 1\n");
        break;
    default:
        peer_say(fd, "ERR NOSET there is no such set\n");
    }
}

TEST(mirror_keeps_its_copy_until_the_set_is_known_to_be_gone)
{
    char port[8];
    double xy[2];
    struct delaunay_change change;
    struct delaunay_mirror_options options = {.within = (double[]){0, 0, 1, 0.5}};
    peer_start(port, end_slowly);
    struct delaunay_mirror *m = mirror_of(port, "t", &options);
    CHECK(delaunay_mirror_next(m, -1, &change) == DELAUNAY_OK);
    CHECK(delaunay_mirror_version(m) == 7 && change.n_triangles_added == 1);
    CHECK(delaunay_mirror_next(m, -1, &change) == DELAUNAY_OK && change.version == 9);
    CHECK(change.n_moved == 1 && change.moved[0] == 2 && change.n_triangles_added == 0);
    CHECK(delaunay_mirror_next(m, -1, &change) == DELAUNAY_DROPPED);
    CHECK(delaunay_mirror_point(m, 1, xy, NULL) && xy[0] == 4 && xy[1] == 0);
    CHECK(delaunay_mirror_points(m) == 3 && delaunay_mirror_descriptor(m) == -1);
    delaunay_mirror_close(m);
}

static void send_parts(int fd)
{
    char line[200];
    CHECK(peer_hear(fd, line, sizeof line));
    peer_say(fd, "OK 0 version=7\nEVENT 1 set=t version=7 reset more\npoint 0 0 0\n"
                 "EVENT 0 set=t version=7 more\nEVENT 1 set=t version=7\npoint 1 4 0\n");
    peer_hear(fd, line, sizeof line);
}

TEST(mirror_of_parts_of_an_event)
{
    char port[8];
    struct delaunay_change change;
    peer_start(port, send_parts);
    struct delaunay_mirror *m = mirror_of(port, "t", NULL);
    CHECK(delaunay_mirror_next(m, -1, &change) == DELAUNAY_OK);
    CHECK(change.reset && change.n_added == 2 && delaunay_mirror_points(m) == 2);
    delaunay_mirror_close(m);
}

static void talk_nonsense(int fd)
{
    char line[200];
    CHECK(peer_hear(fd, line, sizeof line));
    peer_say(fd, "OK 0 version=7\nEVENT 1 set=t version=8\nlist 0 c 1 2\n");
}

TEST(mirror_says_why_there_is_no_connection_when_the_time_is_up)
{
    char port[8], why[200];
    struct delaunay_change change;
    peer_start(port, talk_nonsense);
    struct delaunay_mirror *m = mirror_of(port, "t", NULL);
    CHECK(delaunay_mirror_next(m, 200, &change) == DELAUNAY_BROKEN);
    CHECK(delaunay_mirror_points(m) == 0 && delaunay_mirror_version(m) == 0);
    delaunay_mirror_close(m);
    CHECK(delaunay_mirror_open("127.0.0.1", port, "a b", NULL, why, sizeof why) == NULL);
    struct delaunay_mirror_options options = {.token = "a\nDROP t"};
    CHECK(delaunay_mirror_open("127.0.0.1", port, "t", &options, why, sizeof why) == NULL);
}

/* ---- rows ---- */

static enum delaunay_result gather(struct copy *c, const char *rows)
{
    enum delaunay_result r = DELAUNAY_OK;
    while (*rows != '\0' && r == DELAUNAY_OK) {
        size_t len = strcspn(rows, "\n");
        r = copy_row(c, rows, len);
        rows += len + (rows[len] == '\n');
    }
    return r;
}

TEST(mirror_refuses_rows_of_no_event)
{
    static const char *const bad[] = {
        "",          "point",      "point 1",      "point 1 2",        "point 1 2 3 4",
        "point x 1", "gone",       "gone -1",      "gone 1 2",         "gone 4294967295",
        "list 1",    "list 1 x 2", "list 1 ib 2",  "list 1 i 2 -3",    "gone 4294967296",
        "lost 1",    "list 1 i x", "points 1 2 3", "point 1 2 nothing"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct copy c = {0};
        CHECK_MSG(copy_row(&c, bad[i], strlen(bad[i])) == DELAUNAY_BROKEN, "%s", bad[i]);
        copy_free(&c);
    }
}

/* A wheel: point 0 in the middle of four others, and fields at each. */
#define WHEEL                                                                                      \
    "point 0 0 0 1\npoint 1 1 0 nan\npoint 2 0 1 2\npoint 3 -1 0 3\npoint 4 0 -1 4\n"              \
    "list 0 i 1 2 3 4\nlist 1 b 2 0 4\nlist 2 b 3 0 1\nlist 3 b 4 0 2\nlist 4 b 1 0 3\n"
#define FLAT "gone 0\nlist 1 b 2 4\nlist 2 b 3 4 1\nlist 3 b 4 2\nlist 4 b 1 2 3\n"

TEST(mirror_of_a_wheel_whose_hub_goes)
{
    struct copy c = {.fields = 1};
    struct delaunay_change change;
    copy_reset(&c);
    CHECK(gather(&c, WHEEL) == DELAUNAY_OK && copy_commit(&c, &change) == DELAUNAY_OK);
    CHECK(change.reset && change.n_added == 5 && change.n_triangles_added == 4);
    CHECK(gather(&c, FLAT) == DELAUNAY_OK && copy_commit(&c, &change) == DELAUNAY_OK);
    CHECK(change.n_gone == 1 && change.n_triangles_removed == 4 && change.n_triangles_added == 2);
    CHECK(!change.reset && c.points == 4 && isnan(c.value[1]) && c.value[2] == 2);
    copy_free(&c);
}

#define LINE "point 1 0 0\npoint 0 1 0\npoint 2 2 0\nlist 1 b 0\nlist 0 b 2 1\nlist 2 b 0\n"
#define OFF_LINE "point 3 1 1\nlist 3 b 1 0 2\nlist 1 b 0 3\nlist 0 b 2 3 1\nlist 2 b 3 0\n"

TEST(mirror_of_points_on_a_line_has_no_triangles)
{
    struct copy c = {0};
    struct delaunay_change change;
    copy_reset(&c);
    CHECK(gather(&c, LINE) == DELAUNAY_OK && copy_commit(&c, &change) == DELAUNAY_OK);
    CHECK(change.n_triangles_added == 0);
    CHECK(gather(&c, OFF_LINE) == DELAUNAY_OK && copy_commit(&c, &change) == DELAUNAY_OK);
    CHECK(change.n_triangles_added == 2 && change.n_triangles_removed == 0);
    copy_free(&c);
}

TEST(mirror_of_a_box_has_the_constraints_that_meet_it_with_the_places_of_their_ends)
{
    struct copy c = {.fields = 0};
    struct delaunay_change change;
    copy_reset(&c);
    CHECK(gather(&c, "constraint 1 9 line 4 0 0.5 7 8\nconstraint 1 2 border 0 0 0.5 1 1\n") ==
              DELAUNAY_OK &&
          copy_commit(&c, &change) == DELAUNAY_OK);
    CHECK(change.n_constraints_added == 2 && change.constraints_added[0].border);
    CHECK(gather(&c, "constraint 1 9 line 4 0 0.5 7 9\nreleased 1 2 border 0\nreleased 5 6 line 0\n"
                     "constraint 3 4 line 0 1 1 2 2\nreleased 3 4 line 0\n") == DELAUNAY_OK &&
          copy_commit(&c, &change) == DELAUNAY_OK);
    CHECK(change.n_constraints_added == 1 && change.constraints_added[0].places[3] == 9);
    CHECK(change.n_constraints_released == 1 && change.constraints_released[0].b == 2);
    CHECK(c.constraints.rows.n == 1);
    CHECK(c.constraints.rows.at[0].number == 4 && c.constraints.rows.at[0].places[3] == 9);
    copy_reset(&c);
    CHECK(gather(&c, "constraint 7 8 line 0 0 0 1 1\n") == DELAUNAY_OK &&
          copy_commit(&c, &change) == DELAUNAY_OK);
    CHECK(change.n_constraints_added == 1 && change.n_constraints_released == 1);
    copy_free(&c);
}

TEST(mirror_out_of_memory_is_as_before)
{
    bool failed = true;
    for (long nth = 1; failed; nth++) {
        struct copy c = {.fields = 1};
        struct delaunay_change change;
        copy_reset(&c);
        CHECK(gather(&c, WHEEL "constraint 2 3 border 7\n") == DELAUNAY_OK &&
              copy_commit(&c, &change) == DELAUNAY_OK);
        test_fail_alloc(nth);
        enum delaunay_result r = gather(&c, FLAT "point 5000 1 1 1\nlist 5000 i 1 2 3 4 5 6 7\n"
                                                 "constraint 1 2 line 0\nreleased 2 3 border 7\n");
        r = r == DELAUNAY_OK ? copy_commit(&c, &change) : r;
        failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK(r == (failed ? DELAUNAY_NOMEM : DELAUNAY_OK));
        CHECK(c.points == 5 && (copy_place(&c, 0) != NULL) == failed);
        CHECK(c.constraints.rows.n == 1 && c.constraints.rows.at[0].a == (failed ? 2u : 1u));
        copy_forget(&c);
        CHECK(!failed ||
              (gather(&c, FLAT) == DELAUNAY_OK && copy_commit(&c, &change) == DELAUNAY_OK &&
               change.n_triangles_removed == 4));
        copy_free(&c);
    }
}
