/* watch_test.c - WATCH: what clients that follow a set are sent, and that it is all they need. */
#include "tests/server/watch/mirror.h"
#include "tests/test.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* ---- random edits ---- */

static void random_place(char *text, size_t size, bool lattice)
{
    if (lattice)
        snprintf(text, size, "%u %u", (unsigned)test_below(5), (unsigned)test_below(5));
    else
        snprintf(text, size, "%g %g", test_uniform(), test_uniform());
}

/* An edit of constraints at the id. */
static void random_constraint(char *line, size_t size, uint32_t id)
{
    const char *border = test_below(3) == 0 ? " BORDER" : "";
    unsigned k = test_below(3);
    switch (test_below(8)) {
    case 0:
        snprintf(line, size, "DEL t %u CASCADE\n", (unsigned)id);
        break;
    case 1:
        snprintf(line, size, test_below(4) == 0 ? "RELEASE t ALL\n" : "RELEASE t OF %u\n", k);
        break;
    case 2:
        snprintf(line, size, "RELEASE t%s OF %u %u %u\n", border, k, (unsigned)id,
                 (unsigned)(id / 2));
        break;
    case 3:
        snprintf(line, size, "CONSTRAIN t%s OF %u PATH %u %u %u\n", border, k, (unsigned)id,
                 (unsigned)(id / 2), (unsigned)(id / 3));
        break;
    default:
        snprintf(line, size, "CONSTRAIN t%s OF %u %u %u\n", border, k, (unsigned)id,
                 (unsigned)(id / 2));
    }
}

/* An edit of a set that has had `ids` ids; some name an id that is gone, and fail. */
static void random_edit(char *line, size_t size, uint32_t ids, bool lattice)
{
    char place[64];
    size_t at;
    random_place(place, sizeof place, lattice);
    uint32_t id = ids == 0 ? 0 : test_below(ids);
    switch (test_below(10)) {
    case 0:
    case 1:
        snprintf(line, size, "ADD t %s\n", place);
        break;
    case 8:
    case 9:
        random_constraint(line, size, id);
        break;
    case 2:
        at = (size_t)snprintf(line, size, "ADD t");
        for (uint32_t n = 1 + test_below(30); n > 0; n--) {
            random_place(place, sizeof place, lattice);
            at += (size_t)snprintf(line + at, size - at, " %s", place);
        }
        snprintf(line + at, size - at, "\n");
        break;
    case 3:
        snprintf(line, size, test_below(4) > 0 ? "DEL t %u %u\n" : "TRIANGULATE t\n", (unsigned)id,
                 (unsigned)(id / 2));
        break;
    case 4:
        snprintf(line, size, "DEL t %u\n", (unsigned)id);
        break;
    default:
        snprintf(line, size, "MOVE t %u %s\n", (unsigned)id, place);
    }
}

/* An edit of values; z is watched, w is not. */
static void random_value(char *line, size_t size, uint32_t ids)
{
    char place[64];
    uint32_t id = ids == 0 ? 0 : test_below(ids);
    random_place(place, sizeof place, false);
    switch (test_below(8)) {
    case 0:
        snprintf(line, size, "FDROP t z\n");
        break;
    case 1:
        snprintf(line, size, "ADD t FIELDS w,z %s 1 %u\n", place, (unsigned)test_below(100));
        break;
    case 2:
        snprintf(line, size, "FSET t w %u 7\n", (unsigned)id);
        break;
    default:
        snprintf(line, size, "FSET t z %u %u %u nan\n", (unsigned)id, (unsigned)test_below(9),
                 (unsigned)(id / 2));
    }
}

enum { MIRRORS = 8 };

/* Some have caught up and are compared, some are behind, some connections are lost. */
static void random_reader(struct mirror *m, const struct daemon *d, int fd, uint64_t version,
                          bool triangulated)
{
    switch (test_below(8)) {
    case 0:
        mirror_catch_up(m, version);
        mirror_check(m, fd, triangulated);
        break;
    case 1:
        mirror_catch_up(m, version);
        break;
    case 2:
        if (!m->whole)
            break;
        mirror_disconnect(m);
        mirror_watch(m, d, true);
        break;
    case 3:
        mirror_disconnect(m);
        mirror_watch(m, d, false);
        break;
    default:
        break;
    }
}

static void make_mirrors(struct mirror *m, bool lattice)
{
    const char *box = lattice ? "1 1 3 4" : "0.2 0.6 0.7 0.1";
    for (int i = 0; i < MIRRORS; i++)
        m[i].options = (struct mirror_options){.resp = test_below(2) == 0};
    m[2].options.fields = m[3].options.fields = "z";
    for (int i = 3; i < MIRRORS; i++)
        m[i].options.box = box;
    for (int i = 1; i < MIRRORS; i += 2)
        m[i].options.constraints = true;
    m[6].options.constraints = true; /* the same as m[7] */
}

static void follow_history(const struct daemon *d, bool lattice, bool triangulated)
{
    enum { EDITS = 60 };
    char line[4000];
    static struct mirror m[MIRRORS];
    int fd = daemon_connect(d);
    memset(m, 0, sizeof m);
    make_mirrors(m, lattice);
    ask_version(fd, lattice && test_below(2) == 0 ? "CREATE t TOL 1\n" : "CREATE t\n");
    uint64_t version = ask_version(fd, "ADD t FIELDS z,w 1 1 5 6\n");
    uint32_t ids = 1;
    if (triangulated)
        version = ask_version(fd, "TRIANGULATE t\n");
    for (int i = 0; i < MIRRORS; i++)
        mirror_watch(&m[i], d, false);
    for (int i = 0; i < EDITS; i++) {
        if (test_below(3) == 0)
            random_value(line, sizeof line, ids);
        else
            random_edit(line, sizeof line, ids, lattice);
        say(fd, line);
        const char *got = hear_line(fd);
        bool done = strncmp(got, "OK", 2) == 0; /* crossing constraints prevent a triangulation */
        if (done)
            version = version_in(got);
        unsigned first, added;
        if (sscanf(got, "OK 0 first=%u added=%u", &first, &added) == 2)
            ids = first + added;
        triangulated = triangulated || (done && strncmp(line, "TRI", 3) == 0);
        if (strncmp(line, "FDROP", 5) == 0) { /* FIELDS without SINCE names fields that there are */
            if (m[2].whole && test_below(2) == 0) {
                mirror_disconnect(&m[2]);
                mirror_watch(&m[2], d, true);
            }
            version = ask_version(fd, "ADD t FIELDS z 2 2 3\n");
            ids++;
        }
        random_reader(&m[test_below(MIRRORS)], d, fd, version, triangulated);
    }
    for (int i = 0; i < MIRRORS; i++) {
        mirror_catch_up(&m[i], version);
        mirror_check(&m[i], fd, triangulated);
    }
    say(fd, "DROP t\n");
    expect(fd, "OK 0\n");
    for (int i = 0; i < MIRRORS; i++) {
        do
            mirror_take(&m[i]);
        while (!m[i].dropped);
        mirror_free(&m[i]);
    }
    close(fd);
}

TEST_TIMEOUT(mirror_has_what_points_and_lists_say_after_any_edits, 120)
{
    struct daemon d = daemon_start(NULL);
    for (int i = 0; i < 24; i++)
        follow_history(&d, i % 2 == 1, i % 3 > 0);
    daemon_end(&d);
}

/* ---- one by one ---- */

#define SQUARE "ADD t 0 0  4 0  4 4  0 4\nTRIANGULATE t\n"

TEST(watcher_is_sent_everything_and_then_what_changes)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    say(fd, "ADD t 0 0  4 0  0 4\nWATCH t\n");
    expect(fd, "OK 0 first=0 added=3 coincident=0\nOK 0\n");
    CHECK(strstr(hear_line(fd), " reset") != NULL);
    expect(fd, "point 0 0 0\npoint 1 4 0\npoint 2 0 4\n");
    say(other, "MOVE t 1 5 0\nDEL t 2\n");
    expect(other, "OK 0\nOK 0 deleted=1\n");
    struct mirror m = {.fd = fd};
    while (m.point[1] == NULL || strcmp(m.point[1], "1 5 0") != 0)
        mirror_take(&m);
    say(fd, "UNWATCH t\nUNWATCH t\n");
    const char *line;
    while (strncmp(line = hear_line(fd), "OK", 2) != 0)
        continue;
    CHECK_STR(line, "OK 0 watched=1");
    expect(fd, "OK 0 watched=0\n");
    say(other, "MOVE t 1 6 0\n");
    expect(other, "OK 0\n");
    say(fd, "PING\n");
    expect(fd, "OK 0\n");
    close(other);
    mirror_free(&m);
    daemon_end(&d);
}

TEST(watch_since_a_version_sends_only_what_comes_later)
{
    struct daemon d = daemon_start(NULL);
    struct mirror m = {.whole = false};
    int fd = daemon_connect(&d);
    say(fd, SQUARE);
    hear_line(fd);
    uint64_t v = version_in(hear_line(fd));
    mirror_watch(&m, &d, false);
    mirror_catch_up(&m, v);
    mirror_disconnect(&m);
    uint64_t now = ask_version(fd, "ADD t 2 1\n");
    mirror_watch(&m, &d, true);
    mirror_catch_up(&m, now);
    CHECK(m.resets == 1);
    mirror_check(&m, fd, true);
    now = ask_version(fd, "MOVE t 4 2 3\n");
    mirror_catch_up(&m, now);
    CHECK(m.resets == 1);
    mirror_check(&m, fd, true);
    mirror_disconnect(&m);
    m.version = v - 1; /* of before its points */
    mirror_watch(&m, &d, true);
    m.whole = false;
    mirror_catch_up(&m, now);
    CHECK(m.resets == 2);
    mirror_check(&m, fd, true);
    mirror_disconnect(&m);
    m.version = now + 1; /* of a set of that name that was lost */
    mirror_watch(&m, &d, true);
    m.whole = false;
    while (!m.whole)
        mirror_take(&m);
    CHECK(m.resets == 3 && m.version == now);
    mirror_check(&m, fd, true);
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}

TEST(watch_since_a_version_with_a_field_that_was_dropped_meanwhile_has_no_values_of_it)
{
    struct daemon d = daemon_start(NULL);
    struct mirror m = {.options = {.fields = "z"}};
    int fd = daemon_connect(&d);
    uint64_t version = ask_version(fd, "ADD t FIELDS z 0 0 5  4 0 6\n");
    mirror_watch(&m, &d, false);
    mirror_catch_up(&m, version);
    CHECK_STR(m.point[1], "1 4 0 6");
    mirror_disconnect(&m);
    version = ask_version(fd, "FDROP t z\n");
    mirror_watch(&m, &d, true);
    mirror_catch_up(&m, version);
    CHECK_STR(m.point[1], "1 4 0 nan");
    version = ask_version(fd, "FSET t z 1 7\n");
    mirror_catch_up(&m, version);
    mirror_check(&m, fd, false);
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}

TEST(watcher_of_a_set_whose_triangulation_was_left_for_later_is_sent_the_rings)
{
    struct daemon d = daemon_start(NULL);
    struct mirror m = {.whole = false};
    int fd = daemon_connect(&d);
    static char points[100 * 32] = "ADD t";
    ask_version(fd, "ADD t 0 0  4 0  4 4  0 4\n");
    ask_version(fd, "TRIANGULATE t\n");
    for (int i = 0; i < 100; i++) /* so many more than there are */
        snprintf(points + strlen(points), sizeof points - strlen(points), " %g %g", test_uniform(),
                 test_uniform());
    say(fd, points);
    uint64_t version = ask_version(fd, "\n");
    mirror_watch(&m, &d, false);
    mirror_catch_up(&m, version);
    while (m.list[0] == NULL)
        mirror_take(&m);
    mirror_check(&m, fd, true);
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}

/* The output of the watcher is full; when it reads again, it gets the state of that later moment. */
TEST_TIMEOUT(watcher_that_does_not_read_is_sent_one_state_later, 60)
{
    enum { POINTS = 3000, EDITS = 8000, BURST = 200 };
    struct daemon d = daemon_start(NULL);
    struct mirror m = {.whole = false};
    static char text[BURST * 64];
    int fd = daemon_connect(&d);
    load_random(fd, "t", POINTS);
    ask_version(fd, "TRIANGULATE t\n");
    mirror_watch(&m, &d, false);
    uint64_t version = 0;
    for (int i = 0; i < EDITS; i += BURST) {
        size_t at = 0;
        for (int k = 0; k < BURST; k++)
            at += (size_t)snprintf(text + at, sizeof text - at, "MOVE t %u %g %g\n",
                                   (unsigned)test_below(POINTS), test_uniform(), test_uniform());
        say(fd, text);
        for (int k = 0; k < BURST; k++)
            version = version_in(hear_line(fd));
    }
    say(fd, "DEL t 5\nADD t 0.5 0.5\n");
    hear_line(fd);
    version = version_in(hear_line(fd));
    mirror_catch_up(&m, version);
    mirror_check(&m, fd, true);
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}

TEST(events_are_pushes_in_resp_3_and_refused_in_resp_2)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "ADD t 1 2\n*2\r\n$5\r\nWATCH\r\n$1\r\nt\r\n");
    expect(fd, "OK 0 first=0 added=1 coincident=0\n-UNKNOWN ");
    hear_line(fd);
    say(fd, "*2\r\n$5\r\nHELLO\r\n$1\r\n3\r\n");
    while (strcmp(hear_line(fd), "modules\r") != 0)
        continue;
    expect(fd, "*0\r\n");
    say(fd, "*2\r\n$5\r\nWATCH\r\n$1\r\nt\r\n");
    expect(fd, "%1\r\n$7\r\nversion\r\n:");
    hear_line(fd);
    expect(fd, ">3\r\n$5\r\nevent\r\n%3\r\n$3\r\nset\r\n$1\r\nt\r\n$7\r\nversion\r\n:");
    hear_line(fd);
    expect(fd, "$5\r\nreset\r\n#t\r\n*4\r\n$5\r\npoint\r\n:0\r\n,1\r\n,2\r\n");
    say(fd, "*2\r\n$4\r\nDROP\r\n$1\r\nt\r\n");
    expect(fd, "+OK\r\n>2\r\n$5\r\nevent\r\n%2\r\n$3\r\nset\r\n$1\r\nt\r\n$7\r\ndropped\r\n#t\r\n");
    close(fd);
    daemon_end(&d);
}

TEST(connection_watches_so_many_sets_and_no_more)
{
    enum { MOST = 64 };
    char line[100];
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    for (int i = 0; i <= MOST; i++) {
        snprintf(line, sizeof line, "CREATE s%d\n", i);
        ask_version(other, line);
        snprintf(line, sizeof line, "WATCH s%d\n", i);
        say(fd, line);
        const char *got = hear_line(fd);
        while (strncmp(got, "EVENT 0", 7) == 0)
            got = hear_line(fd);
        CHECK_MSG(strncmp(got, i < MOST ? "OK 0 version=" : "ERR TOOBIG", 10) == 0, "%s", got);
    }
    converse(&d, "WATCH none\nWATCH s1 SINCE x\nWATCH s1 SINCE\n",
             "ERR NOSET there is no set none\nERR NUMBER x is not a version\n"
             "ERR SYNTAX usage: WATCH set [SINCE version] [WITHIN x0 y0 x1 y1] [FIELDS "
             "name,name,...] [CONSTRAINTS]\n");
    close(fd);
    close(other);
    daemon_end(&d);
}

TEST(client_list_and_info_count_what_is_watched)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    ask_version(fd, "CREATE s\n");
    ask_version(fd, "CREATE t\n");
    for (int i = 0; i < 3; i++) { /* the second one of t replaces the first */
        ask_version(fd, i == 0 ? "WATCH s\n" : "WATCH t\n");
        CHECK(strncmp(hear_line(fd), "EVENT 0 ", 8) == 0);
    }
    say(fd, "CLIENT LIST\n");
    expect(fd, "OK 1\n");
    CHECK(strstr(hear_line(fd), " watching=2 ") != NULL);
    CHECK(daemon_info(&d, "watchers") == 2);
    CHECK(daemon_info(&d, "events") == 3);
    close(fd);
    await_info(&d, "watchers", 0);
    daemon_end(&d);
}

TEST(watcher_of_a_box_who_comes_back_is_told_which_points_have_left_it)
{
    struct daemon d = daemon_start(NULL);
    struct mirror m = {.options = {.box = "0.4 0.4 0.46 0.46"}};
    int fd = daemon_connect(&d);
    load_random(fd, "t", 6000); /* so many that those in the box are in a table */
    ask_version(fd, "TRIANGULATE t\n");
    ask_version(fd, "MOVE t 0 0.44 0.44\n");
    mirror_watch(&m, &d, false);
    mirror_catch_up(&m, ask_version(fd, "MOVE t 1 0.45 0.45\n"));
    mirror_disconnect(&m);
    ask_version(fd, "MOVE t 0 0.9 0.9\n");
    ask_version(fd, "DEL t 1\n");
    uint64_t now = ask_version(fd, "MOVE t 2 0.42 0.42\n");
    mirror_watch(&m, &d, true);
    mirror_catch_up(&m, now);
    CHECK(m.resets == 1);
    mirror_check(&m, fd, true);
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}

/* Events of the move have not been made yet when the watcher comes back. */
TEST(watcher_of_a_box_who_comes_back_in_the_turn_of_an_edit_is_told_which_point_has_left_it)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    char text[128];
    say(fd, "ADD t 2 2  0 0  4 0  4 4  0 4\nTRIANGULATE t\n");
    hear_line(fd);
    uint64_t version = version_in(hear_line(fd));
    snprintf(text, sizeof text, "WATCH t WITHIN 1 1 3 3\nUNWATCH t\n");
    say(fd, text);
    for (int i = 0; i < 2; i++)
        CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    pause_ms(20);
    snprintf(text, sizeof text, "MOVE t 0 0.5 0.5\nWATCH t SINCE %" PRIu64 " WITHIN 1 1 3 3\n",
             version);
    say(fd, text);
    for (int i = 0; i < 2; i++)
        CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    const char *line = hear_line(fd);
    CHECK(strncmp(line, "EVENT 1 set=t ", 14) == 0 && strstr(line, "reset") == NULL);
    CHECK_STR(hear_line(fd), "gone 0");
    close(fd);
    daemon_end(&d);
}

TEST(watcher_of_points_on_a_line_is_sent_the_points_beside_an_edit)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "ADD t 0 0  1 0  2 0  3 0\nTRIANGULATE t\n");
    hear_line(fd);
    uint64_t version = version_in(hear_line(fd));
    struct mirror m = {.whole = false};
    mirror_watch(&m, &d, false);
    mirror_catch_up(&m, version);
    const char *edits[] = {"ADD t 1.5 0\n", "ADD t 9 0\n", "MOVE t 2 2.5 0\n", "DEL t 1\n"};
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        mirror_catch_up(&m, ask_version(fd, edits[i]));
        mirror_check(&m, fd, true);
    }
    CHECK(m.resets == 1);
    mirror_catch_up(&m, ask_version(fd, "MOVE t 0 20 0\n")); /* the line begins at its other end */
    CHECK(m.resets == 2);
    mirror_check(&m, fd, true);
    mirror_catch_up(&m, ask_version(fd, "ADD t 5 5\n"));
    mirror_check(&m, fd, true);
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}
