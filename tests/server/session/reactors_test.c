/* reactors_test.c - several reactors: what one of them does for the sessions of others. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <pthread.h>
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

/* The sessions of a reactor use one buffer for replies in RESP. The first reactor uses it, too, when a job of such a session ends: while the
 * other reactor is between two requests, and never while it answers one, even if that request has to be noted as a slow one. */
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
