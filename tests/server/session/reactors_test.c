/* reactors_test.c - several reactors: what one of them does for the sessions of others. */
#include "tests/server/directory.h"
#include "tests/server/watch/mirror.h"
#include "tests/test.h"

#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct daemon *shared;
static char checked[300]; /* the reply of CHECK b */

/* ---- replies go to those who have asked ---- */

enum { ASKERS = 16, ROUNDS = 100, GETS = 100, REQUEST = 64 };

/* A pipeline about a point that no other client asks for. */
static void ask_for_a_point(int fd, unsigned id)
{
    char get[REQUEST], want[REQUEST], text[GETS * REQUEST], all[GETS * REQUEST];
    size_t n = (size_t)sprintf(get, "*3\r\n$3\r\nGET\r\n$1\r\nt\r\n$2\r\n%u\r\n", id);
    size_t m = (size_t)sprintf(want, "*1\r\n$7\r\n%u %u 7\r\n", id, id);
    for (size_t i = 0; i < GETS; i++) {
        memcpy(text + i * n, get, n + 1);
        memcpy(all + i * m, want, m + 1);
    }
    for (int i = 0; i < ROUNDS; i++) {
        say(fd, text);
        expect(fd, all);
    }
}

static void ask_a_worker(int fd)
{
    for (int i = 0; i < ROUNDS; i++) {
        say(fd, "*2\r\n$5\r\nCHECK\r\n$1\r\nb\r\n");
        expect(fd, checked);
    }
}

static void *ask(void *arg)
{
    unsigned number = (unsigned)(uintptr_t)arg;
    int fd = daemon_connect(shared);
    if (number % 2 == 0)
        ask_for_a_point(fd, 10 + number);
    else
        ask_a_worker(fd);
    close(fd);
    return NULL;
}

/* The sessions of a reactor use one buffer for replies in RESP. The first reactor uses it, too, when a job of such a session
 * ends: while the other reactor is between two requests, never while it answers one or notes one as slow. */
TEST_TIMEOUT(slow_requests_get_their_own_replies_while_jobs_end_on_another_reactor, 60)
{
    static const char *const arguments[] = {"--reactors", "3", "--slowlog-us", "1", NULL};
    struct daemon d = daemon_start(arguments);
    pthread_t thread[ASKERS];
    int fd = daemon_connect(&d);
    load_random(fd, "b", 5000);
    say(fd, "TRIANGULATE b\n");
    hear_line(fd);
    say(fd, "CHECK b\n");
    sprintf(checked, "+%s\r\n", hear_line(fd));
    memmove(checked + 3, checked + 5, strlen(checked + 5) + 1); /* "OK 0" is "OK" in RESP */
    for (int i = 0; i < 30; i++) {
        char text[REQUEST];
        sprintf(text, "ADD t %d 7\n", i);
        say(fd, text);
        hear_line(fd);
    }
    shared = &d;
    for (uintptr_t i = 0; i < ASKERS; i++)
        CHECK(pthread_create(&thread[i], NULL, ask, (void *)i) == 0);
    for (int i = 0; i < ASKERS; i++)
        CHECK(pthread_join(thread[i], NULL) == 0);
    daemon_end(&d);
}

/* ---- edits on several reactors ---- */

enum { EDITORS = 8, EDITS = 400, HUB = 3000 };

/* Requests of every kind that reactors carry out beside each other. The points are its own, so replies are known. */
static void *edit(void *arg)
{
    unsigned me = (unsigned)(uintptr_t)arg;
    int fd = daemon_connect(shared);
    char text[200];
    for (unsigned i = 0; i < EDITS; i++) {
        sprintf(text, "ADD %c %u.%u %u\n", 'p' + (int)(i % 2), i, me + 1, me);
        say(fd, text);
        const char *first = strstr(hear_line(fd), "first=");
        CHECK(first != NULL);
        unsigned id = (unsigned)strtoul(first + 6, NULL, 10);
        sprintf(text, "MOVE %c %u %u.%u %u\nFSET %c z %u %u\nGET %c %u\n", 'p' + (int)(i % 2), id,
                i, me + 1, me + 100, 'p' + (int)(i % 2), id, me, 'p' + (int)(i % 2), id);
        say(fd, text);
        CHECK(strncmp(hear_line(fd), "OK 0 version=", 13) == 0);
        CHECK(strncmp(hear_line(fd), "OK 0 version=", 13) == 0);
        CHECK_STR(hear_line(fd), "OK 1");
        sprintf(text, "%u %u.%u %u", id, i, me + 1, me + 100);
        CHECK_STR(hear_line(fd), text);
        sprintf(text, "LOAD %c 2\n%u.%u %u\n%u.%u %u\n", 'p' + (int)(i % 2), i, me + 1, me + 200, i,
                me + 1, me + 300);
        say(fd, text);
        CHECK(strstr(hear_line(fd), " added=2 coincident=0 ") != NULL);
        sprintf(text,
                "*6\r\n$5\r\nFSETB\r\n$1\r\n%c\r\n$1\r\ny\r\n$1\r\n0\r\n$1\r\n1\r\n$8\r\n%08u\r\n",
                'p' + (int)(i % 2), me);
        say(fd, text);
        CHECK(strncmp(hear_line(fd), "+OK version=", 12) == 0);
        if (i % 4 == 3) {
            sprintf(text, "DEL %c %u\n", 'p' + (int)(i % 2), id);
            say(fd, text);
            CHECK(strncmp(hear_line(fd), "OK 0 deleted=1 ", 15) == 0);
        }
    }
    close(fd);
    return NULL;
}

static void digests(const struct daemon *d, char p[200], char q[200])
{
    int fd = daemon_connect(d);
    say(fd, "DIGEST p\n");
    snprintf(p, 200, "%s", hear_line(fd));
    say(fd, "DIGEST q\n");
    snprintf(q, 200, "%s", hear_line(fd));
    say(fd, "CHECK p\nCHECK q\n");
    CHECK(strstr(hear_line(fd), "delaunay=yes") != NULL);
    CHECK(strstr(hear_line(fd), "delaunay=yes") != NULL);
    close(fd);
}

TEST_TIMEOUT(edits_of_the_same_sets_on_several_reactors_have_one_order_which_the_log_has_too, 60)
{
    static const char *const arguments[] = {"--reactors", "3", NULL};
    struct directory dir = directory_quick();
    struct daemon d = directory_daemon(&dir, arguments);
    pthread_t thread[EDITORS];
    char p[200], q[200], p_again[200], q_again[200];
    carry_out(&d,
              "ADD p -1 -1 -2 -1 -1 -2\nADD q -1 -1 -2 -1 -1 -2\nTRIANGULATE p\nTRIANGULATE q\n");
    shared = &d;
    for (uintptr_t i = 0; i < EDITORS; i++)
        CHECK(pthread_create(&thread[i], NULL, edit, (void *)i) == 0);
    for (int i = 0; i < EDITORS; i++)
        CHECK(pthread_join(thread[i], NULL) == 0);
    digests(&d, p, q);
    CHECK(daemon_stop(&d, SIGKILL) == -1);
    d = directory_daemon(&dir, arguments);
    digests(&d, p_again, q_again);
    CHECK_STR(p_again, p);
    CHECK_STR(q_again, q);
    daemon_end(&d);
    directory_remove(&dir);
}

/* ---- those who watch ---- */

enum { WATCHERS = 6, SINGLE = 200 };

static void *edit_t(void *arg)
{
    unsigned me = (unsigned)(uintptr_t)arg;
    int fd = daemon_connect(shared);
    char text[200];
    for (unsigned i = 0; i < EDITS / 2; i++) {
        sprintf(text, "ADD t %u.%u %u\n", i, me + 1, me);
        say(fd, text);
        const char *first = strstr(hear_line(fd), "first=");
        CHECK(first != NULL);
        unsigned id = (unsigned)strtoul(first + 6, NULL, 10);
        sprintf(text, i % 4 == 3 ? "DEL t %u\n" : "MOVE t %u %u.%u %u\n", id, i, me + 1, me + 100);
        say(fd, text);
        CHECK(strncmp(hear_line(fd), "OK 0 ", 5) == 0);
    }
    close(fd);
    return NULL;
}

TEST_TIMEOUT(watchers_on_all_reactors_have_what_the_editors_on_all_reactors_have_made, 30)
{
    static const char *const arguments[] = {"--reactors", "3", NULL};
    static struct mirror m[WATCHERS];
    struct daemon d = daemon_start(arguments);
    pthread_t thread[EDITORS];
    int fd = daemon_connect(&d);
    carry_out(&d, "ADD t -1 -1 -2 -1 -1 -2\nTRIANGULATE t\n");
    for (int i = 0; i < WATCHERS; i++)
        mirror_watch(&m[i], &d, false);
    shared = &d;
    for (uintptr_t i = 0; i < EDITORS; i++)
        CHECK(pthread_create(&thread[i], NULL, edit_t, (void *)i) == 0);
    for (int i = 0; i < EDITORS; i++)
        CHECK(pthread_join(thread[i], NULL) == 0);
    uint64_t version = ask_version(fd, "STAT t\n");
    for (int i = 0; i < WATCHERS; i++) {
        mirror_catch_up(&m[i], version);
        mirror_check(&m[i], fd, true);
    }
    /* An event does not wait until a reactor happens to be alone. */
    for (unsigned i = 0; i < SINGLE; i++)
        mirror_catch_up(&m[0], ask_version(fd, "ADD t 0 0\n"));
    for (int i = 0; i < WATCHERS; i++)
        mirror_free(&m[i]);
    daemon_end(&d);
}

/* A reactor that shares the world gives up such an edit, which has been begun, and carries it out when it is alone. */
TEST(edit_that_turns_out_to_need_a_worker_is_carried_out_once)
{
    static const char *const arguments[] = {"--reactors", "3", NULL};
    static const double pi = 3.14159265358979;
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    char text[100];
    say(fd, "LOAD t\n0 0\n");
    for (int i = 0; i < HUB; i++) {
        snprintf(text, sizeof text, "%.17g %.17g\n", cos(2 * pi * i / HUB), sin(2 * pi * i / HUB));
        say(fd, text);
    }
    say(fd, ".\nTRIANGULATE t\nSTAT t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 ", 13) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 ", 5) == 0);
    const char *version = strstr(hear_line(fd), "version=");
    CHECK(version != NULL);
    uint64_t before = strtoull(version + 8, NULL, 10);
    say(fd, "DEL t 0\n"); /* its neighbours are all others */
    snprintf(text, sizeof text, "OK 0 deleted=1 version=%" PRIu64, before + 2);
    CHECK_STR(hear_line(fd), text);
    say(fd, "LOAD t 1\n0 0\nDEL t 0\n"); /* the body is still there when it is carried out again */
    snprintf(text, sizeof text, "OK 0 first=%d added=1 coincident=0 version=%" PRIu64, HUB + 1,
             before + 4);
    CHECK_STR(hear_line(fd), text);
    CHECK_STR(hear_line(fd), "ERR NOPOINT there is no point 0; nothing was deleted");
    daemon_end(&d);
}

/* The registry of sets checks that. */
TEST(sets_come_and_go_while_a_reactor_is_alone)
{
    static const char *const arguments[] = {"--reactors", "3", NULL};
    static const char *const request[] = {"CREATE t TOL 1", "ADD t 0 0", "ADD u 0 0",
                                          "EXPIRE u 0.001", "DROP t",    "CREATE v TEMPORARY"};
    struct daemon d = daemon_start(arguments);
    for (int i = 0; i < 6; i++) {
        int fd = daemon_connect(&d);
        for (size_t k = 0; k < sizeof request / sizeof request[0]; k++) {
            say(fd, request[k]);
            say(fd, "\n");
            CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
        }
        close(fd);
        while (daemon_info(&d, "sets") > 0)
            pause_ms(10);
    }
    daemon_end(&d);
}
