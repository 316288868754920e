/* listeners.c - see listeners.h. */
#include "server/listeners.h"

#include "server/clients/clients.h"
#include "server/jobs/expire.h"
#include "server/session/session.h"
#include "server/system/loop.h"
#include "server/system/notice.h"
#include "server/system/private.h"
#include "server/system/sock.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

enum {
    ACCEPTS_PER_TURN = 64,
    REFUSALS_PER_TURN = 8 /* connections that are accepted and closed */
};

/* One daemon is one process; the callbacks below find them here. */
static struct {
    struct server *server; /* borrows */
    struct loop *loop;     /* borrows; of the first reactor */
    struct source tcp, local;
    int reserve; /* a spare descriptor, to accept and refuse a client when there are no others */
    bool paused; /* nothing is accepted until the next tick, because accept would fail */
    bool ended;
    struct notice_rarely refusals;
    unsigned evicted; /* clients that were closed to make room and are not freed yet */
} l = {.tcp.fd = -1, .local.fd = -1, .reserve = -1};

/* ---- watching ---- */

static void watch_listeners(bool watch)
{
    uint32_t events = watch ? EPOLLIN : 0;
    l.paused = !watch;
    if (l.tcp.fd >= 0)
        loop_change(l.loop, &l.tcp, events);
    if (l.local.fd >= 0)
        loop_change(l.loop, &l.local, events);
}

void listeners_refill(void)
{
    if (l.reserve < 0)
        l.reserve = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (l.reserve >= 0 && l.paused && !l.ended)
        watch_listeners(true);
}

/* ---- accepting ---- */

static void drop_temporary(struct task *task)
{
    if (expire_temporary(l.server))
        loop_yield(l.loop, task);
}

static void on_client_closed(struct session *s)
{
    static struct task drops = {.run = drop_temporary};
    notice_client(s, NOTICE_DEBUG, "disconnected");
    clients_remove(l.server->clients, s);
    s->reactor->sessions--;
    l.evicted -= s->evicted;
    if (!list_is_empty(&l.server->temporary))
        loop_yield(l.loop, &drops);
    listeners_refill();
    if (l.ended && l.server->clients->n == 0)
        loop_stop(l.loop);
}

static void count_refusal(const char *why)
{
    uint64_t more;
    l.server->count.refused++;
    if (notice_rarely(&l.refusals, l.loop->now_ms, &more))
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
    if (l.server->clients->n - l.evicted < l.server->config->max_clients)
        return true;
    struct session *s = clients_oldest_stranger(l.server->clients);
    if (s == NULL)
        return false;
    count_refusal("too many clients; the oldest unauthenticated one was closed");
    l.evicted++;
    s->evicted = true;
    session_evict(s);
    return true;
}

/* The reactor with the fewest connections. */
static struct reactor *idlest(void)
{
    struct reactor *least = l.server->reactor;
    for (struct reactor *r = least + 1; r < l.server->reactor + l.server->reactors; r++)
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
    if (!budget_fits(&l.server->budget, BUDGET_CLIENTS, sizeof(struct session))) {
        refuse(fd, "ERR BUSY not enough memory for another client\n");
        return;
    }
    struct reactor *r = idlest();
    struct session *s = session_new(l.server, r, fd, peer, on_client_closed);
    if (s == NULL) {
        refuse(fd, "ERR NOMEM out of memory\n");
    } else if (!clients_add(l.server->clients, s)) {
        s->closed = NULL;
        conn_close(&s->conn);
    } else {
        l.server->count.connections++;
        r->sessions++;
        notice_client(s, NOTICE_DEBUG, "connected");
    }
}

/* There are no descriptors: uses the spare one to accept one client and refuse it. Clients in the backlog would
 * keep the listener readable and the loop busy. Returns 0, or the errno of accept. */
static int refuse_one(int listener)
{
    struct sock_peer peer;
    if (l.reserve >= 0)
        close(l.reserve);
    l.reserve = -1;
    int fd = sock_accept(listener, &peer);
    int error = fd < 0 ? errno : 0;
    if (fd >= 0)
        refuse(fd, "ERR BUSY too many open files\n");
    listeners_refill();
    return l.reserve < 0 ? EMFILE : error;
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
    uint64_t most = l.server->count.refused + REFUSALS_PER_TURN;
    for (int i = 0; i < ACCEPTS_PER_TURN && l.server->count.refused < most; i++) {
        struct sock_peer peer;
        int fd = sock_accept(listener->fd, &peer);
        if (fd >= 0)
            welcome(fd, &peer);
        else if (!after_failure(listener->fd, errno))
            return;
    }
}

/* ---- beginning and end ---- */

void listeners_close(void)
{
    l.ended = true;
    struct source *listener[] = {&l.tcp, &l.local};
    for (int i = 0; i < 2; i++) {
        if (listener[i]->fd >= 0) {
            loop_forget(l.loop, listener[i]);
            close(listener[i]->fd);
            listener[i]->fd = -1;
        }
    }
    if (l.server->config->unix_path != NULL)
        unlink(l.server->config->unix_path);
    if (l.server->config->private && l.server->config->unix_path != NULL)
        private_remove(l.server->config->unix_path);
}

static bool watch(struct source *source, int fd)
{
    *source = (struct source){.fd = fd, .ready = on_listener};
    return fd >= 0 && loop_watch(l.loop, source, EPOLLIN);
}

static bool listen_at_path(const char *path)
{
    return path == NULL || watch(&l.local, sock_listen_unix(path));
}

/* The socket comes from a service manager; the rules of --bind apply to it. */
static bool listen_to_handed(const struct config *config, int handed, unsigned *port)
{
    if (!sock_is_local(handed) && config->auth_file == NULL && !config->insecure)
        return notice_error(
            "the socket of the service manager is not local: this needs --auth-file or "
            "--insecure");
    *port = sock_port(handed);
    sock_prepare(handed);
    return watch(&l.tcp, handed) && listen_at_path(config->unix_path);
}

static bool listen_to_owner(struct config *config)
{
    static char path[PRIVATE_PATH];
    if (!private_make(path))
        return false;
    config->unix_path = path;
    if (listen_at_path(path))
        return true;
    listeners_close();
    return false;
}

bool listeners_begin(struct server *s, int handed, unsigned *port)
{
    struct config *config = s->config;
    l.server = s;
    l.loop = &s->reactor->loop;
    listeners_refill();
    *port = config->port;
    if (config->private)
        return listen_to_owner(config);
    if (handed >= 0)
        return listen_to_handed(config, handed, port);
    return watch(&l.tcp, sock_listen(config->bind_address, port)) &&
           listen_at_path(config->unix_path);
}
