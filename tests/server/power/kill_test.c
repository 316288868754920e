/* kill_test.c - kill -9 at random moments under load, against an oracle: a second daemon, without a
 * data directory, that gets the same requests.
 *
 * Each client has a set of its own and a stream of requests, sent in bursts. When the daemon dies, the
 * first requests of a burst are acknowledged, and more are sent. The restarted daemon must have, byte for
 * byte, the state after some number of requests of the stream: at least the acknowledged ones, at most
 * those that were sent. KILL_ROUNDS is the number of rounds (make faults: 200). */
#include "tests/server/directory.h"
#include "tests/test.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { CLIENTS = 4, REQUESTS = 400, REQUEST_BYTES = 200, BURST = 8, REPLY_BYTES = 160 };

struct client {
    int fd; /* connected before the round: the daemon may be dead before its thread begins */
    char set[16];
    char request[REQUESTS][REQUEST_BYTES];
    char reply[REQUESTS][REPLY_BYTES];
    int sent, acknowledged;
    uint32_t ids;       /* how many the set has had; after a kill, a lower bound */
    uint32_t settled;   /* those that it had before the burst */
    uint32_t first_ids; /* before the round */
    pthread_t thread;
};

/* ---- requests ---- */

static unsigned place(void)
{
    return test_below(9);
}

/* An id to delete, usually an existing id, but not an id of this burst. A set whose new points were deleted again would
 * look like a set that never had them, but would give other ids to the next points. */
static unsigned victim(const struct client *c)
{
    enum { NOBODY = 1000000 };
    return c->settled == 0 || test_below(20) == 0 ? NOBODY : test_below(c->settled);
}

/* About constraints, or an edit that minds them; many of these are refused. */
static void compose_constraint(struct client *c, char *to)
{
    unsigned kind = test_below(10), a = test_below(c->ids + 1), b = test_below(c->ids + 1);
    if (kind < 6)
        snprintf(to, REQUEST_BYTES, "CONSTRAIN %s %s%sOF %u %u %u\n", c->set,
                 kind < 2 ? "BORDER " : "", kind % 2 == 0 ? "SPLIT " : "", test_below(3), a, b);
    else if (kind < 7)
        snprintf(to, REQUEST_BYTES, "RELEASE %s %s\n", c->set, test_below(8) == 0 ? "ALL" : "OF 1");
    else if (kind < 8)
        snprintf(to, REQUEST_BYTES, "DEL %s %u CASCADE\n", c->set, victim(c));
    else
        snprintf(to, REQUEST_BYTES, "MOVE %s %u %u %u %u %u %u\n", c->set, a, place(), place(), b,
                 place(), place());
}

static void compose(struct client *c, char *to)
{
    unsigned kind = test_below(100), n = 1 + test_below(5);
    const char *set = c->set;
    size_t at;
    bool close = c->set[1] == '3'; /* the set with a tolerance */
    if (kind < 60) {
        bool load = kind < 10;
        at = (size_t)snprintf(to, REQUEST_BYTES, load ? "LOAD %s %u\n" : "ADD %s ", set, n);
        c->ids += n;
        for (; n > 0; n--)
            at += (size_t)snprintf(to + at, REQUEST_BYTES - at, load ? "%u %u.5\n" : "%u %u ",
                                   place(), place());
        snprintf(to + at, REQUEST_BYTES - at, load ? "" : "\n");
    } else if (kind < 78) {
        snprintf(to, REQUEST_BYTES, "DEL %s %u\n", set, victim(c));
    } else if (kind < 88) {
        compose_constraint(c, to);
    } else if (kind < 94) {
        snprintf(to, REQUEST_BYTES, "MOVE %s %u %u %u\n", set, test_below(c->ids + 2), place(),
                 place());
    } else if (kind < 98) {
        snprintf(to, REQUEST_BYTES, close ? "CREATE %s TOL 0.75\n" : "TRIANGULATE %s\n", set);
    } else if (kind < 99) {
        snprintf(to, REQUEST_BYTES, "CREATE %s\n", set);
    } else {
        snprintf(to, REQUEST_BYTES, "DROP %s\n", set);
        c->ids = c->settled = 0;
    }
}

/* ---- clients ---- */

/* Reads a line up to `ms=`, which differs; false if the connection is closed. */
static bool hear(int fd, char line[REPLY_BYTES])
{
    size_t n = 0;
    char c;
    while (recv(fd, &c, 1, 0) == 1) {
        if (c == '\n') {
            line[n] = '\0';
            char *ms = strstr(line, " ms=");
            if (ms != NULL)
                *ms = '\0';
            return true;
        }
        if (n + 1 < REPLY_BYTES)
            line[n++] = c;
    }
    return false;
}

static bool send_request(int fd, const char *text)
{
    size_t n = strlen(text);
    return send(fd, text, n, MSG_NOSIGNAL) == (ssize_t)n;
}

static void *talk(void *arg)
{
    struct client *c = arg;
    int fd = c->fd;
    while (c->acknowledged < REQUESTS) {
        int end = c->acknowledged + BURST < REQUESTS ? c->acknowledged + BURST : REQUESTS;
        while (c->sent < end && send_request(fd, c->request[c->sent]))
            c->sent++;
        if (c->sent < end) { /* part of it may have been sent */
            c->sent++;
            break;
        }
        while (c->acknowledged < c->sent && hear(fd, c->reply[c->acknowledged]))
            c->acknowledged++;
        if (c->acknowledged < c->sent)
            break;
    }
    close(fd);
    return NULL;
}

static void *disturb(void *arg)
{
    int fd = *(const int *)arg;
    char line[REPLY_BYTES];
    while (send_request(fd, "SNAPSHOT\n") && hear(fd, line))
        pause_ms(10);
    close(fd);
    return NULL;
}

/* ---- the oracle ---- */

static char *state(const struct daemon *d, const char *set)
{
    char request[200];
    size_t n;
    int fd = daemon_connect(d);
    snprintf(request, sizeof request,
             "POINTS %s\nCOINCIDENT %s\nLISTS %s\nHULL %s\nCONSTRAINTS %s\nEDGES %s CONSTRAINED\n",
             set, set, set, set, set, set);
    say(fd, request);
    shutdown(fd, SHUT_WR);
    char *text = hear_all(fd, &n);
    close(fd);
    return text;
}

static bool same_state(const struct daemon *a, const struct daemon *b, const char *set)
{
    char *x = state(a, set), *y = state(b, set);
    bool same = strcmp(x, y) == 0;
    free(x);
    free(y);
    return same;
}

static void check_client(const struct client *c, const struct daemon *d,
                         const struct daemon *oracle)
{
    int fd = daemon_connect(oracle), applied = 0;
    char reply[REPLY_BYTES];
    for (; applied < c->acknowledged; applied++) {
        CHECK(send_request(fd, c->request[applied]) && hear(fd, reply));
        CHECK_UNVERSIONED(reply, c->reply[applied]);
    }
    while (!same_state(d, oracle, c->set)) {
        CHECK_MSG(applied < c->sent, "%s is in no state between %d and %d requests", c->set,
                  c->acknowledged, c->sent);
        CHECK(send_request(fd, c->request[applied]) && hear(fd, reply));
        applied++;
    }
    close(fd);
}

/* ---- rounds ---- */

/* The number of ids that the last round has certainly left. */
static uint32_t certain_ids(const struct client *c)
{
    uint32_t ids = c->first_ids;
    for (int i = 0; i < c->sent; i++) {
        unsigned first, added;
        const char *got = i < c->acknowledged ? strstr(c->reply[i], "first=") : NULL;
        if (strncmp(c->request[i], "DROP", 4) == 0)
            ids = 0;
        else if (got != NULL && sscanf(got, "first=%u added=%u", &first, &added) == 2)
            ids = first + added;
    }
    return ids;
}

static void prepare(struct client *c, int number, const struct daemon *d)
{
    snprintf(c->set, sizeof c->set, "s%d", number);
    c->fd = daemon_connect(d);
    c->ids = c->first_ids = certain_ids(c);
    c->sent = c->acknowledged = 0;
    for (int i = 0; i < REQUESTS; i++) {
        c->settled = i % BURST == 0 ? c->ids : c->settled;
        compose(c, c->request[i]);
    }
}

static void run_round(struct client *client, const struct daemon *d)
{
    pthread_t other;
    int other_fd = daemon_connect(d);
    for (int i = 0; i < CLIENTS; i++) {
        prepare(&client[i], i, d);
        CHECK(pthread_create(&client[i].thread, NULL, talk, &client[i]) == 0);
    }
    CHECK(pthread_create(&other, NULL, disturb, &other_fd) == 0);
    pause_ms(test_below(120));
    daemon_stop(d, SIGKILL);
    for (int i = 0; i < CLIENTS; i++)
        CHECK(pthread_join(client[i].thread, NULL) == 0);
    CHECK(pthread_join(other, NULL) == 0);
}

static unsigned rounds(void)
{
    const char *text = getenv("KILL_ROUNDS");
    return text == NULL ? 8 : (unsigned)strtoul(text, NULL, 10);
}

TEST_TIMEOUT(killed_daemon_has_every_acknowledged_change, 600)
{
    static struct client client[CLIENTS];
    static const char *const policy[] = {"always", "everysec", "no"};
    struct directory dir = directory_new();
    struct daemon oracle = daemon_start(NULL), d;
    unsigned long acknowledged = 0, unsure = 0;
    for (unsigned i = 0, n = rounds(); i <= n; i++) {
        const char *const arguments[] = {"--compact-at", "8k", "--fsync", policy[i % 3], NULL};
        d = directory_daemon(&dir, arguments);
        for (int c = 0; i > 0 && c < CLIENTS; c++) {
            check_client(&client[c], &d, &oracle);
            acknowledged += (unsigned long)client[c].acknowledged;
            unsure += (unsigned long)(client[c].sent - client[c].acknowledged);
        }
        if (i < n)
            run_round(client, &d);
    }
    if (getenv("KILL_ROUNDS") != NULL)
        printf("%u rounds: %lu changes acknowledged, %lu under way when it was killed\n", rounds(),
               acknowledged, unsure);
    CHECK(acknowledged > 0);
    daemon_stop(&d, SIGTERM);
    directory_remove(&dir);
}
