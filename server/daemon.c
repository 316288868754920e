/* daemon.c - see daemon.h. */
#include "server/daemon.h"

#include "server/clients/clients.h"
#include "server/clients/reload.h"
#include "server/follow/apply.h"
#include "server/follow/follower.h"
#include "server/follow/leader.h"
#include "server/jobs/durable.h"
#include "server/jobs/expire.h"
#include "server/jobs/page_cache.h"
#include "server/jobs/restart.h"
#include "server/jobs/server.h"
#include "server/lifecycle.h"
#include "server/listeners.h"
#include "server/session/session.h"
#include "server/sets/skip_copy.h"
#include "server/system/loop.h"
#include "server/system/notice.h"
#include "server/system/outlet.h"
#include "server/system/priority.h"
#include "server/system/private.h"
#include "server/system/systemd.h"
#include "server/watch/watch.h"

#include <errno.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <unistd.h>

enum {
    GRACE_MS = 30 * 1000, /* for edits under way when the daemon is stopped */
    REPLY_GRACE_MS = 500, /* for rows that are computed, and for clients that do not read, */
    BREAK_MS = 100,       /* which are looked for again and again */
    READY_MS = 100,       /* at the end, for a ready line that has not been written */
    ANNOUNCE_MS = 1000    /* the longest time that the ready line waits for sets to be read */
};

/* One daemon is one process; the callbacks below find it here. */
static struct {
    struct server server;
    struct loop *loop; /* borrows; of the first reactor */
    struct clients clients;
    struct source signals, workers, durable, owner;
    bool stopping;
    struct timer reply_grace;
    bool failed;    /* the data directory cannot be used */
    bool announced; /* the ready line has been printed */
    bool notified;  /* systemd knows that all sets can be used */
    int64_t stop_ms;
    unsigned port;
} d;

static struct outlet ready_line = OUTLET(STDOUT_FILENO);

/* ---- workers ---- */

static void deliver(void *ctx, struct job *j)
{
    struct session *s = clients_find(&d.clients, j->owner);
    if (j->owner == APPLY_OWNER)
        follower_job_done(&d.server, j);
    else if (s != NULL)
        session_job_done(s, j);
    else
        server_finish_abandoned(&d.server, j);
}

static void on_workers(struct source *source, uint32_t events)
{
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
    if (!restart_on_durable_event(&d.server)) {
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
    watch_turn_end(&d.server);
    durable_turn_end(&d.server);
    leader_turn_end(&d.server);
    follower_turn_end(&d.server);
    page_cache_turn_end(&d.server);
}

/* ---- stopping ---- */

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
    listeners_close();
    server_drain(&d.server);
    clients_each(&d.clients, drain_client);
    d.reply_grace.run = on_reply_grace;
    loop_at(d.loop, &d.reply_grace, d.loop->now_ms + REPLY_GRACE_MS);
}

static void on_signal(struct source *source, uint32_t events)
{
    struct signalfd_siginfo info;
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
    if (private_owner_is_gone(source->fd))
        loop_stop(d.loop);
}

/* ---- once a second ---- */

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
    clients_each(&d.clients, session_check_timeouts);
    send_progress();
    notice_tick();
    durable_tick(&d.server);
    leader_tick(&d.server);
    follower_tick(&d.server);
    page_cache_tick(&d.server);
    registry_tidy(&d.server.sets);
    skip_copy_tidy(&d.server.sets);
    expire_tick(&d.server);
    announce_if_ready();
    notify_systemd();
    listeners_refill();
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

static bool start(struct config *config)
{
    int signals = take_signals(), handed;
    notice_set_level(config->log_level);
    if (systemd_sockets(&handed, 1) == 0)
        handed = -1;
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
    if (config->private && !watch(&d.owner, STDIN_FILENO, on_owner))
        return notice_error("--private needs a pipe from its owner as standard input");
    return listeners_begin(&d.server, handed, &d.port);
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
    listeners_close();
    clients_each(&d.clients, close_client);
    for (unsigned i = 0; i < d.server.reactors; i++)
        loop_clear(&d.server.reactor[i].loop);
    server_clear(&d.server);
    clients_clear(&d.clients);
    outlet_flush(&ready_line, READY_MS);
    return d.failed;
}
