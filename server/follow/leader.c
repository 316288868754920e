/* leader.c - see leader.h. */
#include "server/follow/leader.h"

#include "server/jobs/durable.h"
#include "server/system/notice.h"

#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum { GRACE_MS = 1000 }; /* how long changes wait for --min-followers that are not there */

struct leader {
    struct source source; /* first: the eventfd of the threads */
    struct server *server;
    struct loop *loop;
    struct list followers;
    uint64_t durable;           /* what the threads know */
    unsigned least;             /* followers without which replies wait */
    struct request_queue queue; /* of WAIT */
    struct timer timer;         /* the next one of these that ends */
    int64_t timer_ms;           /* when; 0: none */
    /* since when there have been fewer than --min-followers; 0: there are enough */
    int64_t missing_ms;
};

/* ---- what waits for followers ---- */

unsigned leader_count(const struct server *s, uint64_t lsn)
{
    unsigned n = 0;
    if (s->leader == NULL)
        return 0;
    const struct list *all = &s->leader->followers;
    for (const struct sender *f = list_first(all); f != NULL; f = list_next(all, f))
        n += f->state == SENDER_LOG && f->acked >= lsn;
    return n;
}

/* Counts the followers that receive the log; *answer gets the number of those that have acknowledged something within
 * --follower-timeout. */
static unsigned count_connected(const struct leader *l, unsigned *answer)
{
    int64_t most = (int64_t)l->server->config->follower_timeout_s * 1000, now = clock_ms();
    const struct list *all = &l->followers;
    unsigned n = 0;
    *answer = 0;
    for (const struct sender *f = list_first(all); f != NULL; f = list_next(all, f)) {
        int64_t silent = f->silent_ms;
        bool connected = f->state == SENDER_LOG;
        n += connected;
        *answer += connected && (silent == 0 || now - silent < most);
    }
    return n;
}

/* The lsn that at least n followers have reached. Cost: quadratic in the followers, which are few. */
static uint64_t reached_by(const struct server *s, unsigned n)
{
    const struct list *all = &s->leader->followers;
    uint64_t best = 0;
    for (const struct sender *f = list_first(all); f != NULL; f = list_next(all, f)) {
        uint64_t lsn = f->acked;
        if (lsn > best && leader_count(s, lsn) >= n)
            best = lsn;
    }
    return best;
}

/* --min-followers; 0 for a daemon that does not lead. */
static unsigned least_followers(const struct server *s)
{
    return s->read_only.why != NULL ? 0 : s->config->min_followers;
}

/* Whether --min-followers have been missing for a while. */
static bool lacks(struct leader *l, unsigned least)
{
    unsigned answer, connected = count_connected(l, &answer);
    if (connected >= least)
        l->missing_ms = 0;
    else if (l->missing_ms == 0)
        l->missing_ms = clock_ms();
    return connected >= least ? answer < least : clock_ms() - l->missing_ms >= GRACE_MS;
}

/* Replies wait for --min-followers, unless these have been missing for a while. */
static void release(struct server *s)
{
    struct leader *l = s->leader;
    unsigned least = least_followers(s);
    /* It does not lead any more: the new leader may lack the changes that wait. */
    if (l->least > 0 && s->read_only.why != NULL)
        holders_fail(&s->held, HOLD_FOLLOWERS);
    l->least = least;
    if (least == 0)
        holders_follow_none(&s->held);
    else
        holders_follow(&s->held, reached_by(s, least));
    bool missing = lacks(l, least);
    if (missing && !s->without_followers)
        notice(NOTICE_WARNING,
               "fewer than %u followers are connected and answer: changes are refused", least);
    s->without_followers = missing;
    if (missing)
        holders_fail(&s->held, HOLD_FOLLOWERS);
    else
        holders_recover(&s->held, HOLD_FOLLOWERS);
}

static void on_timer(struct timer *t)
{
    struct leader *l = (struct leader *)((char *)t - offsetof(struct leader, timer));
    l->timer_ms = 0;
    queue_wake_all(&l->queue);
}

struct request_queue *leader_queue(struct server *s, int64_t at_ms)
{
    struct leader *l = s->leader;
    if (l->timer_ms == 0 || at_ms < l->timer_ms) {
        timer_clear(&l->timer);
        loop_at(l->loop, &l->timer, at_ms);
        l->timer_ms = at_ms;
    }
    return &l->queue;
}

/* ---- events of the threads ---- */

static void remove_ended(struct server *s)
{
    struct list *all = &s->leader->followers;
    for (struct sender *f = list_first(all), *next; f != NULL; f = next) {
        char peer[SOCK_PEER_TEXT];
        next = list_next(all, f);
        if (f->state != SENDER_ENDED)
            continue;
        sock_peer_text(&f->peer, peer);
        notice(NOTICE_INFO, "the follower %s is disconnected", peer);
        list_remove(&f->link);
        sender_end(f);
    }
}

/* Begins a snapshot if a follower waits for one. */
static void save_for_followers(struct server *s)
{
    const struct list *all = &s->leader->followers;
    const struct saver *v = durable_saver(s);
    uint64_t lsn;
    if (list_is_empty(all))
        return;
    for (struct sender *f = list_first(all); f != NULL; f = list_next(all, f)) {
        uint64_t wants = f->wants_snapshot;
        bool there = v->snapshots > 0 && v->snapshot_lsn + 1 >= wants;
        if (wants != 0 && !there && f->durable + 1 >= wants) {
            durable_begin_snapshot(s, &lsn); /* or one is being written already */
            return;
        }
    }
}

static void on_event(struct source *source, uint32_t events)
{
    struct leader *l = (struct leader *)source;
    eventfd_t count;
    eventfd_read(source->fd, &count);
    remove_ended(l->server);
    save_for_followers(l->server);
    release(l->server);
    queue_wake_all(&l->queue);
}

/* ---- the life of followers ---- */

bool leader_add(struct server *s, int fd, const struct sock_peer *peer, const struct position *from)
{
    struct leader *l = s->leader;
    struct sender *f = calloc(1, sizeof *f);
    if (f == NULL)
        return false;
    f->fd = fd;
    f->event = l->source.fd;
    f->dir = durable_dir(s);
    f->lineage = f->dir->lineage;
    f->from = *from;
    f->peer = *peer;
    f->memory = server_reservation(s, BUDGET_CLIENTS);
    f->since_ms = clock_ms();
    f->durable = durable_status(s)->durable; /* leader_turn_end tells the others */
    durable_keep_log(s);
    if (!sender_start(f)) {
        free(f);
        return false;
    }
    list_prepend(&l->followers, &f->link);
    char text[SOCK_PEER_TEXT];
    sock_peer_text(peer, text);
    notice(NOTICE_INFO, "the follower %s is connected", text);
    return true;
}

void leader_dismiss(struct server *s)
{
    for (struct sender *f; (f = list_pop(&s->leader->followers)) != NULL;)
        sender_end(f);
}

const struct sender *leader_next(const struct server *s, const struct sender *f)
{
    if (s->leader == NULL)
        return NULL;
    const struct list *all = &s->leader->followers;
    return f == NULL ? list_first(all) : list_next(all, f);
}

unsigned leader_followers(const struct server *s)
{
    unsigned n = 0;
    for (const struct sender *f = NULL; (f = leader_next(s, f)) != NULL;)
        n++;
    return n;
}

static void note_lag(struct leader *l, uint64_t last)
{
    const struct list *all = &l->followers;
    for (struct sender *f = list_first(all); f != NULL; f = list_next(all, f)) {
        if (f->acked >= last)
            f->behind_ms = 0;
        else if (f->behind_ms == 0)
            f->behind_ms = clock_ms();
    }
}

void leader_turn_end(struct server *s)
{
    struct leader *l = s->leader;
    const struct log_status *log = durable_status(s);
    if (l == NULL || log == NULL)
        return;
    const struct list *all = &l->followers;
    if (least_followers(s) != l->least)
        release(s);
    if (!list_is_empty(all))
        note_lag(l, log_last(durable_log(s)));
    if (log->durable == l->durable)
        return;
    l->durable = log->durable;
    for (struct sender *f = list_first(all); f != NULL; f = list_next(all, f))
        sender_advance(f, l->durable);
}

void leader_tick(struct server *s)
{
    if (s->leader == NULL)
        return;
    save_for_followers(s);
    release(s);
}

bool leader_start(struct server *s, struct loop *loop)
{
    struct leader *l = calloc(1, sizeof *l);
    int event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (l == NULL || event < 0) {
        notice_error("out of memory or descriptors");
        free(l);
        return false;
    }
    l->source = (struct source){.fd = event, .ready = on_event};
    l->server = s;
    l->loop = loop;
    l->timer.run = on_timer;
    s->leader = l;
    release(s);
    return loop_watch(loop, &l->source, EPOLLIN);
}

void leader_stop(struct server *s)
{
    struct leader *l = s->leader;
    if (l == NULL)
        return;
    leader_dismiss(s);
    timer_clear(&l->timer);
    close(l->source.fd);
    free(l);
    s->leader = NULL;
}
