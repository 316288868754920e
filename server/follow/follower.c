/* follower.c - carries out the records that a leader has sent (follower.h). */
#include "server/follow/follower.h"

#include "server/disk/aside.h"
#include "server/follow/follower_inside.h"
#include "server/follow/leader.h"
#include "server/jobs/durable.h"
#include "server/jobs/job.h"
#include "server/system/notice.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum { TURN_NS = 400 * 1000, RECORDS_PER_LOOK = 16 };

static void run(struct follower *f);

/* ---- the link ---- */

static void on_event(struct source *source, uint32_t events)
{
    struct follower *f = (struct follower *)source;
    eventfd_t count;
    eventfd_read(source->fd, &count);
    follower_hear(f);
    follower_take_answer(f);
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

bool follower_watch(struct follower *f)
{
    f->source = (struct source){.fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), .ready = on_event};
    f->task.run = on_task;
    apply_init(&f->apply, f->server, resume);
    return f->source.fd >= 0 && loop_watch(f->loop, &f->source, EPOLLIN);
}

void follower_forget(struct follower *f)
{
    apply_clear(&f->apply);
    apply_init(&f->apply, f->server, resume);
}

/* ---- records ---- */

/* Everything that has been received and not carried out is dropped; it is asked for again. */
static void start_again(struct follower *f, const char *reason)
{
    char why[LINK_WHY];
    snprintf(why, sizeof why, "change %" PRIu64 " cannot be carried out: %.150s", f->lsn + 1,
             reason);
    link_again(f->link, why);
    f->drops = true;
    link_piece_free(f->piece);
    f->piece = NULL;
    f->at = 0;
    follower_forget(f);
    f->lsn = log_last(durable_log(f->server));
    f->digest = f->whole_digest;
}

/* The sets here differ from the leader's: only a snapshot helps. */
static void give_up(struct follower *f, const char *why)
{
    f->whole_digest = 0;
    start_again(f, why);
}

/* Compares the digest of a header with the digest of the own log, when the log is durable. */
static void check_claim(struct follower *f)
{
    const struct log_status *log = durable_status(f->server);
    if (follower_has_record(f) || f->claimed == 0 || log == NULL || log->durable < f->claimed)
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
    follower_agrees(f);
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

/* The record of n bytes has been carried out. False: the log here does not have it as the leader's has. */
static bool end_record(struct follower *f, size_t n)
{
    bool whole = !apply_in_load(&f->apply); /* else the log here has it when the LOAD is complete */
    if (whole && log_last(durable_log(f->server)) != f->lsn + 1) {
        give_up(f, "it makes other records here");
        return false;
    }
    f->digest = record_digest(f->digest, buf_head(&f->piece->bytes) + f->at, n);
    f->at += n;
    f->lsn++;
    if (whole)
        f->whole_digest = f->digest;
    return true;
}

/* Settles a record of n bytes after its result `how`. False: nothing more can be carried out now. */
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

/* Carries out the next record of the piece. False: nothing more can be carried out now. */
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
    for (const struct job *j = job_first(s); j != NULL; j = job_next(s, j))
        if (j->acknowledges)
            return false;
    const struct log_status *log = durable_status(s);
    return log->state != LOG_FAILED && log->durable == log_last(durable_log(s));
}

static void answer_link(struct follower *f)
{
    struct server *s = f->server;
    if (!link_wants_position(f->link) || !is_settled(s))
        return;
    f->drops = false;
    follower_forget(f); /* the load begins again */
    const struct log_status *log = durable_status(s);
    f->lsn = log->durable;
    if (f->whole_digest != 0)
        f->whole_digest = log->digest;
    f->digest = f->whole_digest;
    struct position from = {durable_dir(s)->lineage.history, f->lsn, f->digest};
    f->done = f->done_bytes = f->acked = f->acked_bytes = 0;
    link_go(f->link, &from);
}

/* Whether a snapshot with these sets leaves that one as it is. */
static bool stays(const struct dataset *set, const struct registry *arrived)
{
    struct word name = {.text = set->name, .len = set->name_len};
    return set->temporary && registry_find(arrived, &name) == NULL;
}

/* Whether jobs use sets that are to be replaced; they are cancelled. */
static bool is_in_use(const struct server *s, const struct registry *arrived)
{
    bool used = false;
    for (struct job *j = job_first(s); j != NULL; j = job_next(s, j)) {
        if (j->set == NULL || stays(j->set, arrived))
            continue;
        used = true;
        if (j->set->writer == j)
            j->cancel = true;
    }
    return used;
}

/* A snapshot has come: replaces everything by it, when no job uses a set that is replaced. */
static void install(struct follower *f, struct link_arrival *a)
{
    struct server *s = f->server;
    if (is_in_use(s, &a->recovery.replay.sets))
        return;
    bool same = f->whole_digest != 0 && !f->confirmed; /* the sets were those of the leader */
    struct recovery *r = &a->recovery;
    struct lineage l = a->dir.lineage;
    leader_dismiss(s);
    f->drops = false;
    durable_set_digest(s, &f->whole_digest);
    f->lsn = r->last;
    f->digest = f->whole_digest = r->digest;
    f->confirmed = false;
    f->claimed = f->done = f->done_bytes = f->acked = f->acked_bytes = 0;
    if (!durable_replace(s, r, &l, same)) {
        notice_error("the data directory cannot be used any more; the daemon ends");
        loop_stop(f->loop);
        return;
    }
    durable_close_mark(s, false);
    recovery_clear(r);
    aside_close(&a->dir);
    free(a);
    follower_agrees(f);
    char leader[ROLE_TEXT];
    role_write_address(leader, f->role.host, f->role.port);
    notice(NOTICE_INFO, "everything is that of %s now, up to change %" PRIu64, leader, f->lsn);
    link_installed(f->link, f->lsn);
}

/* ---- running ---- */

/* Acknowledges the durable changes. */
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
    while (f->drops && f->piece != NULL) {
        link_piece_free(f->piece);
        f->piece = link_take(f->link);
    }
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
    if (f != NULL)
        follower_remember(f);
    if (f == NULL || f->link == NULL || !f->following)
        return;
    if (f->record > 0 || f->lsn != f->looked)
        link_works(f->link);
    f->looked = f->lsn;
    if (f->piece != NULL && f->at == buf_len(&f->piece->bytes) && !f->busy)
        end_piece(f);
    run(f);
}
