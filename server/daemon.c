/* daemon.c - see daemon.h. */
#include "server/daemon.h"

#include "server/clients/clients.h"
#include "server/clients/reload.h"
#include "server/follow/apply.h"
#include "server/follow/follower.h"
#include "server/follow/leader.h"
#include "server/jobs/durable.h"
#include "server/jobs/expire.h"
#include "server/jobs/keep.h"
#include "server/jobs/server.h"
#include "server/jobs/upkeep.h"
#include "server/lifecycle.h"
#include "server/session/session.h"
#include "server/sets/valued.h"
#include "server/system/loop.h"
#include "server/system/notice.h"
#include "server/system/outlet.h"
#include "server/system/priority.h"
#include "server/system/private.h"
#include "server/system/sock.h"
#include "server/system/systemd.h"
#include "server/watch/watch.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <unistd.h>

enum {
    ACCEPTS_PER_TURN = 64,
    REFUSALS_PER_TURN = 8, /* connections that are accepted and closed */
    GRACE_MS = 30 * 1000,  /* for edits under way when the daemon is stopped */
    REPLY_GRACE_MS = 500,  /* for rows that are computed, and for clients that do not read, */
    BREAK_MS = 100,        /* which are looked for again and again */
    READY_MS = 100,        /* at the end, for a ready line that has not been written */
    ANNOUNCE_MS = 1000     /* the longest time that the ready line waits for sets to be read */
};

/* One daemon is one process; the callbacks below find it here. */
static struct {
    struct server server;
    struct loop *loop; /* borrows; of the first reactor */
    struct clients clients;
    struct source tcp, local, signals, workers, durable, owner;
    int handed;  /* a listening socket from the service manager; -1: none */
    int reserve; /* a spare descriptor, to accept and refuse a client when there are no others */
    bool paused; /* the listeners are not watched until the next tick, because accept would fail */
    struct notice_rarely refusals;
    unsigned evicted; /* clients that were closed to make room and are not freed yet */
    bool stopping;
    struct timer reply_grace;
    bool failed;    /* the data directory cannot be used */
    bool announced; /* the ready line has been printed */
    bool notified;  /* systemd knows that all sets can be used */
    int64_t stop_ms;
    unsigned port;
} d;

static struct outlet ready_line = OUTLET(STDOUT_FILENO);

/* ---- clients ---- */

static void watch_listeners(bool watch)
{
    uint32_t events = watch ? EPOLLIN : 0;
    d.paused = !watch;
    if (d.tcp.fd >= 0)
        loop_change(d.loop, &d.tcp, events);
    if (d.local.fd >= 0)
        loop_change(d.loop, &d.local, events);
}

static void refill_reserve(void)
{
    if (d.reserve < 0)
        d.reserve = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (d.reserve >= 0 && d.paused && !d.stopping)
        watch_listeners(true);
}

static void drop_temporary(struct task *task)
{
    if (expire_temporary(&d.server))
        loop_yield(d.loop, task);
}

static void on_client_closed(struct session *s)
{
    static struct task drops = {.run = drop_temporary};
    notice_client(s, NOTICE_DEBUG, "disconnected");
    clients_remove(&d.clients, s);
    s->reactor->sessions--;
    d.evicted -= s->evicted;
    if (!list_is_empty(&d.server.temporary))
        loop_yield(d.loop, &drops);
    refill_reserve();
    if (d.stopping && d.clients.n == 0)
        loop_stop(d.loop);
}

static void count_refusal(const char *why)
{
    uint64_t more;
    d.server.count.refused++;
    if (notice_rarely(&d.refusals, d.loop->now_ms, &more))
        notice(NOTICE_WARNING, "a client was refused: %s (%" PRIu64 " more since the last time)",
               why, more);
}

static void refuse(int fd, const char *line)
{
    char why[64];
    snprintf(why, sizeof why, "%.*s", (int)strcspn(line, "\n"), line);
    count_refusal(why);
    sock_refuse(fd, line);
}

/* Whether another client may connect. If there are too many, the oldest client without authentication is disconnected,
 * so that such clients cannot lock out others. */
static bool has_room(void)
{
    if (d.clients.n - d.evicted < d.server.config->max_clients)
        return true;
    struct session *s = clients_oldest_stranger(&d.clients);
    if (s == NULL)
        return false;
    count_refusal("too many clients; the oldest unauthenticated one was closed");
    d.evicted++;
    s->evicted = true;
    session_evict(s);
    return true;
}

/* The reactor with the fewest connections. */
static struct reactor *idlest(void)
{
    struct reactor *least = d.server.reactor;
    for (struct reactor *r = least + 1; r < d.server.reactor + d.server.reactors; r++)
        if (r->sessions < least->sessions)
            least = r;
    return least;
}

static void welcome(int fd, const struct sock_peer *peer)
{
    if (!has_room()) {
        refuse(fd, "ERR BUSY too many clients\n");
        return;
    }
    if (!budget_fits(&d.server.budget, BUDGET_CLIENTS, sizeof(struct session))) {
        refuse(fd, "ERR BUSY not enough memory for another client\n");
        return;
    }
    struct reactor *r = idlest();
    struct session *s = session_new(&d.server, r, fd, peer, on_client_closed);
    if (s == NULL) {
        refuse(fd, "ERR NOMEM out of memory\n");
    } else if (!clients_add(&d.clients, s)) {
        s->closed = NULL;
        conn_close(&s->conn);
    } else {
        d.server.count.connections++;
        r->sessions++;
        notice_client(s, NOTICE_DEBUG, "connected");
    }
}

/* There are no descriptors: uses the spare one to accept one client and refuse it. Clients in the backlog would
 * keep the listener readable and the loop busy. Returns 0, or the errno of accept. */
static int refuse_one(int listener)
{
    struct sock_peer peer;
    if (d.reserve >= 0)
        close(d.reserve);
    d.reserve = -1;
    int fd = sock_accept(listener, &peer);
    int error = fd < 0 ? errno : 0;
    if (fd >= 0)
        refuse(fd, "ERR BUSY too many open files\n");
    refill_reserve();
    return d.reserve < 0 ? EMFILE : error;
}

/* Accepting failed. False: nothing more can be accepted in this turn. */
static bool after_failure(int listener, int error)
{
    if (error == EMFILE || error == ENFILE)
        error = refuse_one(listener);
    if (error == EAGAIN)
        return false;
    if (error != EMFILE && error != ENFILE && error != ENOMEM && error != ENOBUFS)
        return true; /* no error, or one of the connection (accept(2)) */
    /* The connection stays in the backlog, and the listener stays readable. */
    watch_listeners(false);
    return false;
}

static void on_listener(struct source *listener, uint32_t events)
{
    uint64_t most = d.server.count.refused + REFUSALS_PER_TURN;
    (void)events;
    for (int i = 0; i < ACCEPTS_PER_TURN && d.server.count.refused < most; i++) {
        struct sock_peer peer;
        int fd = sock_accept(listener->fd, &peer);
        if (fd >= 0)
            welcome(fd, &peer);
        else if (!after_failure(listener->fd, errno))
            return;
    }
}

/* ---- workers ---- */

static void deliver(void *ctx, struct job *j)
{
    struct session *s = clients_find(&d.clients, j->owner);
    (void)ctx;
    if (j->owner == APPLY_OWNER)
        follower_job_done(&d.server, j);
    else if (s != NULL)
        session_job_done(s, j);
    else
        server_finish_abandoned(&d.server, j);
}

static void on_workers(struct source *source, uint32_t events)
{
    (void)source, (void)events;
    server_collect(&d.server, deliver, NULL);
}

/* ---- durability ---- */

/* Prints the ready line when all sets have been read and triangulated, or after ANNOUNCE_MS: then clients may get
 * ERR LOADING. */
static void announce_if_ready(void)
{
    const struct config *config = d.server.config;
    bool v6 = strchr(config->bind_address, ':') != NULL;
    if (d.announced ||
        (!durable_is_complete(&d.server) && clock_ms() - d.server.started_ms < ANNOUNCE_MS))
        return;
    d.announced = true;
    char line[OUTLET_LINE];
    int n = config->private ? snprintf(line, sizeof line, "ready on %s\n", config->unix_path)
                            : snprintf(line, sizeof line, "ready on %s%s%s:%u\n", v6 ? "[" : "",
                                       config->bind_address, v6 ? "]" : "", d.port);
    outlet_put(&ready_line, line, (size_t)n, 1);
    notice(NOTICE_DEBUG, "ready, with %zu sets", d.server.sets.sets);
}

/* systemd starts what needs this daemon when all sets can be used, however long that takes. */
static void notify_systemd(void)
{
    if (d.notified)
        return;
    d.notified = durable_is_complete(&d.server);
    systemd_notify(d.notified ? "READY=1"
                              : "EXTEND_TIMEOUT_USEC=30000000\nSTATUS=reading the data directory");
}

static void on_durable(struct source *source, uint32_t events)
{
    (void)source, (void)events;
    if (!upkeep_on_durable_event(&d.server)) {
        d.failed = true;
        loop_stop(d.loop);
        return;
    }
    if (durable_is_complete(&d.server))
        follower_begin(&d.server);
    announce_if_ready();
    if (durable_is_complete(&d.server))
        notify_systemd();
}

static void on_turn_end(struct loop *loop)
{
    (void)loop;
    watch_turn_end(&d.server);
    durable_turn_end(&d.server);
    leader_turn_end(&d.server);
    follower_turn_end(&d.server);
    keep_turn_end(&d.server);
}

/* ---- stopping ---- */

static void close_listeners(void)
{
    struct source *listener[] = {&d.tcp, &d.local};
    for (int i = 0; i < 2; i++) {
        if (listener[i]->fd >= 0) {
            loop_forget(d.loop, listener[i]);
            close(listener[i]->fd);
            listener[i]->fd = -1;
        }
    }
    if (d.server.config->unix_path != NULL)
        unlink(d.server.config->unix_path);
    if (d.server.config->private && d.server.config->unix_path != NULL)
        private_remove(d.server.config->unix_path);
}

static void break_off(struct session *s)
{
    session_break_off(s, REPLY_GRACE_MS);
}

static void on_reply_grace(struct timer *t)
{
    clients_each(&d.clients, break_off);
    loop_at(d.loop, t, d.loop->now_ms + BREAK_MS);
}

static void drain_client(struct session *s)
{
    conn_drain(&s->conn);
}

static void stop(void)
{
    if (!d.stopping) {
        notice(NOTICE_DEBUG, "stopping, with %u clients", d.clients.n);
        systemd_notify("STOPPING=1");
    }
    if (d.stopping || d.clients.n == 0) {
        loop_stop(d.loop); /* the second signal, or there are no clients */
        return;
    }
    d.stopping = true;
    d.stop_ms = d.loop->awake_ms;
    close_listeners();
    server_drain(&d.server);
    clients_each(&d.clients, drain_client);
    d.reply_grace.run = on_reply_grace;
    loop_at(d.loop, &d.reply_grace, d.loop->now_ms + REPLY_GRACE_MS);
}

static void on_signal(struct source *source, uint32_t events)
{
    struct signalfd_siginfo info;
    (void)events;
    while (read(source->fd, &info, sizeof info) == (ssize_t)sizeof info) {
        if (info.ssi_signo == SIGHUP)
            reload_tokens(&d.server, 0);
        else if (info.ssi_signo != SIGINT || !d.server.config->private) /* which is for the owner */
            stop();
    }
}

/* The owner of a private daemon has ended: the daemon stops. */
static void on_owner(struct source *source, uint32_t events)
{
    (void)events;
    if (private_owner_is_gone(source->fd))
        loop_stop(d.loop);
}

/* ---- once a second ---- */

static void check_client(struct session *s)
{
    session_check_timeouts(s);
}

static void send_progress(void)
{
    for (const struct job *j = job_first(&d.server), *next; j != NULL; j = next) {
        next = job_next(&d.server, j);
        struct session *s = clients_find(&d.clients, j->owner);
        if (d.loop->now_ms - j->queued_ns / 1000000 <= SESSION_PROGRESS_MS)
            continue;
        if (s != NULL)
            session_progress(s, j);
        session_progress_waiting(j);
    }
}

static void on_tick(struct loop *loop)
{
    clients_each(&d.clients, check_client);
    send_progress();
    notice_tick();
    durable_tick(&d.server);
    leader_tick(&d.server);
    follower_tick(&d.server);
    keep_tick(&d.server);
    registry_tidy(&d.server.sets);
    valued_tidy(&d.server.sets);
    expire_tick(&d.server);
    announce_if_ready();
    notify_systemd();
    refill_reserve();
    if (d.stopping && loop->awake_ms - d.stop_ms > GRACE_MS)
        loop_stop(loop);
}

/* ---- life ---- */

/* The signals for the daemon become events. Blocked before any thread starts, so that all
 * inherit it. */
static int take_signals(void)
{
    sigset_t set;
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN); /* a file that must not grow is an error of write */
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    signal(SIGHUP, SIG_DFL); /* a shell may have set it to be ignored */
    sigaddset(&set, SIGHUP);
    sigprocmask(SIG_BLOCK, &set, NULL);
    return signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
}

static bool watch(struct source *source, int fd, void (*ready)(struct source *, uint32_t))
{
    *source = (struct source){.fd = fd, .ready = ready};
    return fd >= 0 && loop_watch(d.loop, source, EPOLLIN);
}

/* The socket comes from a service manager; the rules of --bind apply to it. */
static bool listen_to_handed(const struct config *config)
{
    if (!sock_is_local(d.handed) && config->auth_file == NULL && !config->insecure)
        return notice_error(
            "the socket of the service manager is not local: this needs --auth-file or "
            "--insecure");
    d.port = sock_port(d.handed);
    sock_prepare(d.handed);
    return watch(&d.tcp, d.handed, on_listener) &&
           (config->unix_path == NULL ||
            watch(&d.local, sock_listen_unix(config->unix_path), on_listener));
}

static bool listen_to_owner(struct config *config)
{
    static char path[PRIVATE_PATH];
    if (!watch(&d.owner, STDIN_FILENO, on_owner))
        return notice_error("--private needs a pipe from its owner as standard input");
    if (!private_make(path))
        return false;
    config->unix_path = path;
    if (watch(&d.local, sock_listen_unix(path), on_listener))
        return true;
    close_listeners();
    return false;
}

static bool listen_to_all(struct config *config)
{
    d.port = config->port;
    d.tcp.fd = d.local.fd = -1;
    if (config->private)
        return listen_to_owner(config);
    if (d.handed >= 0)
        return listen_to_handed(config);
    if (!watch(&d.tcp, sock_listen(config->bind_address, &d.port), on_listener))
        return false;
    return config->unix_path == NULL ||
           watch(&d.local, sock_listen_unix(config->unix_path), on_listener);
}

static bool start(struct config *config)
{
    int signals = take_signals();
    d.reserve = -1;
    notice_set_level(config->log_level);
    if (systemd_sockets(&d.handed, 1) == 0)
        d.handed = -1;
    if (!server_init(&d.server, config))
        return false;
    d.loop = &d.server.reactor->loop;
    d.loop->tick = on_tick;
    for (unsigned i = 0; i < d.server.reactors; i++)
        d.server.reactor[i].loop.turn_end = on_turn_end;
    if (!watch(&d.signals, signals, on_signal) ||
        !watch(&d.workers, workers_event(d.server.workers), on_workers))
        return notice_error("%s", strerror(errno));
    d.server.clients = &d.clients;
    d.server.held.released = session_released;
    d.server.held.not_saved = session_not_saved;
    if (!follower_prepare(&d.server, d.loop))
        return false;
    if (config->data != NULL && (!leader_start(&d.server, d.loop) || !durable_start(&d.server) ||
                                 !watch(&d.durable, durable_event(&d.server), on_durable)))
        return false;
    refill_reserve();
    return listen_to_all(config);
}

static void close_client(struct session *s)
{
    conn_close(&s->conn);
}

/* ---- the reactors ---- */

static void *run_reactor(void *arg)
{
    struct reactor *r = arg;
    priority_prompt();
    loop_run(&r->loop);
    loop_leave(&r->loop);
    return NULL;
}

/* Begins the threads of all reactors but the first, which wait until the first one is no longer alone. */
static bool begin_reactors(void)
{
    for (unsigned i = 1; i < d.server.reactors; i++) {
        struct reactor *r = &d.server.reactor[i];
        int error = pthread_create(&r->thread, NULL, run_reactor, r);
        if (error != 0)
            return notice_error("cannot start a thread: %s", strerror(error));
    }
    return true;
}

/* Afterwards there is only this thread. */
static void end_reactors(void)
{
    loop_enter(d.loop);
    loop_alone(d.loop);
    for (unsigned i = 1; i < d.server.reactors; i++)
        loop_stop(&d.server.reactor[i].loop);
    loop_leave(d.loop);
    for (unsigned i = 1; i < d.server.reactors; i++)
        pthread_join(d.server.reactor[i].thread, NULL);
    loop_enter(d.loop);
    loop_alone(d.loop);
}

int daemon_run(struct config *config)
{
    if (!start(config) || !begin_reactors())
        return 1;
    priority_prompt(); /* not before the other threads have started, which would inherit it */
    announce_if_ready();
    notify_systemd();
    loop_run(d.loop);
    end_reactors();
    close_listeners();
    clients_each(&d.clients, close_client);
    for (unsigned i = 0; i < d.server.reactors; i++)
        loop_clear(&d.server.reactor[i].loop);
    server_clear(&d.server);
    clients_clear(&d.clients);
    outlet_flush(&ready_line, READY_MS);
    return d.failed;
}
