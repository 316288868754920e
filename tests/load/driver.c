/* driver.c - see driver.h. */
#include "tests/load/driver.h"

#include "proto/buf.h"
#include "proto/reply_read.h"
#include "tests/load/resp.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

enum { EVENTS = 256, READ_SIZE = 64 * 1024, TAIL_MS = 10 * 1000 };

/* A connection. Its unanswered requests are a ring of the times from which their latencies run. */
struct peer {
    int fd;
    struct buf in, out;
    struct reply_reader reader;
    unsigned lines;   /* of the current reply that have arrived, for peers of another protocol */
    unsigned flying;  /* requests without a reply */
    unsigned oldest;  /* the place of the first of them in `since` */
    uint64_t *since;  /* owns; `pipeline` long */
    uint64_t next_ns; /* open loop: when its next request is due */
    bool writing;     /* epoll waits until more can be sent */
};

struct run {
    const struct plan *plan;
    struct mix *mix;
    struct outcome *o;
    struct peer *peer; /* owns */
    uint64_t *since;   /* owns; of all peers */
    int epoll, timer;
    uint64_t start_ns, end_ns, step_ns; /* step: between the requests of one peer in open loop */
    uint64_t sent;
    bool failed;
};

uint64_t driver_now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

int driver_connect(unsigned port)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_port = htons((in_port_t)port)};
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    int on = 1, fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd < 0 || connect(fd, (struct sockaddr *)&at, sizeof at) != 0) {
        fprintf(stderr, "load: port %u: %s\n", port, strerror(errno));
        if (fd >= 0)
            close(fd);
        return -1;
    }
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return fd;
}

static void fail(struct run *r, const char *why)
{
    if (!r->failed)
        fprintf(stderr, "load: %s\n", why);
    r->failed = true;
}

/* ---- sending ---- */

static bool may_send(const struct run *r, uint64_t now)
{
    return r->sent < r->plan->count && now < r->end_ns;
}

static void append_request(struct run *r, struct peer *p, uint64_t since)
{
    char *to = buf_reserve(&p->out, MIX_REQUEST_LIMIT);
    if (to == NULL) {
        fail(r, "out of memory");
        return;
    }
    buf_commit(&p->out, mix_next(r->mix, to));
    p->since[(p->oldest + p->flying++) % r->plan->pipeline] = since;
    r->sent++;
}

/* Appends the requests that are due: in closed loop a whole batch once the last one is answered. */
static void produce(struct run *r, struct peer *p, uint64_t now)
{
    unsigned room = r->plan->pipeline - p->flying;
    if (r->step_ns == 0 && p->flying > 0)
        return;
    for (; room > 0 && may_send(r, now) && !r->failed; room--) {
        if (r->step_ns != 0 && p->next_ns > now)
            return;
        append_request(r, p, r->step_ns != 0 ? p->next_ns : now);
        p->next_ns += r->step_ns;
    }
}

static void want_writing(struct run *r, struct peer *p, bool writing)
{
    struct epoll_event e = {.events = EPOLLIN | (writing ? (uint32_t)EPOLLOUT : 0), .data.ptr = p};
    if (p->writing != writing)
        epoll_ctl(r->epoll, EPOLL_CTL_MOD, p->fd, &e);
    p->writing = writing;
}

static void push_out(struct run *r, struct peer *p)
{
    while (buf_len(&p->out) > 0) {
        ssize_t n = send(p->fd, buf_head(&p->out), buf_len(&p->out), MSG_NOSIGNAL);
        if (n < 0 && errno != EAGAIN)
            fail(r, strerror(errno));
        if (n < 0)
            break;
        buf_consume(&p->out, (size_t)n);
    }
    want_writing(r, p, buf_len(&p->out) > 0);
}

/* ---- receiving ---- */

static void count_reply(struct run *r, struct peer *p, uint64_t now)
{
    if (p->flying == 0) {
        fail(r, "a reply that nothing was asked for");
        return;
    }
    histogram_add(&r->o->latency, now - p->since[p->oldest], 1);
    p->oldest = (p->oldest + 1) % r->plan->pipeline;
    p->flying--;
    r->o->replies++;
}

static void read_ours(struct run *r, struct peer *p, uint64_t now)
{
    struct reply_part part;
    ptrdiff_t took;
    while ((took = reply_read(&p->reader, buf_head(&p->in), buf_len(&p->in), &part)) > 0) {
        buf_consume(&p->in, (size_t)took);
        r->o->errors += part.kind == REPLY_ERR;
        if (part.kind != REPLY_COMMENT && part.last)
            count_reply(r, p, now);
    }
    if (took < 0)
        fail(r, p->reader.fault);
}

static void read_lines(struct run *r, struct peer *p, uint64_t now)
{
    const char *end;
    while ((end = memchr(buf_head(&p->in), '\n', buf_len(&p->in))) != NULL) {
        char first = buf_head(&p->in)[0];
        buf_consume(&p->in, (size_t)(end + 1 - buf_head(&p->in)));
        p->lines++;
        r->o->errors += first == '-';
        if (p->lines == r->mix->lines || first == '-') {
            p->lines = 0;
            count_reply(r, p, now);
        }
        if (buf_len(&p->in) == 0)
            break;
    }
}

static void read_resp(struct run *r, struct peer *p, uint64_t now)
{
    bool error;
    ptrdiff_t took;
    while ((took = resp_reply(buf_head(&p->in), buf_len(&p->in), &error)) > 0) {
        buf_consume(&p->in, (size_t)took);
        r->o->errors += error;
        count_reply(r, p, now);
    }
    if (took < 0)
        fail(r, "not a reply in RESP");
}

static void pull_in(struct run *r, struct peer *p)
{
    char *to = buf_reserve(&p->in, READ_SIZE);
    ssize_t n = to != NULL ? recv(p->fd, to, READ_SIZE, 0) : 0;
    if (n < 0 && errno == EAGAIN)
        return;
    if (n <= 0) {
        fail(r, n == 0 ? "the server has closed a connection" : strerror(errno));
        return;
    }
    buf_commit(&p->in, (size_t)n);
    if (r->mix->resp)
        read_resp(r, p, driver_now_ns());
    else if (r->mix->lines > 0)
        read_lines(r, p, driver_now_ns());
    else
        read_ours(r, p, driver_now_ns());
}

/* ---- the run ---- */

static bool begin_peer(struct run *r, unsigned i)
{
    struct peer *p = &r->peer[i];
    struct epoll_event e = {.events = EPOLLIN, .data.ptr = p};
    p->fd = driver_connect(r->plan->port);
    p->since = &r->since[(size_t)i * r->plan->pipeline];
    return p->fd >= 0 && fcntl(p->fd, F_SETFL, O_NONBLOCK) == 0 &&
           epoll_ctl(r->epoll, EPOLL_CTL_ADD, p->fd, &e) == 0;
}

static bool begin(struct run *r)
{
    const struct plan *plan = r->plan;
    struct epoll_event e = {.events = EPOLLIN, .data.ptr = NULL};
    r->peer = calloc(plan->connections, sizeof *r->peer);
    r->since = calloc((size_t)plan->connections * plan->pipeline, sizeof *r->since);
    r->epoll = epoll_create1(EPOLL_CLOEXEC);
    r->timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
    if (r->peer == NULL || r->since == NULL || r->epoll < 0 || r->timer < 0 ||
        epoll_ctl(r->epoll, EPOLL_CTL_ADD, r->timer, &e) != 0)
        return false;
    for (unsigned i = 0; i < plan->connections; i++)
        r->peer[i].fd = -1;
    for (unsigned i = 0; i < plan->connections; i++)
        if (!begin_peer(r, i))
            return false;
    r->start_ns = driver_now_ns();
    r->end_ns = r->start_ns + (uint64_t)(plan->seconds * 1e9);
    if (plan->rate > 0)
        r->step_ns = (uint64_t)(1e9 * plan->connections / plan->rate);
    for (unsigned i = 0; i < plan->connections; i++)
        r->peer[i].next_ns = r->start_ns + r->step_ns * i / plan->connections;
    return true;
}

static void serve(struct run *r, struct peer *p)
{
    produce(r, p, driver_now_ns());
    push_out(r, p);
}

/* Open loop: sends all requests that are due and sets the timer for the next one. */
static void serve_due(struct run *r)
{
    uint64_t now = driver_now_ns(), next = UINT64_MAX;
    for (unsigned i = 0; i < r->plan->connections; i++) {
        struct peer *p = &r->peer[i];
        if (p->next_ns <= now && p->flying < r->plan->pipeline)
            serve(r, p);
        if (p->flying < r->plan->pipeline && p->next_ns < next)
            next = p->next_ns;
    }
    if (next == UINT64_MAX)
        return;
    struct itimerspec t = {.it_value = {(time_t)(next / 1000000000u), (long)(next % 1000000000u)}};
    timerfd_settime(r->timer, TFD_TIMER_ABSTIME, &t, NULL);
}

/* Closed loop: sends the requests that each connection may send now. */
static void serve_all(struct run *r)
{
    for (unsigned i = 0; i < r->plan->connections && !r->failed; i++)
        serve(r, &r->peer[i]);
}

static bool is_over(const struct run *r)
{
    return r->failed || (!may_send(r, driver_now_ns()) && r->o->replies == r->sent);
}

static void turn(struct run *r)
{
    struct epoll_event event[EVENTS];
    int n = epoll_wait(r->epoll, event, EVENTS, 100);
    for (int i = 0; i < n && !r->failed; i++) {
        struct peer *p = event[i].data.ptr;
        uint64_t ticks;
        if (p == NULL) {
            ssize_t ignored = read(r->timer, &ticks, sizeof ticks);
            (void)ignored;
            continue;
        }
        if ((event[i].events & ~(uint32_t)EPOLLOUT) != 0)
            pull_in(r, p);
        if (r->plan->together)
            push_out(r, p);
        else
            serve(r, p);
    }
    if (r->plan->together && r->o->replies == r->sent)
        serve_all(r);
    if (r->step_ns != 0)
        serve_due(r);
    if (driver_now_ns() > r->end_ns + (uint64_t)TAIL_MS * 1000000u)
        fail(r, "replies stay away");
}

static void end(struct run *r)
{
    for (unsigned i = 0; r->peer != NULL && i < r->plan->connections; i++) {
        if (r->peer[i].fd >= 0)
            close(r->peer[i].fd);
        buf_free(&r->peer[i].in);
        buf_free(&r->peer[i].out);
    }
    free(r->peer);
    free(r->since);
    close(r->epoll);
    close(r->timer);
}

bool driver_run(const struct plan *plan, struct mix *mix, struct outcome *o)
{
    struct run r = {.plan = plan, .mix = mix, .o = o};
    memset(o, 0, sizeof *o);
    if (!begin(&r))
        fail(&r, "cannot begin");
    if (r.step_ns == 0 && !r.failed)
        serve_all(&r);
    else if (!r.failed)
        serve_due(&r);
    while (!is_over(&r))
        turn(&r);
    o->seconds = (double)(driver_now_ns() - r.start_ns) * 1e-9;
    end(&r);
    return !r.failed;
}
