/* linear_test.c - several connections edit and read the same sets at once. Each request takes effect at one moment
 * between its arrival and its reply. Acknowledged edits are there after a restart, in the same order. */
#include "tests/server/daemon.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

/* On any machine; with one reactor, only one request is carried out at a time. */
static const char *const several[] = {"--reactors", "4", NULL};

/* A connection of one thread. */
struct line {
    int fd;
    size_t have;
    char in[1 << 14];
};

static void hang_up(struct line *l)
{
    close(l->fd);
}

static void tell(const struct line *l, const char *text, size_t n)
{
    for (size_t at = 0; at < n;) {
        ssize_t sent = send(l->fd, text + at, n - at, MSG_NOSIGNAL);
        CHECK(sent > 0);
        at += (size_t)sent;
    }
}

/* Copies the next line, without its LF. */
static void hear(struct line *l, char *to, size_t size)
{
    char *lf;
    while ((lf = memchr(l->in, '\n', l->have)) == NULL) {
        ssize_t n = recv(l->fd, l->in + l->have, sizeof l->in - l->have, 0);
        CHECK(n > 0);
        l->have += (size_t)n;
    }
    size_t len = (size_t)(lf - l->in);
    CHECK(len < size);
    memcpy(to, l->in, len);
    to[len] = '\0';
    l->have -= len + 1;
    memmove(l->in, lf + 1, l->have);
    if (to[0] == '#') /* a comment about progress */
        hear(l, to, size);
}

static int64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1000000000ll + t.tv_nsec;
}

/* ---- a point as a register: MOVE writes it, GET reads it ---- */

enum { CLIENTS = 6, ROUNDS = 1500, VALUES = CLIENTS * ROUNDS + 1 };

/* All requests about one value: from the end of the one that ended first to the beginning of the one that began last. */
struct zone {
    int64_t first_end, last_begin;
};

static const struct daemon *shared;

/* The requests of one client. Each MOVE writes a value that no other one writes. */
struct client {
    unsigned number, n;
    struct {
        unsigned value;
        int64_t begin, end;
    } did[2 * ROUNDS];
};

static void *move_and_get(void *arg)
{
    struct client *c = arg;
    struct line l = {.fd = daemon_connect(shared)};
    char text[64], reply[200];
    for (unsigned i = 0; i < 2 * ROUNDS; i++) {
        bool writes = i % 2 == c->number % 2;
        unsigned value = 1 + c->number * ROUNDS + i / 2;
        int n = writes ? sprintf(text, "MOVE t 0 %u 0\n", value) : sprintf(text, "GET t 0\n");
        int64_t begin = now_ns();
        tell(&l, text, (size_t)n);
        hear(&l, reply, sizeof reply);
        CHECK_MSG(strncmp(reply, writes ? "OK 0" : "OK 1", 4) == 0, "%s", reply);
        if (!writes) {
            hear(&l, reply, sizeof reply);
            CHECK_MSG(sscanf(reply, "0 %u 0", &value) == 1, "%s", reply);
        }
        c->did[c->n].value = value;
        c->did[c->n].begin = begin;
        c->did[c->n++].end = now_ns();
    }
    hang_up(&l);
    return NULL;
}

static int by_first_end(const void *a, const void *b)
{
    const struct zone *x = a, *y = b;
    return (x->first_end > y->first_end) - (x->first_end < y->first_end);
}

/* Each value is written once. The history is linearizable if and only if (1) no read ends before its write begins, (2) no two
 * forward zones overlap, (3) no backward zone is inside a forward one. A zone is forward if it ends after it begins.
 * [Gibbons & Korach 1997, "Testing shared memories"] */
static const char *contradiction(struct zone *zone, size_t n)
{
    qsort(zone, n, sizeof *zone, by_first_end);
    const struct zone *last = NULL; /* the latest forward zone; others end before it */
    for (size_t i = 0; i < n; i++) {
        const struct zone *z = &zone[i];
        bool within = last != NULL && z->first_end <= last->last_begin;
        if (z->last_begin > z->first_end) {
            if (within)
                return "a value is read after a later one";
            last = z;
        } else if (within && z->last_begin >= last->first_end) {
            return "a value is written and read while another one is there";
        }
    }
    return NULL;
}

TEST(histories_that_have_no_order_are_recognized)
{
    struct zone overlap[] = {{10, 30}, {20, 40}}, inside[] = {{10, 30}, {25, 20}},
                apart[] = {{10, 20}, {21, 40}}, across[] = {{10, 30}, {25, 5}, {50, 35}};
    CHECK_STR(contradiction(overlap, 2), "a value is read after a later one");
    CHECK_STR(contradiction(inside, 2), "a value is written and read while another one is there");
    CHECK(contradiction(apart, 2) == NULL && contradiction(across, 3) == NULL);
}

static void note(struct zone *z, int64_t begin, int64_t end)
{
    if (end < z->first_end)
        z->first_end = end;
    if (begin > z->last_begin)
        z->last_begin = begin;
}

TEST_TIMEOUT(moves_and_reads_of_a_point_by_six_connections_have_one_order, 60)
{
    struct daemon d = daemon_start(several);
    static struct client client[CLIENTS];
    static struct zone zone[VALUES];
    static int64_t written[VALUES];
    pthread_t thread[CLIENTS];
    carry_out(&d, "ADD t 0 0 5 5 9 1\nTRIANGULATE t\n");
    shared = &d;
    for (unsigned i = 0; i < CLIENTS; i++) {
        client[i].number = i;
        CHECK(pthread_create(&thread[i], NULL, move_and_get, &client[i]) == 0);
    }
    for (unsigned i = 0; i < CLIENTS; i++)
        CHECK(pthread_join(thread[i], NULL) == 0);
    for (size_t v = 0; v < VALUES; v++)
        zone[v] = (struct zone){INT64_MAX, INT64_MIN};
    note(&zone[0], 0, 1); /* the first place */
    for (unsigned i = 0; i < CLIENTS; i++)
        for (unsigned k = 0; k < client[i].n; k++) {
            unsigned v = client[i].did[k].value;
            CHECK(v < VALUES);
            note(&zone[v], client[i].did[k].begin, client[i].did[k].end);
            if (v > 0 && (v - 1) / ROUNDS == i && k % 2 == i % 2)
                written[v] = client[i].did[k].begin;
        }
    for (unsigned i = 0; i < CLIENTS; i++)
        for (unsigned k = 0; k < client[i].n; k++)
            CHECK(client[i].did[k].end >= written[client[i].did[k].value]);
    const char *why = contradiction(zone, VALUES);
    CHECK_MSG(why == NULL, "%s", why);
    daemon_end(&d);
}

/* ---- what one connection was told another one sees ---- */

TEST(what_one_connection_was_told_is_seen_by_all_others)
{
    enum { CONNECTIONS = 8, ADDS = 20000 };
    struct daemon d = daemon_start(several);
    static struct line l[CONNECTIONS];
    char text[64], reply[200], want[64];
    for (int i = 0; i < CONNECTIONS; i++)
        l[i].fd = daemon_connect(&d);
    for (unsigned i = 0; i < ADDS; i++) {
        struct line *says = &l[i % CONNECTIONS], *asks = &l[(i * 7 + 3) % CONNECTIONS];
        tell(says, text, (size_t)sprintf(text, "ADD s%u %u 1\n", i % 3, i));
        hear(says, reply, sizeof reply);
        sprintf(want, "OK 0 first=%u added=1 ", i / 3);
        CHECK_MSG(strncmp(reply, want, strlen(want)) == 0, "%s", reply);
        tell(asks, text, (size_t)sprintf(text, "GET s%u %u\n", i % 3, i / 3));
        hear(asks, reply, sizeof reply);
        CHECK_STR(reply, "OK 1");
        hear(asks, reply, sizeof reply);
        sprintf(want, "%u %u 1", i / 3, i);
        CHECK_STR(reply, want);
    }
    for (int i = 0; i < CONNECTIONS; i++)
        hang_up(&l[i]);
    daemon_end(&d);
}

/* ---- the order of the log is that of the edits ---- */

enum { EDITORS = 16, SETS = 5, EDITS = 300, BATCH = 20 };

static int random_edit(char *to, unsigned *state)
{
    *state = *state * 1103515245u + 12345u;
    unsigned r = *state >> 8, set = r % SETS, id = r / 5 % 400;
    switch (r / 64 % 12) {
    case 0:
        return sprintf(to, "DEL s%u %u\n", set, id);
    case 1:
        return sprintf(to, "MOVE s%u %u %u %u\n", set, id, r % 1000, r / 1000 % 1000);
    case 2:
        return sprintf(to, "FSET s%u f%u %u %u\n", set, r % 3, id, r);
    case 3:
        return sprintf(to, r % 8 == 0 ? "DROP s%u\n" : "TRIANGULATE s%u\n", set);
    case 4:
        return sprintf(to, r % 8 == 0 ? "FDROP s%u f%u\n" : "CREATE s%u TOL %u\n", set, r % 3);
    case 5:
        return sprintf(to, "LOAD s%u 2\n%u 7\n%u 9\n", set, r % 1000, r % 777);
    default:
        return sprintf(to, "ADD s%u %u %u %u %u\n", set, r % 1000, r % 313, r % 577, r % 1013);
    }
}

static void *edit(void *arg)
{
    unsigned state = (unsigned)(uintptr_t)arg;
    struct line l = {.fd = daemon_connect(shared)};
    char text[BATCH * 100], reply[200];
    for (int i = 0; i < EDITS; i += BATCH) {
        size_t n = 0;
        for (int k = 0; k < BATCH; k++)
            n += (size_t)random_edit(text + n, &state);
        tell(&l, text, n);
        for (int k = 0; k < BATCH; k++) {
            hear(&l, reply, sizeof reply);
            CHECK_MSG(strncmp(reply, "OK 0", 4) == 0 || strncmp(reply, "ERR NO", 6) == 0 ||
                          strncmp(reply, "ERR EXISTS", 10) == 0,
                      "%s", reply);
        }
    }
    hang_up(&l);
    return NULL;
}

/* The digest of a set; "": there is none. */
static void digest_of(struct line *l, unsigned set, char *to, size_t size)
{
    char text[64];
    tell(l, text, (size_t)sprintf(text, "DIGEST s%u\n", set));
    hear(l, to, size);
    CHECK_MSG(strncmp(to, "OK 0", 4) == 0 || strncmp(to, "ERR NOSET", 9) == 0, "%s", to);
}

static void digests(const struct daemon *d, char to[SETS][200])
{
    struct line l = {.fd = daemon_connect(d)};
    for (unsigned i = 0; i < SETS; i++)
        digest_of(&l, i, to[i], 200);
    hang_up(&l);
}

TEST_TIMEOUT(edits_of_sixteen_connections_are_there_after_a_kill_in_the_same_order, 60)
{
    char before[SETS][200], after[SETS][200];
    pthread_t thread[EDITORS];
    struct directory dir = directory_quick();
    struct daemon d = directory_daemon(&dir, several);
    shared = &d;
    for (uintptr_t i = 0; i < EDITORS; i++)
        CHECK(pthread_create(&thread[i], NULL, edit, (void *)(i * 7919 + test_below(1000))) == 0);
    for (int i = 0; i < EDITORS; i++)
        CHECK(pthread_join(thread[i], NULL) == 0);
    digests(&d, before);
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, several);
    digests(&d, after);
    for (int i = 0; i < SETS; i++)
        CHECK_STR(after[i], before[i]);
    daemon_end(&d);
    directory_remove(&dir);
}
