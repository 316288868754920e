/* durable.c - see durable.h. Once the directory has been read, the saver (saver.h) controls log and
 * snapshots. */
#include "server/jobs/durable.h"

#include "server/disk/aside.h"
#include "server/system/loop.h"
#include "server/system/notice.h"
#include "server/system/random.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

enum {
    QUEUE_SHARE = 8,         /* this fraction of --max-memory is for the log's queue, */
    QUEUE_LEAST = 64 * 1024, /* at least this */
    QUEUE_MOST = 256 << 20   /* and at most this */
};

enum stage {
    STAGE_NONE,    /* not begun, or the directory cannot be used */
    STAGE_READING, /* a thread is reading, and owns what it has read */
    STAGE_READ,    /* the sets are the server's, but not all are triangulated yet (restart.h) */
    STAGE_COMPLETE
};

struct durable {
    struct datadir dir;
    int event;
    enum stage stage;
    /* reading */
    struct recovery recovery;
    pthread_t reader;
    enum log_policy policy; /* a copy: the thread reads no settings, which CONFIG SET writes */
    atomic_bool read;       /* the thread is done */
    bool gap;               /* the log has lost changes that a snapshot has */
    bool keeps;             /* log stays for followers */
    struct log *log;        /* owns; NULL before STAGE_READ */
    struct saver saver;
    uint64_t backups, backup_lsn; /* how many; what the last one has, and when it was complete */
    time_t backup_time;
};

static bool is_running(const struct durable *d)
{
    return d != NULL && d->stage >= STAGE_READ;
}

struct log *durable_log(const struct server *s)
{
    return is_running(s->durable) ? s->durable->log : NULL;
}

struct log *durable_log_of(const struct server *s, const struct dataset *set)
{
    return set->temporary ? NULL : durable_log(s);
}

/* Appends a change that needs several records. Its items and values move to the log. */
static uint64_t append_long(struct log *log, const struct dataset *set, struct change *c)
{
    bool constraints = c->kind->items == ITEMS_CONSTRAINTS;
    bool column = c->kind->items == ITEMS_COLUMN; /* a LOAD of no points */
    struct record r = {.type = constraints ? c->kind->record : RECORD_CHUNK,
                       .name = set->name,
                       .name_len = set->name_len,
                       .first = column ? dt_next_id(set->current->dt) : c->first,
                       .n = column ? 0 : c->n};
    struct pslg_lists *lists = c->kind->items == ITEMS_PSLG ? &c->pslg->lists : NULL;
    uint64_t lsn = log_append_load(log, &r, c->items, c->columns, lists);
    c->items = NULL;
    c->columns = NULL;
    return lsn;
}

void durable_append(struct log *log, const struct dataset *set, struct change *c)
{
    if (log == NULL)
        return;
    struct record r = change_encode(c);
    c->lsn = change_is_long(c) ? append_long(log, set, c) : log_append(log, &r);
}

uint64_t durable_lsn(const struct server *s, const struct dataset *set)
{
    return set != NULL ? set->current->lsn : s->dropped;
}

uint64_t durable_last_lsn(const struct server *s)
{
    const struct log *log = durable_log(s);
    return log != NULL ? log_last(log) : 0;
}

/* ---- reading, on a thread of its own ---- */

/* Chooses the life and the history of the changes that follow. */
static void begin_lineage(const struct server *s, struct datadir *dir, struct recovery *r)
{
    dir->lineage = r->lineage;
    if (s->follows && r->lineage.life != 0)
        r->replay.sets.life = r->lineage.life; /* that of its leader */
    else
        registry_begin_life(&r->replay.sets, r->lineage.life);
    dir->lineage.life = r->replay.sets.life;
    if (dir->lineage.history.origin == 0)
        dir->lineage.history = history_begin(random_bits());
}

/* Whether the directory has been read and prepared for changes. */
static bool recover(struct durable *d, struct recovery *r)
{
    if (!aside_finish(&d->dir))
        return notice_error("%s: what a leader has sent cannot be put in place: %s", d->dir.path,
                            strerror(errno));
    recovery_run(r);
    if (r->result == RECOVERY_OK && recovery_tidy(r))
        return true;
    if (r->result != RECOVERY_CANCELLED)
        notice_error("%s: %s", d->dir.path, r->why);
    return false;
}

/* Begins the log behind what has been read; without a log, reading has failed. */
static void *read_directory(void *arg)
{
    struct server *s = arg;
    struct durable *d = s->durable;
    struct recovery *r = &d->recovery;
    if (recover(d, r)) {
        d->keeps = datadir_keeps(&d->dir);
        begin_lineage(s, &d->dir, r);
        if (r->why[0] != '\0')
            notice(r->lost ? NOTICE_ERROR : NOTICE_WARNING, "%s", r->why);
        /* Changes that the log has lost have other records: nothing continues from their digest. */
        d->gap = r->ahead > r->last;
        d->log = log_new(&d->dir, d->policy, r->last + 1, d->gap ? 0 : r->digest, d->event);
        if (d->log != NULL)
            log_fill(d->log, r->ahead);
    }
    d->read = true;
    eventfd_write(d->event, 1);
    return NULL;
}

bool durable_start(struct server *s)
{
    struct durable *d = calloc(1, sizeof *d);
    if (d == NULL || !datadir_open(&d->dir, s->config->data, true)) {
        free(d);
        return false;
    }
    d->event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    d->policy = s->config->fsync;
    recovery_init(&d->recovery, &d->dir);
    d->recovery.replay.sets.pages = s->pages;
    s->durable = d;
    if (d->event < 0 || pthread_create(&d->reader, NULL, read_directory, s) != 0)
        return notice_error("cannot start a thread");
    d->stage = STAGE_READING;
    return true;
}

int durable_event(const struct server *s)
{
    return s->durable->event;
}

/* The log has begun after what r has read. */
static void begin_saver(struct server *s, const struct recovery *r)
{
    struct durable *d = s->durable;
    d->saver = (struct saver){.dir = &d->dir,
                              .sets = &s->sets,
                              .held = &s->held,
                              .log = d->log,
                              .event = d->event,
                              .compact_at = &s->config->compact_at,
                              .applied = d->saver.applied,
                              .snapshots = d->saver.snapshots,
                              .snapshot_lsn = r->replay.snapshot};
    log_status(d->log, &d->saver.status);
}

/* The thread is done. False: it has failed. */
static bool end_reading(struct server *s)
{
    struct durable *d = s->durable;
    pthread_join(d->reader, NULL);
    d->stage = STAGE_NONE;
    if (d->log == NULL)
        return false;
    begin_saver(s, &d->recovery);
    d->saver.read_bytes = d->recovery.log_bytes;
    if (!registry_replace(&s->sets, &d->recovery.replay.sets, false))
        return notice_error("out of memory");
    recovery_clear(&d->recovery);
    holders_release(&s->held, d->saver.status.durable);
    d->stage = STAGE_READ;
    durable_settings_changed(s);
    return true;
}

bool durable_is_complete(const struct server *s)
{
    const struct durable *d = s->durable;
    return d == NULL || d->stage == STAGE_COMPLETE;
}

void durable_complete(struct server *s)
{
    s->durable->stage = STAGE_COMPLETE;
    eventfd_write(s->durable->event, 1); /* the ready line may wait for this */
}

/* ---- snapshots ---- */

enum durable_begun durable_begin_snapshot(struct server *s, uint64_t *lsn)
{
    struct durable *d = s->durable;
    if (d == NULL)
        return DURABLE_OFF;
    if (d->saver.state != SAVER_IDLE)
        return DURABLE_BUSY;
    if (!saver_begin(&d->saver, clock_ms()))
        return DURABLE_NOMEM;
    *lsn = d->saver.cut;
    return DURABLE_BEGUN;
}

/* ---- backups ---- */

bool durable_prepare_backup(struct server *s, struct backup *b)
{
    struct durable *d = s->durable;
    if (d == NULL)
        return false;
    log_push(d->log);
    b->dir = &d->dir;
    b->log = d->log;
    b->under = s->config->backup_dir;
    b->least = log_last(d->log);
    return true;
}

void durable_note_backup(struct server *s, const struct backup *b)
{
    struct durable *d = s->durable;
    d->backups++;
    d->backup_lsn = b->lsn;
    d->backup_time = time(NULL);
}

/* ---- events ---- */

enum durable_news durable_on_event(struct server *s)
{
    struct durable *d = s->durable;
    bool read = d->stage == STAGE_READING && d->read;
    eventfd_t count;
    eventfd_read(d->event, &count);
    if (read && !end_reading(s))
        return DURABLE_FAILED;
    if (is_running(d))
        saver_step(&d->saver, clock_ms(), s->stopping);
    return read ? DURABLE_READ : DURABLE_NO_NEWS;
}

void durable_tick(struct server *s)
{
    struct durable *d = s->durable;
    if (!is_running(d))
        return;
    if (d->saver.status.state != LOG_FAILED)
        log_tend(d->log);
    saver_step(&d->saver, clock_ms(), s->stopping);
}

/* ---- for followers ---- */

struct datadir *durable_dir(const struct server *s)
{
    return is_running(s->durable) ? &s->durable->dir : NULL;
}

const struct log_status *durable_status(const struct server *s)
{
    return is_running(s->durable) ? &s->durable->saver.status : NULL;
}

bool durable_has_gap(const struct server *s)
{
    return s->durable->gap;
}

void durable_keep_log(struct server *s)
{
    s->durable->keeps = true;
    durable_settings_changed(s);
}

void durable_settings_changed(struct server *s)
{
    struct durable *d = s->durable;
    bool leads = s->leader != NULL && s->read_only.why == NULL;
    if (!is_running(d)) /* when it has read the directory */
        return;
    if (d->keeps)
        d->dir.keep_log = s->config->keep_log;
    if (leads && s->config->min_followers > 0 && !s->held.needs_followers)
        holders_follow(&s->held, 0);
}

void durable_set_digest(struct server *s, const uint64_t *digest)
{
    if (is_running(s->durable))
        s->durable->saver.applied = digest;
}

void durable_set_lineage(struct server *s, const struct lineage *l)
{
    s->durable->dir.lineage = *l;
    s->sets.life = l->life;
    log_rotate(s->durable->log, l);
}

void durable_close_mark(struct server *s, bool writes)
{
    if (is_running(s->durable))
        log_close_mark(s->durable->log, writes);
}

bool durable_replace(struct server *s, struct recovery *r, const struct lineage *l, bool same)
{
    struct durable *d = s->durable;
    saver_clear(&d->saver);
    log_free(d->log);
    d->log = NULL;
    d->stage = STAGE_NONE;
    d->dir.lineage = *l;
    if (!aside_put_in_place(&d->dir) || !registry_replace(&s->sets, &r->replay.sets, same))
        return notice_error("%s: what a leader has sent cannot be put in place: %s", d->dir.path,
                            strerror(errno));
    d->log = log_new(&d->dir, d->policy, r->last + 1, r->digest, d->event);
    if (d->log == NULL)
        return false;
    begin_saver(s, r);
    holders_release(&s->held, UINT64_MAX); /* replies about what was there before */
    holders_recover(&s->held, HOLD_DISK);
    holders_release(&s->held, d->saver.status.durable);
    d->gap = false;
    d->stage = STAGE_COMPLETE;
    return true;
}

/* Whether the queue of the log is full, so that changes wait. */
static bool is_behind(const struct server *s)
{
    size_t room = s->config->max_memory / QUEUE_SHARE;
    room = room < QUEUE_LEAST ? QUEUE_LEAST : room > QUEUE_MOST ? QUEUE_MOST : room;
    const struct log *log = durable_log(s);
    return log != NULL && log_queued(log) > room;
}

const char *durable_fault(const struct server *s)
{
    const struct durable *d = s->durable;
    if (!is_running(d) || d->saver.status.state == LOG_GOOD)
        return NULL;
    return datadir_error(saver_error(&d->saver));
}

bool durable_has_room(const struct server *s)
{
    const struct durable *d = s->durable;
    bool possible =
        is_running(d) && (d->saver.status.state == LOG_GOOD || saver_disk_is_full(&d->saver));
    return possible && !is_behind(s);
}

void durable_turn_end(struct server *s)
{
    struct durable *d = s->durable;
    if (!is_running(d))
        return;
    log_push(d->log);
    reservation_set(&s->queued, log_queued(d->log));
    if (!is_behind(s) || d->saver.status.state != LOG_GOOD)
        queue_call(&s->log);
}

void durable_push(struct task *t)
{
    const struct reactor *r = list_owner(&t->link, offsetof(struct reactor, push));
    struct log *log = durable_log(r->server);
    if (log != NULL)
        log_push(log);
}

void durable_stop(struct server *s)
{
    struct durable *d = s->durable;
    if (d == NULL)
        return;
    d->recovery.cancel = true;
    if (d->stage == STAGE_READING)
        pthread_join(d->reader, NULL);
    recovery_clear(&d->recovery);
    saver_clear(&d->saver);
    if (d->log != NULL)
        log_free(d->log);
    if (d->event >= 0)
        close(d->event);
    datadir_close(&d->dir);
    free(d);
    s->durable = NULL;
}

/* ---- requests ---- */

bool durable_loaded(struct server *s, struct answer *a)
{
    struct durable *d = s->durable;
    if (d == NULL || d->stage != STAGE_READING)
        return true;
    return answer_err(a, ERR_LOADING, "the data directory is being read, %u %% so far; try again",
                      recovery_percent(&d->recovery));
}

/* A setting of 0 holds at once, for the next request. */
static bool lacks_followers(const struct server *s)
{
    return s->without_followers && s->config->min_followers > 0;
}

bool durable_admits_change(struct server *s, struct answer *a, bool frees)
{
    const struct durable *d = s->durable;
    if (s->read_only.why != NULL)
        return answer_err(a, s->read_only.code, "%s", s->read_only.why);
    if (d == NULL)
        return true;
    if (lacks_followers(s))
        return answer_err(a, ERR_NOFOLLOWERS, "fewer than %u followers are connected",
                          s->config->min_followers);
    const struct log_status *status = &d->saver.status;
    bool full = saver_disk_is_full(&d->saver);
    if (status->state != LOG_GOOD && !(frees && full))
        return answer_err(a, ERR_READONLY, "changes cannot be saved: %s%s",
                          datadir_error(saver_error(&d->saver)),
                          full ? "; DEL and DROP are possible" : "");
    return (!is_behind(s) && queue_is_first(&s->log, a->turn)) || answer_wait(a, &s->log, false);
}

bool durable_admits_drops(const struct server *s)
{
    const struct durable *d = s->durable;
    if (s->read_only.why != NULL || lacks_followers(s))
        return false;
    return d == NULL ||
           (is_running(d) && (d->saver.status.state == LOG_GOOD || saver_disk_is_full(&d->saver)));
}

/* ---- INFO ---- */

static const char *directory_state(const struct saver *v)
{
    if (v->status.state != LOG_FAILED)
        return "good";
    int error = saver_error(v);
    return error == ENOENT ? "gone" : error == ESTALE ? "replaced" : "good";
}

const struct saver *durable_saver(const struct server *s)
{
    static const struct saver none;
    return s->durable != NULL ? &s->durable->saver : &none;
}

static const char *state_of(const struct server *s, const struct saver *v)
{
    static const char *const state[] = {"good", "full", "readonly"};
    if (s->durable == NULL)
        return "off";
    return durable_is_complete(s) || v->status.state != LOG_GOOD ? state[v->status.state]
                                                                 : "loading";
}

/* 99: sets are still being triangulated. */
static unsigned loaded_percent(const struct server *s)
{
    if (durable_is_complete(s))
        return 100;
    return is_running(s->durable) ? 99 : recovery_percent(&s->durable->recovery);
}

void durable_facts(const struct server *s, struct facts *f)
{
    static const struct durable none;
    const struct durable *d = s->durable != NULL ? s->durable : &none;
    const struct saver *v = durable_saver(s);
    facts_add_text(f, "durability", state_of(s, v));
    facts_add_text(f, "data_directory", s->durable == NULL ? "off" : directory_state(v));
    facts_add(f, "loaded_percent", loaded_percent(s));
    facts_add(f, "log_lsn", durable_last_lsn(s));
    facts_add(f, "log_durable_lsn", v->status.durable);
    facts_add(f, "log_synced_lsn", v->status.synced);
    facts_add(f, "log_bytes", saver_log_bytes(v));
    facts_add(f, "log_syncs", v->status.syncs);
    facts_add(f, "log_failures", v->status.failures);
    facts_add(f, "snapshot_lsn", v->snapshot_lsn);
    facts_add(f, "snapshot_bytes", v->snapshot_bytes);
    facts_add(f, "snapshots", v->snapshots);
    facts_add(f, "snapshot_running", v->snapshot != NULL);
    facts_add(f, "snapshot_failures", saver_failures(v));
    facts_add(f, "snapshot_retry_s", (uint64_t)(saver_retry_ms(v, clock_ms()) + 999) / 1000);
    facts_add(f, "backups", d->backups);
    facts_add(f, "backup_lsn", d->backup_lsn);
    facts_add(f, "backup_timestamp_s", (uint64_t)d->backup_time);
}
