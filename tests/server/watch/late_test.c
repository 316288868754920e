/* late_test.c - watchers that cannot take events for a while: a long reply is being sent to them, or a reset takes
 * several turns. The events that they get later are complete. */
#include "tests/server/watch/mirror.h"
#include "tests/test.h"

#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { BIG = 60000, REPLIES = 12, POINTS = 6000 }; /* the replies are more than sockets buffer */

static const char BIG_HEAD[] = "OK 0 rows=60000 bytes=1200000";

/* The next line that is not of an event. */
static void hear_head(struct mirror *m)
{
    for (char first; recv(m->fd, &first, 1, MSG_PEEK) == 1 && first == 'E';)
        mirror_take(m);
    CHECK_STR(hear_line(m->fd), BIG_HEAD);
}

/* Asks for long replies. When this returns, the first one is being sent, and the mirror does not read it. */
static void stall(struct mirror *m)
{
    for (int i = 0; i < REPLIES; i++)
        say(m->fd, "POINTS big BINARY\n");
    hear_head(m);
}

/* Reads the replies, and events between them. */
static void resume(struct mirror *m)
{
    static char rows[1200000];
    for (int i = 0; i < REPLIES; i++) {
        if (i > 0)
            hear_head(m);
        CHECK(recv(m->fd, rows, sizeof rows, MSG_WAITALL) == (ssize_t)sizeof rows);
    }
}

/* A triangulated set `t`, and `big`. */
static int connect_with_sets(const struct daemon *d)
{
    int fd = daemon_connect(d);
    load_random(fd, "t", POINTS);
    load_random(fd, "big", BIG);
    ask_version(fd, "TRIANGULATE t\n");
    return fd;
}

/* Moves random points; returns the last version. */
static uint64_t move_many(int fd)
{
    enum { MOVES = 300 };
    static char text[MOVES * 64];
    size_t at = 0;
    uint64_t version = 0;
    for (int i = 0; i < MOVES; i++)
        at += (size_t)snprintf(text + at, sizeof text - at, "MOVE t %u %g %g\n",
                               (unsigned)test_below(POINTS), test_uniform(), test_uniform());
    say(fd, text);
    for (int i = 0; i < MOVES; i++)
        version = version_in(hear_line(fd));
    return version;
}

/* Adds so many points that everything changes; returns the version. */
static uint64_t add_many(int fd)
{
    enum { ADDED = 1500 };
    static char text[ADDED * 32];
    size_t at = (size_t)snprintf(text, sizeof text, "ADD t");
    for (int i = 0; i < ADDED; i++)
        at +=
            (size_t)snprintf(text + at, sizeof text - at, " %g %g", test_uniform(), test_uniform());
    snprintf(text + at, sizeof text - at, "\n");
    return ask_version(fd, text);
}

static void catch_up_and_check(struct mirror *m, int fd, uint64_t version)
{
    mirror_catch_up(m, version);
    mirror_check(m, fd, true);
}

TEST(events_come_before_or_after_a_long_reply)
{
    struct daemon d = daemon_start(NULL);
    struct mirror m = {.whole = false};
    int fd = connect_with_sets(&d);
    mirror_watch(&m, &d, false);
    mirror_catch_up(&m, ask_version(fd, "MOVE t 0 0.5 0.5\n"));
    stall(&m);
    uint64_t version = move_many(fd);
    resume(&m);
    catch_up_and_check(&m, fd, version);
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}

TEST(point_that_leaves_a_box_is_gone_also_for_the_watcher_that_hears_of_it_later)
{
    struct daemon d = daemon_start(NULL);
    static struct mirror m[2];
    int fd = connect_with_sets(&d);
    uint64_t version = ask_version(fd, "MOVE t 0 0.5 0.5\n");
    for (int i = 0; i < 2; i++) {
        m[i].options.box = "0.4 0.4 0.6 0.6";
        mirror_watch(&m[i], &d, false);
        mirror_catch_up(&m[i], version);
    }
    stall(&m[1]);
    version = ask_version(fd, "MOVE t 0 0.9 0.9\n");
    catch_up_and_check(&m[0], fd, version);
    resume(&m[1]);
    catch_up_and_check(&m[1], fd, version);
    for (int i = 0; i < 2; i++)
        mirror_free(&m[i]);
    close(fd);
    daemon_end(&d);
}

TEST(edits_during_a_reset_are_sent_after_it)
{
    struct daemon d = daemon_start(NULL);
    int fd = connect_with_sets(&d);
    struct mirror m = {.whole = false};
    mirror_watch(&m, &d, false);
    catch_up_and_check(&m, fd, move_many(fd));
    add_many(fd);
    catch_up_and_check(&m, fd, move_many(fd));
    CHECK(m.resets > 1);
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}

TEST(watcher_that_becomes_late_during_a_reset_gets_the_rest_of_it_later)
{
    struct daemon d = daemon_start(NULL);
    int fd = connect_with_sets(&d);
    struct mirror m = {.whole = false};
    mirror_watch(&m, &d, false);
    mirror_catch_up(&m, ask_version(fd, "MOVE t 0 0.5 0.5\n"));
    uint64_t version = add_many(fd);
    CHECK(poll(&(struct pollfd){.fd = m.fd, .events = POLLIN}, 1, -1) ==
          1); /* the reset has begun */
    stall(&m);
    version = move_many(fd);
    resume(&m);
    catch_up_and_check(&m, fd, version);
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}

/* Moves the same few points so often that more has changed than is remembered; returns the last version. */
static uint64_t move_few_often(int fd)
{
    enum { FEW = 20, BURST = 250, BURSTS = 30 };
    static char text[BURST * 64];
    uint64_t version = 0;
    for (int i = 0; i < BURSTS; i++) {
        size_t at = 0;
        for (int k = 0; k < BURST; k++)
            at += (size_t)snprintf(text + at, sizeof text - at, "MOVE t %u %g %g\n",
                                   (unsigned)test_below(FEW), 0.5 + test_uniform() / 100,
                                   0.5 + test_uniform() / 100);
        say(fd, text);
        for (int k = 0; k < BURST; k++)
            version = version_in(hear_line(fd));
    }
    return version;
}

TEST(watcher_that_has_missed_very_many_edits_is_sent_the_points_that_they_have_touched)
{
    static const char *const boxes[] = {NULL, "0.4 0.4 0.6 0.6", "0 0 0.9 0.9"};
    enum { WATCHERS = 3 };
    static struct mirror m[WATCHERS];
    struct daemon d = daemon_start(NULL);
    int fd = connect_with_sets(&d);
    for (int i = 0; i < WATCHERS; i++) {
        m[i].options.box = boxes[i];
        mirror_watch(&m[i], &d, false);
        mirror_catch_up(&m[i], ask_version(fd, "MOVE t 0 0.5 0.5\n"));
        stall(&m[i]);
    }
    uint64_t version = move_few_often(fd);
    for (int i = 0; i < WATCHERS; i++) {
        unsigned long before = m[i].rows;
        resume(&m[i]);
        catch_up_and_check(&m[i], fd, version);
        CHECK_MSG(m[i].resets == 1 && m[i].rows - before < 6000, "%d: %lu rows", i,
                  m[i].rows - before);
        mirror_free(&m[i]);
    }
    close(fd);
    daemon_end(&d);
}

/* This number of other watchers watch what the mirror watches. They are sent events before the mirror. */
enum { OTHERS = 200 };

static void connect_others(int *other, const struct daemon *d, const struct mirror *m)
{
    char line[100];
    snprintf(line, sizeof line, "WATCH t SINCE %" PRIu64 " WITHIN %s\n", m->version,
             m->options.box);
    for (int i = 0; i < OTHERS; i++) {
        other[i] = daemon_connect(d);
        ask_version(other[i], line);
    }
}

TEST(watcher_that_becomes_late_while_an_event_is_sent_to_others_gets_it_later)
{
    enum { ROUNDS = 6 };
    int other[OTHERS];
    char line[100];
    struct daemon d = daemon_start(NULL);
    int fd = connect_with_sets(&d);
    struct mirror m = {.options = {.box = "0 0 0.5 1"}};
    mirror_watch(&m, &d, false);
    mirror_catch_up(&m, ask_version(fd, "MOVE t 0 0.1 0.5\n"));
    for (int i = 0; i < ROUNDS; i++) {
        connect_others(other, &d, &m);
        snprintf(line, sizeof line, "MOVE t 0 %g 0.5\n", i % 2 == 0 ? 0.9 : 0.1);
        uint64_t version = ask_version(fd, line);
        stall(&m); /* the mirror leaves the feed, in which it is the last one, perhaps in time */
        resume(&m);
        catch_up_and_check(&m, fd, version);
        for (int k = 0; k < OTHERS; k++)
            close(other[k]);
    }
    mirror_free(&m);
    close(fd);
    daemon_end(&d);
}
