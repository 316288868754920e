/* constraints_test.c - WATCH ... CONSTRAINTS, one thing after the other; random edits are in watch_test.c. */
#include "tests/server/follow/node.h"
#include "tests/server/watch/mirror.h"
#include "tests/test.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define SQUARE "ADD t 0 0  4 0  4.5 4  0 4\nTRIANGULATE t\n"

/* A square that is triangulated; events show its version. */
static int connect_to_square(const struct daemon *d, uint64_t *version)
{
    int fd = daemon_connect(d);
    say(fd, SQUARE);
    hear_line(fd);
    *version = version_in(hear_line(fd));
    return fd;
}

/* Hears an event, whose rows follow. */
static void hear_event(int fd, const char *want)
{
    const char *got = hear_line(fd);
    CHECK_MSG(strncmp(got, want, strlen(want)) == 0, "%s, not %s", got, want);
}

TEST(watcher_is_sent_a_constraint_and_the_rings_that_it_changes_and_both_when_it_is_released)
{
    struct daemon d = daemon_start(NULL);
    uint64_t version;
    int fd = connect_to_square(&d, &version), other = daemon_connect(&d);
    say(fd, "WATCH t CONSTRAINTS\n");
    hear_line(fd);
    hear_event(fd, "EVENT 8 set=t version=");
    expect(fd,
           "point 0 0 0\nlist 0 b 1 3\npoint 1 4 0\nlist 1 b 2 3 0\npoint 2 4.5 4\nlist 2 b 3 1\n"
           "point 3 0 4\nlist 3 b 0 1 2\n");
    ask_version(other, "CONSTRAIN t BORDER OF 7 2 0\n");
    hear_event(fd, "EVENT 5 set=t version=");
    expect(fd,
           "list 0 b 1 2 3\nlist 1 b 2 0\nlist 2 b 3 0 1\nlist 3 b 0 2\nconstraint 0 2 border 7\n");
    ask_version(other, "RELEASE t ALL\n");
    hear_event(fd, "EVENT 5 set=t version=");
    expect(fd,
           "list 0 b 1 3\nlist 1 b 2 3 0\nlist 2 b 3 1\nlist 3 b 0 1 2\nreleased 0 2 border 7\n");
    ask_version(other, "CONSTRAIN t PATH 3 0 1\n"); /* edges that are there */
    hear_event(fd, "EVENT 2 set=t version=");
    expect(fd, "constraint 0 1 line 0\nconstraint 0 3 line 0\n");
    ask_version(other, "DEL t 3 CASCADE\n");
    hear_event(fd, "EVENT 5 set=t version=");
    expect(fd, "list 0 b 1 2\nlist 1 b 2 0\nlist 2 b 0 1\ngone 3\nreleased 0 3 line 0\n");
    say(fd, "WATCH t CONSTRAINTS\n");
    hear_line(fd);
    hear_event(fd, "EVENT 7 set=t version=");
    for (int i = 0; i < 6; i++)
        hear_line(fd);
    expect(fd, "constraint 0 1 line 0\n");
    close(fd);
    close(other);
    daemon_end(&d);
}

TEST(watcher_who_does_not_ask_for_constraints_is_sent_what_it_was_before_there_were_any)
{
    struct daemon d = daemon_start(NULL);
    uint64_t version;
    int fd = connect_to_square(&d, &version), other = daemon_connect(&d);
    say(fd, "WATCH t\n");
    hear_line(fd);
    hear_event(fd, "EVENT 8 set=t version=");
    for (int i = 0; i < 8; i++)
        hear_line(fd);
    ask_version(other, "CONSTRAIN t 0 1\n");
    hear_event(fd, "EVENT 0 set=t version=");
    ask_version(other, "MOVE t 1 4 -1\n");
    hear_event(fd, "EVENT 5 set=t version=");
    for (int i = 0; i < 5; i++)
        CHECK(strchr("lp", hear_line(fd)[0]) != NULL); /* lists and a point */
    close(fd);
    close(other);
    daemon_end(&d);
}

TEST(watcher_of_a_box_is_sent_the_constraints_that_meet_it_with_the_places_of_their_ends)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    ask_version(other, "ADD t 0 0  9 9  9 0  8 0  3 3.5\n");
    ask_version(other, "CONSTRAIN t 0 1  2 3\n");
    say(fd, "WATCH t WITHIN 2 2 4 3 CONSTRAINTS\n");
    hear_line(fd);
    hear_event(fd, "EVENT 1 set=t version=");
    expect(fd, "constraint 0 1 line 0 0 0 9 9\n");
    ask_version(other, "MOVE t 1 9 8.5\n");
    hear_event(fd, "EVENT 1 set=t version=");
    expect(fd, "constraint 0 1 line 0 0 0 9 8.5\n");
    ask_version(other, "MOVE t 3 9 1\n"); /* of one that does not meet it */
    hear_event(fd, "EVENT 0 set=t version=");
    ask_version(other, "RELEASE t 2 3\n");
    hear_event(fd, "EVENT 0 set=t version=");
    say(other, "MOVE t 1 9 0.5\nMOVE t 1 9 0.25\n"); /* one event may be about both */
    hear_line(other);
    uint64_t version = version_in(hear_line(other));
    hear_event(fd, "EVENT 1 set=t version=");
    expect(fd, "released 0 1 line 0\n");
    struct mirror m = {.fd = fd, .options.constraints = true};
    version = ask_version(other, "CONSTRAIN t 2 1\n");
    while (m.version < version)
        mirror_take(&m);
    CHECK(m.rows == 0);
    close(fd);
    close(other);
    daemon_end(&d);
}

TEST(constraints_are_typed_in_resp_3)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    ask_version(other, "ADD t 0 0  1 0.5\n");
    ask_version(other, "CONSTRAIN t OF 5 0 1\n");
    say(fd, "*2\r\n$5\r\nHELLO\r\n$1\r\n3\r\n");
    while (strcmp(hear_line(fd), "modules\r") != 0)
        continue;
    expect(fd, "*0\r\n");
    say(fd, "*8\r\n$5\r\nWATCH\r\n$1\r\nt\r\n$6\r\nWITHIN\r\n$1\r\n2\r\n$1\r\n2\r\n$1\r\n1\r\n$"
            "3\r\n0.5\r\n"
            "$11\r\nCONSTRAINTS\r\n");
    expect(fd, "%1\r\n$7\r\nversion\r\n:");
    hear_line(fd);
    expect(fd, ">4\r\n$5\r\nevent\r\n%3\r\n$3\r\nset\r\n$1\r\nt\r\n$7\r\nversion\r\n:");
    hear_line(fd);
    expect(fd,
           "$5\r\nreset\r\n#t\r\n*4\r\n$5\r\npoint\r\n:1\r\n,1\r\n,0.5\r\n"
           "*9\r\n$10\r\nconstraint\r\n:0\r\n:1\r\n$4\r\nline\r\n:5\r\n,0\r\n,0\r\n,1\r\n,0.5\r\n");
    ask_version(other, "RELEASE t ALL\n");
    expect(fd, ">3\r\n$5\r\nevent\r\n%2\r\n$3\r\nset\r\n$1\r\nt\r\n$7\r\nversion\r\n:");
    hear_line(fd);
    expect(fd, "*5\r\n$8\r\nreleased\r\n:0\r\n:1\r\n$4\r\nline\r\n:5\r\n");
    close(fd);
    close(other);
    daemon_end(&d);
}

/* Sends `first` and ids from `from` on. */
static uint64_t ask_with_ids(int fd, const char *first, unsigned from, unsigned n)
{
    static char text[100000];
    size_t at = (size_t)snprintf(text, sizeof text, "%s", first);
    for (unsigned i = 0; i < n; i++)
        at += (size_t)snprintf(text + at, sizeof text - at, " %u", from + i);
    snprintf(text + at, sizeof text - at, "\n");
    return ask_version(fd, text);
}

/* A set that is not triangulated, so that constraints do not change rings. */
static int connect_to_points(const struct daemon *d, unsigned n)
{
    int fd = daemon_connect(d);
    load_random(fd, "t", n);
    return fd;
}

TEST(more_constraints_than_are_noted_are_all_sent_again)
{
    enum { N = 8300 };
    struct daemon d = daemon_start(NULL);
    int fd = connect_to_points(&d, N), other = daemon_connect(&d);
    struct mirror m = {.options = {.box = "-9 -9 -8 -8", .constraints = true}, .fd = fd};
    mirror_watch(&m, &d, false);
    mirror_catch_up(&m, ask_version(other, "CONSTRAIN t 5 6\n"));
    unsigned resets = m.resets;
    mirror_catch_up(&m, ask_with_ids(other, "CONSTRAIN t PATH", 0, N));
    CHECK(m.resets == resets + 1 && m.rows == 0);
    mirror_free(&m);
    close(other);
    daemon_end(&d);
}

TEST(reset_lists_all_constraints_in_parts_while_some_are_released)
{
    enum { N = 4000 };
    struct daemon d = daemon_start(NULL);
    int fd = connect_to_points(&d, N);
    static struct mirror m = {.options.constraints = true};
    uint64_t version = ask_with_ids(fd, "CONSTRAIN t PATH", 0, N);
    mirror_watch(&m, &d, false);
    mirror_take(&m);
    CHECK(!m.whole); /* a part */
    for (unsigned id = 10; id + 1 < N; id += 397) {
        char line[80];
        snprintf(line, sizeof line, "RELEASE t %u %u\n", id, id + 1);
        version = ask_version(fd, line);
    }
    mirror_catch_up(&m, version);
    CHECK(m.resets == 1);
    mirror_check(&m, fd, false);
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}

/* With N - 1 constraints each time, which a watcher that is away does not hear of. */
static void come_back(struct daemon *d, int fd, unsigned edits, bool is_known)
{
    enum { N = 1000 };
    static struct mirror m;
    memset(&m, 0, sizeof m);
    m.options.constraints = true;
    char line[80];
    mirror_watch(&m, d, false);
    mirror_catch_up(&m, ask_version(fd, "CONSTRAIN t OF 9 0 1\n"));
    unsigned resets = m.resets;
    mirror_disconnect(&m);
    uint64_t version = m.version;
    for (unsigned i = 0; i < edits; i++) {
        snprintf(line, sizeof line, "CONSTRAIN t OF %u PATH", i);
        ask_with_ids(fd, line, 0, N);
        snprintf(line, sizeof line, "RELEASE t OF %u\n", i);
        version = ask_version(fd, line);
    }
    mirror_watch(&m, d, true);
    mirror_catch_up(&m, version);
    CHECK(m.resets == resets + !is_known);
    mirror_check(&m, fd, false);
    mirror_free(&m);
}

TEST(
    watcher_that_comes_back_is_sent_the_changes_of_constraints_or_everything_if_there_were_too_many)
{
    struct daemon d = daemon_start(NULL);
    int fd = connect_to_points(&d, 1000);
    come_back(&d, fd, 2, true);
    come_back(&d, fd, 12, false);
    close(fd);
    daemon_end(&d);
}

TEST_TIMEOUT(watcher_of_a_follower_is_sent_the_constraints_of_its_leader, 60)
{
    struct node l = node_new(NULL), f = node_new(NULL);
    node_ask(&l, "ADD t 0 0  4 0  0 4");
    node_ask(&l, "CONSTRAIN t 2 1");
    node_follow(&f, &l, "");
    node_expect_same(&l, &f);
    int fd = daemon_connect(&f.d);
    say(fd, "WATCH t CONSTRAINTS\n");
    hear_line(fd);
    hear_event(fd, "EVENT 4 set=t version=");
    expect(fd, "point 0 0 0\npoint 1 4 0\npoint 2 0 4\nconstraint 1 2 line 0\n");
    node_ask(&l, "CONSTRAIN t BORDER OF 3 RING 0 1 2");
    hear_event(fd, "EVENT 3 set=t version=");
    expect(fd, "constraint 0 1 border 3\nconstraint 0 2 border 3\nconstraint 1 2 border 3\n");
    node_ask(&l, "DEL t 1 CASCADE");
    hear_event(fd, "EVENT 4 set=t version=");
    expect(fd, "gone 1\nreleased 0 1 border 3\nreleased 1 2 line 0\nreleased 1 2 border 3\n");
    close(fd);
    node_end(&l);
    node_end(&f);
}
