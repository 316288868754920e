/* watchers.c - how soon watchers of a set receive its edits. Moves points of a set at a fixed rate, or the next one when the
 * last one has arrived. Measures each edit at each watcher, from the time when it was due. Nothing else may be
 * edited meanwhile: the versions of the edits must follow one another. Prints a row of a table.
 *
 *     watchers PORT SET IDS WATCHERS RATE SECONDS       rate 0: one edit after the other
 */
#include "proto/buf.h"
#include "tests/load/driver.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

enum { EDITS = 1 << 20, READ_SIZE = 64 * 1024, TAIL_S = 20, LINE = 200 };

struct peer {
    int fd;
    struct buf in;
    uint64_t rows;    /* of the event, that are still to come */
    uint64_t version; /* of the event */
    bool more;
    uint64_t heard; /* edits */
};

struct run {
    const char *set;
    unsigned port, ids, watchers;
    uint64_t step_ns; /* between edits; 0: one after the other */
    uint64_t start_ns, end_ns;
    int epoll, timer;
    struct peer editor, *watcher; /* owns */
    uint64_t base, step;          /* edit k, from 0, makes version base + step (k + 1) */
    uint64_t sent, events;
    uint64_t *due; /* owns; ns, of each edit */
    struct histogram reply, event;
};

static void fail(const char *what, const char *why)
{
    fprintf(stderr, "watchers: %s: %s\n", what, why);
    exit(1);
}

/* The number after ` name=` in a status line. */
static uint64_t key(const char *line, const char *name)
{
    const char *at = strstr(line, name);
    if (at == NULL)
        fail("unexpected", line);
    return strtoull(at + strlen(name), NULL, 10);
}

/* Receives the available bytes, or waits for some. */
static void hear(struct peer *p)
{
    char *to = buf_reserve(&p->in, READ_SIZE);
    ssize_t n = to == NULL ? 0 : recv(p->fd, to, READ_SIZE, 0);
    if (n <= 0)
        fail("receive", n == 0 ? "the connection was closed" : strerror(errno));
    buf_commit(&p->in, (size_t)n);
}

/* The next line, its LF replaced by a NUL; NULL if it is not whole. Valid until the next hear. */
static const char *take_line(struct peer *p)
{
    size_t n = buf_len(&p->in);
    char *line = buf_head(&p->in), *end = n == 0 ? NULL : memchr(line, '\n', n);
    if (end == NULL)
        return NULL;
    *end = '\0';
    buf_consume(&p->in, (size_t)(end + 1 - line));
    return line;
}

static void say(struct peer *p, const char *line)
{
    if (send(p->fd, line, strlen(line), MSG_NOSIGNAL) != (ssize_t)strlen(line))
        fail("send", strerror(errno));
}

static const char *ask(struct peer *p, const char *line)
{
    const char *reply;
    say(p, line);
    while ((reply = take_line(p)) == NULL)
        hear(p);
    return reply;
}

static void begin(struct run *r, struct peer *p)
{
    struct epoll_event e = {.events = EPOLLIN, .data.ptr = p};
    p->fd = driver_connect(r->port);
    if (p->fd < 0 || epoll_ctl(r->epoll, EPOLL_CTL_ADD, p->fd, &e) != 0)
        exit(1);
}

/* ---- edits ---- */

static double random_coordinate(void)
{
    return (double)rand() / RAND_MAX * MIX_SPAN;
}

static void edit(struct run *r, uint64_t due)
{
    char line[LINE];
    unsigned id = (unsigned)rand() % r->ids;
    snprintf(line, sizeof line, "MOVE %s %u %.17g %.17g\n", r->set, id, random_coordinate(),
             random_coordinate());
    r->due[r->sent++] = due;
    say(&r->editor, line);
}

/* Replies come in order of the edits. */
static void read_replies(struct run *r, uint64_t now)
{
    const char *line;
    while ((line = take_line(&r->editor)) != NULL) {
        if (key(line, " version=") != r->base + r->step * (r->editor.heard + 1))
            fail("versions do not follow one another", line);
        histogram_add(&r->reply, now - r->due[r->editor.heard++], 1);
    }
}

/* ---- events ---- */

static void take_head(struct peer *w, const char *head)
{
    if (strncmp(head, "EVENT ", 6) != 0)
        fail("not an event", head);
    w->rows = strtoull(head + 6, NULL, 10);
    w->version = key(head, " version=");
    w->more = strstr(head, " more") != NULL;
}

static void read_events(struct run *r, struct peer *w, uint64_t now)
{
    const char *line;
    while ((line = take_line(w)) != NULL) {
        if (w->rows > 0)
            w->rows--;
        else
            take_head(w, line);
        if (w->rows > 0 || w->more)
            continue;
        r->events++;
        for (; w->heard < r->sent && r->base + r->step * w->heard < w->version; w->heard++)
            histogram_add(&r->event, now - r->due[w->heard], 1);
    }
}

/* ---- a run ---- */

static bool all_heard(const struct run *r)
{
    bool all = r->editor.heard == r->sent;
    for (unsigned i = 0; all && i < r->watchers; i++)
        all = r->watcher[i].heard == r->sent;
    return all;
}

static void prepare(struct run *r)
{
    char line[LINE];
    begin(r, &r->editor);
    snprintf(line, sizeof line, "MOVE %s 0 0.25 0.25\n", r->set);
    uint64_t before = key(ask(&r->editor, line), " version=");
    r->base = key(ask(&r->editor, line), " version=");
    r->step = r->base - before;
    snprintf(line, sizeof line, "WATCH %s SINCE %" PRIu64 "\n", r->set, r->base);
    for (unsigned i = 0; i < r->watchers; i++) {
        begin(r, &r->watcher[i]);
        if (key(ask(&r->watcher[i], line), " version=") != r->base)
            fail("the set is edited", line);
    }
}

/* Sends the edits that are due, and returns the time until the next one in ns. */
static void send_due(struct run *r, uint64_t now)
{
    if (r->step_ns == 0 && now < r->end_ns && r->sent < EDITS && all_heard(r))
        edit(r, now);
    if (r->step_ns == 0)
        return;
    while (r->sent < EDITS && r->start_ns + r->sent * r->step_ns <= now &&
           r->start_ns + r->sent * r->step_ns < r->end_ns)
        edit(r, r->start_ns + r->sent * r->step_ns);
}

static void turn(struct run *r)
{
    struct epoll_event e[64];
    int n = epoll_wait(r->epoll, e, 64, 100);
    uint64_t ticks;
    for (int i = 0; i < n; i++) {
        struct peer *p = e[i].data.ptr;
        if (p == NULL) {
            (void)!read(r->timer, &ticks, sizeof ticks);
            continue;
        }
        hear(p);
        if (p == &r->editor)
            read_replies(r, driver_now_ns());
        else
            read_events(r, p, driver_now_ns());
    }
}

static void measure(struct run *r, double seconds)
{
    struct itimerspec tick = {{0, (long)r->step_ns}, {0, (long)r->step_ns}};
    struct epoll_event e = {.events = EPOLLIN};
    r->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK);
    timerfd_settime(r->timer, 0, &tick, NULL);
    epoll_ctl(r->epoll, EPOLL_CTL_ADD, r->timer, &e);
    r->start_ns = driver_now_ns();
    r->end_ns = r->start_ns + (uint64_t)(seconds * 1e9);
    for (uint64_t now = r->start_ns; now < r->end_ns || !all_heard(r); now = driver_now_ns()) {
        if (now > r->end_ns + TAIL_S * UINT64_C(1000000000))
            fail("events are missing", r->set);
        send_due(r, now);
        turn(r);
    }
}

static void print(const struct run *r, double seconds)
{
    printf(
        "%u watchers, %.0f edits/s, %.0f events/s: reply p50 %.3f p99 %.3f ms, event p50 %.3f p99 "
        "%.3f max %.3f ms\n",
        r->watchers, (double)r->sent / seconds, (double)r->events / seconds,
        1e-6 * (double)histogram_quantile(&r->reply, 0.5),
        1e-6 * (double)histogram_quantile(&r->reply, 0.99),
        1e-6 * (double)histogram_quantile(&r->event, 0.5),
        1e-6 * (double)histogram_quantile(&r->event, 0.99), 1e-6 * (double)r->event.max);
}

int main(int argc, char **argv)
{
    static struct run r;
    if (argc != 7) {
        fprintf(stderr, "usage: watchers PORT SET IDS WATCHERS RATE SECONDS\n");
        return 2;
    }
    double rate = strtod(argv[5], NULL), seconds = strtod(argv[6], NULL);
    r.port = (unsigned)strtoul(argv[1], NULL, 10);
    r.set = argv[2];
    r.ids = (unsigned)strtoul(argv[3], NULL, 10);
    r.watchers = (unsigned)strtoul(argv[4], NULL, 10);
    r.step_ns = rate > 0 ? (uint64_t)(1e9 / rate) : 0;
    r.epoll = epoll_create1(0);
    r.watcher = calloc(r.watchers + 1, sizeof *r.watcher);
    r.due = calloc(EDITS, sizeof *r.due);
    if (r.watcher == NULL || r.due == NULL)
        fail("memory", "not enough");
    prepare(&r);
    measure(&r, seconds);
    print(&r, seconds);
    for (unsigned i = 0; i < r.watchers; i++)
        buf_free(&r.watcher[i].in);
    free(r.watcher);
    free(r.due);
    return 0;
}
