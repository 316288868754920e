/* follower.c - see follower.h. */
#include "server/follow/follower.h"

#include "server/disk/aside.h"
#include "server/follow/apply.h"
#include "server/follow/leader.h"
#include "server/follow/role.h"
#include "server/jobs/durable.h"
#include "server/jobs/job.h"
#include "server/system/notice.h"
#include "server/system/random.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum { TURN_NS = 400 * 1000, RECORDS_PER_LOOK = 16 };

struct follower {
    struct source source; /* first: the eventfd of the link */
    struct task task;     /* to continue after other tasks */
    struct server *server;
    struct loop *loop;
    struct link *link; /* NULL: it is fenced, or has been promoted */
    struct apply apply;
    bool following; /* records are carried out */
    bool busy;      /* a record waits, or a worker has it */
    bool fenced;
    bool confirmed;
    struct history newer; /* fenced: by this one */
    char why[160];        /* why changes are refused */
    char host[ROLE_ADDRESS];
    unsigned port;
    struct link_piece *piece; /* that is being carried out, */
    size_t at;                /* from here on */
    uint64_t lsn;             /* of the last record that has been carried out or collected */
    uint64_t digest;          /* up to there; 0: it cannot be continued */
    uint64_t whole_digest;    /* without an incomplete LOAD: of what is in the log */
    size_t record;            /* length of the record that a worker has */
    uint64_t claimed, claim;  /* the lsn of a header, and its digest */
    uint64_t done,
        done_bytes; /* the last piece's end: its lsn, and the bytes of the stream up to there */
    uint64_t acked, acked_bytes; /* what was passed to the link */
};

static void run(struct follower *f);

/* ---- the role ---- */

static void refuse_changes(struct follower *f)
{
    struct server *s = f->server;
    char history[HISTORY_TEXT];
    history_write(history, &f->newer);
    if (f->fenced)
        snprintf(
            f->why, sizeof f->why,
            "there is a newer history %s: FOLLOW its leader, or FOLLOW NONE to go on without it",
            history);
    else
        snprintf(f->why, sizeof f->why, "leader=%s:%u", f->host, f->port);
    s->read_only.code = ERR_READONLY;
    s->read_only.why = f->why;
    s->follows = !f->fenced;
}

bool follower_prepare(struct server *s, struct loop *loop)
{
    struct follower *f = calloc(1, sizeof *f);
    const struct config *c = s->config;
    if (f == NULL) {
        notice(NOTICE_ERROR, "out of memory");
        return false;
    }
    s->follower = f;
    f->server = s;
    f->loop = loop;
    f->source.fd = -1;
    if (c->follow != NULL && c->data == NULL) {
        notice(NOTICE_ERROR, "--follow needs --data");
        return false;
    }
    if (c->data != NULL) {
        struct remembered_role role = role_read(c->data);
        memcpy(f->host, role.host, sizeof f->host);
        f->port = role.port;
        f->fenced = role.fenced;
        f->newer = role.newer;
    }
    if (c->follow != NULL && !role_read_address(c->follow, f->host, &f->port)) {
        notice(NOTICE_ERROR, "--follow %s: not ADDR:PORT", c->follow);
        return false;
    }
    if (c->follow != NULL)
        f->fenced = false;
    if (f->fenced || f->port != 0)
        refuse_changes(f);
    return true;
}

/* ---- the link ---- */

static void on_event(struct source *source, uint32_t events)
{
    struct follower *f = (struct follower *)source;
    eventfd_t count;
    (void)events;
    eventfd_read(source->fd, &count);
    run(f);
}

static void on_task(struct task *t)
{
    run((struct follower *)((char *)t - offsetof(struct follower, task)));
}

/* The waiting record can be tried again, or its worker is done. */
static void resume(struct apply *p)
{
    struct follower *f = (struct follower *)((char *)p - offsetof(struct follower, apply));
    f->busy = false;
    loop_defer(f->loop, &f->task);
}

static const char *start_link(struct follower *f, bool announce)
{
    struct server *s = f->server;
    struct link *l = calloc(1, sizeof *l);
    if (l == NULL)
        return "out of memory";
    if (!link_read_token(s->config->follow_token_file, l->token)) {
        free(l);
        return "the file of --follow-token-file cannot be read";
    }
    snprintf(l->host, sizeof l->host, "%s", f->host);
    l->port = f->port;
    l->confirmed = f->confirmed;
    l->announce = announce;
    l->from.history = durable_dir(s)->lineage.history;
    l->dir = durable_dir(s);
    l->pages = s->pages;
    l->event = f->source.fd;
    if (!link_start(l)) {
        free(l);
        return strerror(errno);
    }
    f->link = l;
    return NULL;
}

static void end_link(struct follower *f)
{
    if (f->link != NULL)
        link_end(f->link);
    f->link = NULL;
    link_piece_free(f->piece);
    f->piece = NULL;
    f->at = 0;
}

/* Begins to follow; the log is at a position of its own. */
static const char *begin(struct follower *f)
{
    struct server *s = f->server;
    const struct log_status *log = durable_status(s);
    f->lsn = log_last(durable_log(s));
    f->digest = log->durable == f->lsn && !durable_has_gap(s) ? log->digest : 0;
    f->whole_digest = f->digest;
    f->claimed = f->done = f->done_bytes = f->acked = f->acked_bytes = 0;
    f->following = true;
    durable_set_digest(s, &f->whole_digest);
    durable_close_mark(s, false);
    durable_keep_log(s,
                     s->config->keep_log); /* others may follow this daemon after its promotion */
    return start_link(f, false);
}

void follower_begin(struct server *s)
{
    struct follower *f = s->follower;
    if (f == NULL || durable_dir(s) == NULL || f->source.fd >= 0)
        return;
    f->source = (struct source){eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), on_event};
    f->task.run = on_task;
    apply_init(&f->apply, s, resume);
    if (f->source.fd < 0 || !loop_watch(f->loop, &f->source, EPOLLIN)) {
        notice(NOTICE_ERROR, "cannot follow: %s", strerror(errno));
        return;
    }
    if (!s->follows)
        return;
    char line[128];
    snprintf(line, sizeof line, "follow %s %u\n", f->host, f->port);
    struct remembered_role known = role_read(s->config->data);
    if ((known.port != f->port || strcmp(known.host, f->host) != 0) &&
        !role_write(durable_dir(s), line)) /* a full disk does not keep it from following */
        notice(NOTICE_WARNING, "the leader cannot be remembered: %s", strerror(errno));
    const char *why = begin(f);
    if (why != NULL)
        notice(NOTICE_ERROR, "cannot follow %s:%u: %s", f->host, f->port, why);
}

void follower_stop(struct server *s)
{
    struct follower *f = s->follower;
    if (f == NULL)
        return;
    end_link(f);
    if (f->source.fd >= 0) {
        apply_clear(&f->apply);
        close(f->source.fd);
    }
    free(f);
    s->follower = NULL;
}

/* ---- records ---- */

/* Everything that has been received and not carried out is dropped; it is asked for again. */
static void start_again(struct follower *f, const char *why)
{
    link_again(f->link, why);
    while (f->piece != NULL) {
        link_piece_free(f->piece);
        f->piece = link_take(f->link);
    }
    f->at = 0;
    apply_clear(&f->apply);
    apply_init(&f->apply, f->server, resume);
    f->lsn = log_last(durable_log(f->server));
    f->digest = f->whole_digest;
}

/* The sets here are not those of the leader: only a snapshot helps. */
static void give_up(struct follower *f, const char *why)
{
    char text[LINK_WHY];
    snprintf(text, sizeof text, "change %" PRIu64 " cannot be carried out: %.120s", f->lsn + 1,
             why);
    f->whole_digest = 0;
    start_again(f, text);
}

/* Compares the digest of a header with that of the log here, when that is durable. */
static void check_claim(struct follower *f)
{
    const struct log_status *log = durable_status(f->server);
    if (f->busy || f->claimed == 0 || log == NULL || log->durable < f->claimed)
        return;
    bool differs = log->durable == f->claimed && log->digest != f->claim;
    f->claimed = 0;
    if (differs)
        give_up(f, "the log here differs from that of the leader");
}

static bool take_header(struct follower *f, const struct segment *h)
{
    struct server *s = f->server;
    struct datadir *dir = durable_dir(s);
    if (h->lsn != f->lsn + 1 || h->digest != f->digest) {
        give_up(f, "the leader's digest of the changes before it is another one");
        return false;
    }
    if (apply_in_load(&f->apply))
        return true;
    if (history_relation(&h->history, &dir->lineage.history) != HISTORY_SAME ||
        h->life != dir->lineage.life) {
        struct lineage l = {h->life, h->history};
        durable_set_lineage(s, &l);
    }
    f->claimed = f->lsn;
    f->claim = h->digest;
    return true;
}

/* The record has been carried out. */
static bool end_record(struct follower *f, size_t n)
{
    const char *bytes = buf_head(&f->piece->bytes) + f->at;
    f->digest = record_digest(f->digest, bytes, n);
    f->at += n;
    f->lsn++;
    if (apply_in_load(&f->apply))
        return true;
    f->whole_digest = f->digest;
    if (log_last(durable_log(f->server)) == f->lsn)
        return true;
    f->lsn--;
    give_up(f, "it makes other records here");
    return false;
}

/* What has come of a record of n bytes. False: nothing more can be carried out now. */
static bool settle(struct follower *f, enum applied how, size_t n)
{
    switch (how) {
    case APPLY_DONE:
        return end_record(f, n);
    case APPLY_WAIT:
        f->busy = true;
        return false;
    case APPLY_JOB:
        f->busy = true;
        f->record = n;
        return false;
    case APPLY_LATER:
        start_again(f, f->apply.why);
        return false;
    case APPLY_FAILED:
        break;
    }
    give_up(f, f->apply.why);
    return false;
}

void follower_job_done(struct server *s, struct job *j)
{
    apply_job_done(&s->follower->apply, j);
}

/* Carries out what comes next in the piece. False: nothing more can be carried out now. */
static bool step(struct follower *f)
{
    const char *bytes = buf_head(&f->piece->bytes) + f->at;
    size_t left = buf_len(&f->piece->bytes) - f->at;
    struct segment h;
    struct record r;
    if (f->record > 0) { /* a worker had it */
        size_t n = f->record;
        f->record = 0;
        return settle(f, apply_result(&f->apply), n);
    }
    if (memcmp(bytes, "DELAUNAY", 8) == 0) {
        if (segment_read(bytes, left, &h) <= 0 || !take_header(f, &h))
            return false;
        f->at += SEGMENT_HEADER;
        return true;
    }
    ptrdiff_t n = record_read(bytes, left, &r);
    if (n <= 0 || r.lsn != f->lsn + 1) {
        give_up(f, n <= 0 ? "it is damaged" : "its number is not the next one");
        return false;
    }
    return settle(f, apply_record(&f->apply, &r, bytes, (size_t)n), (size_t)n);
}

/* ---- positions ---- */

/* Whether no change of a client is under way. */
static bool is_settled(const struct server *s)
{
    for (const struct job *j = s->jobs; j != NULL; j = j->next)
        if (j->record != NULL)
            return false;
    const struct log_status *log = durable_status(s);
    return log->state != LOG_FAILED && log->durable == log_last(durable_log(s));
}

static void answer_link(struct follower *f)
{
    struct server *s = f->server;
    if (!link_wants_position(f->link) || !is_settled(s))
        return;
    apply_clear(&f->apply); /* the load begins again */
    apply_init(&f->apply, s, resume);
    const struct log_status *log = durable_status(s);
    f->lsn = log->durable;
    if (f->whole_digest != 0)
        f->whole_digest = log->digest;
    f->digest = f->whole_digest;
    struct position from = {durable_dir(s)->lineage.history, f->lsn, f->digest};
    f->done = f->done_bytes = f->acked = f->acked_bytes = 0;
    link_go(f->link, &from);
}

static void cancel_writer(struct dataset *set, void *ctx)
{
    if (set->writer == NULL)
        return;
    set->writer->cancel = true;
    *(bool *)ctx = true;
}

/* A snapshot has come: replaces everything by it, when no set has a writer. */
static void install(struct follower *f, struct link_arrival *a)
{
    struct server *s = f->server;
    bool busy = false;
    registry_each(&s->sets, cancel_writer, &busy);
    for (const struct job *j = s->jobs; j != NULL && !busy; j = j->next)
        busy = j->set != NULL;
    if (busy)
        return;
    struct recovery *r = &a->recovery;
    struct lineage l = a->dir.lineage;
    leader_dismiss(s);
    durable_set_digest(s, &f->whole_digest);
    f->lsn = r->last;
    f->digest = f->whole_digest = r->digest;
    f->confirmed = false;
    f->claimed = f->done = f->done_bytes = f->acked = f->acked_bytes = 0;
    if (!durable_replace(s, r, &l, r->digest)) {
        notice(NOTICE_ERROR, "the data directory cannot be used any more; the daemon ends");
        loop_stop(f->loop);
        return;
    }
    durable_close_mark(s, false);
    recovery_clear(r);
    aside_close(&a->dir);
    free(a);
    notice(NOTICE_INFO, "everything is that of %s:%u now, up to change %" PRIu64, f->host, f->port,
           f->lsn);
    link_installed(f->link, f->lsn);
}

/* ---- running ---- */

/* Acknowledges what is durable. */
static void acknowledge(struct follower *f)
{
    const struct log_status *log = durable_status(f->server);
    if (log == NULL)
        return;
    uint64_t bytes = log->durable >= f->done ? f->done_bytes : f->acked_bytes;
    if (log->durable <= f->acked && bytes <= f->acked_bytes)
        return;
    f->acked = log->durable;
    f->acked_bytes = bytes;
    link_acknowledge(f->link, f->acked, bytes);
}

/* The piece has been carried out. */
static void end_piece(struct follower *f)
{
    if (!apply_in_load(&f->apply)) {
        f->done = f->lsn;
        f->done_bytes = f->piece->end;
    }
    link_piece_free(f->piece);
    f->piece = NULL;
    f->at = 0;
}

static bool next_piece(struct follower *f)
{
    if (f->piece != NULL && f->at == buf_len(&f->piece->bytes))
        end_piece(f);
    if (f->piece == NULL)
        f->piece = link_take(f->link);
    return f->piece != NULL;
}

static void run(struct follower *f)
{
    struct server *s = f->server;
    if (!f->following || f->link == NULL || durable_dir(s) == NULL || s->stopping)
        return;
    int64_t until = clock_ns() + TURN_NS;
    for (unsigned n = 1; !f->busy && durable_has_room(s); n++) {
        if (!next_piece(f)) {
            struct link_arrival *a = link_arrival(f->link);
            if (a != NULL)
                install(f, a);
            else
                answer_link(f);
            return;
        }
        if (!step(f))
            return;
        if (n % RECORDS_PER_LOOK == 0 && clock_ns() > until) {
            loop_yield(f->loop, &f->task);
            return;
        }
    }
}

void follower_turn_end(struct server *s)
{
    struct follower *f = s->follower;
    if (f == NULL || !f->following || f->link == NULL)
        return;
    acknowledge(f);
    check_claim(f);
    if (!f->busy && f->piece != NULL && durable_has_room(s))
        loop_yield(f->loop, &f->task);
}

void follower_tick(struct server *s)
{
    struct follower *f = s->follower;
    if (f == NULL || f->link == NULL || !f->following)
        return;
    if (f->piece != NULL && f->at == buf_len(&f->piece->bytes) && !f->busy)
        end_piece(f);
    run(f);
}

/* ---- FOLLOW ---- */

const char *follower_follow(struct server *s, const char *host, unsigned port, bool confirmed)
{
    struct follower *f = s->follower;
    char line[128];
    if (f->busy)
        return "a change of the leader is being carried out; try again";
    snprintf(line, sizeof line, "follow %s %u\n", host, port);
    if (!role_write(durable_dir(s), line))
        return strerror(errno);
    end_link(f);
    leader_dismiss(s);
    f->fenced = false;
    f->confirmed = confirmed;
    snprintf(f->host, sizeof f->host, "%s", host);
    f->port = port;
    refuse_changes(f);
    apply_clear(&f->apply);
    apply_init(&f->apply, s, resume);
    return begin(f);
}

const char *follower_promote(struct server *s)
{
    struct follower *f = s->follower;
    bool followed = f->following;
    if (!followed && !f->fenced)
        return NULL;
    if (f->busy)
        return "a change of the leader is being carried out; try again";
    if (durable_status(s)->state == LOG_FAILED)
        return "the disk does not work";
    struct lineage l = durable_dir(s)->lineage;
    if (f->fenced && f->newer.generation > l.history.generation)
        l.history.generation = f->newer.generation;
    l.history = history_next(&l.history, (uint32_t)random_bits());
    if (!role_write(durable_dir(s), ""))
        return strerror(errno);
    end_link(f);
    apply_clear(&f->apply);
    apply_init(&f->apply, s, resume);
    f->following = f->fenced = false;
    durable_set_digest(s, NULL);
    durable_close_mark(s, true);
    registry_begin_life(&s->sets, l.life);
    l.life = s->sets.life;
    durable_set_lineage(s, &l);
    leader_dismiss(s);
    s->follows = false;
    s->read_only.why = NULL;
    notice(NOTICE_INFO, "this daemon is a leader now");
    const char *why =
        followed ? start_link(f, true) : NULL; /* its former leader is to refuse changes */
    if (why != NULL)
        notice(NOTICE_WARNING, "the former leader is not informed: %s", why);
    return NULL;
}

void follower_meet(struct server *s, const struct history *h)
{
    struct follower *f = s->follower;
    char line[128], history[HISTORY_TEXT];
    if (f->following || history_relation(h, &durable_dir(s)->lineage.history) != HISTORY_NEWER)
        return;
    f->fenced = true;
    f->newer = *h;
    history_write(history, h);
    snprintf(line, sizeof line, "fenced %s\n", history);
    if (!role_write(durable_dir(s), line))
        notice(NOTICE_ERROR, "that there is a newer history cannot be saved: %s", strerror(errno));
    refuse_changes(f);
    notice(NOTICE_WARNING, "changes are refused: %s", f->why);
}

/* ---- INFO ---- */

void follower_facts(const struct server *s, struct follower_facts *facts)
{
    struct follower *f = s->follower;
    static const char *const names[] = {"connecting", "receiving", "loading", "refused"};
    *facts = (struct follower_facts){.role = "leader", .state = ""};
    if (f != NULL && f->fenced)
        facts->role = "fenced";
    if (f == NULL || !s->follows)
        return;
    facts->role = "follower";
    facts->state = "connecting";
    snprintf(facts->leader, sizeof facts->leader, "%s:%u", f->host, f->port);
    if (f->link == NULL)
        return;
    pthread_mutex_lock(&f->link->mutex);
    facts->state = names[f->link->state];
    snprintf(facts->why, sizeof facts->why, "%s", f->link->why);
    facts->leader_lsn = f->link->leader_lsn;
    pthread_mutex_unlock(&f->link->mutex);
}
