/* durable.c - see durable.h. The directory is read, then triangulations are made again, smallest set
 * first; from then on there is only log and snapshots, which saver.h keeps in step. */
#include "server/durable.h"

#include "server/command.h"
#include "server/job.h"
#include "server/loop.h"
#include "server/notice.h"
#include "server/recover.h"
#include "server/saver.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum {
    QUEUE_SHARE = 8,         /* one part of --max-memory in so many is for the log's queue, */
    QUEUE_LEAST = 64 * 1024, /* but no less */
    QUEUE_MOST = 256 << 20   /* and no more than this */
};

enum stage {
    STAGE_NONE,       /* nothing has begun, or the directory cannot be used */
    STAGE_READING,    /* the reader has the directory and everything that it has read */
    STAGE_REBUILDING, /* the sets are the server's, but not all are triangulated yet */
    STAGE_COMPLETE
};

struct durable {
    struct datadir dir;
    int event;
    enum stage stage;
    /* reading */
    struct recovery recovery;
    pthread_t reader;
    atomic_bool read; /* the reader is done */
    struct log *log;  /* owns; from STAGE_REBUILDING on, or NULL */
    /* rebuilding */
    struct dataset **rebuild; /* owns; those that have no triangulation yet, from `rebuilt` on */
    size_t rebuilds, rebuilt;
    struct job *job;    /* borrows: what is at work on the first of them */
    struct saver saver; /* of log and snapshots */
};

static bool is_running(const struct durable *d)
{
    return d != NULL && d->stage >= STAGE_REBUILDING;
}

struct log *durable_log(const struct server *s)
{
    return is_running(s->durable) ? s->durable->log : NULL;
}

/* ---- reading: on a thread of its own ---- */

static void *read_directory(void *arg)
{
    struct server *s = arg;
    struct durable *d = s->durable;
    struct recovery *r = &d->recovery;
    recovery_run(r);
    if (r->result == RECOVERY_OK && recovery_tidy(r)) {
        if (r->why[0] != '\0')
            notice(r->later > 0 ? NOTICE_ERROR : NOTICE_WARNING, "%s", r->why);
        d->log = log_new(&d->dir, s->config->fsync, r->last + 1, d->event);
        if (d->log == NULL)
            r->result = RECOVERY_ERROR;
        else
            log_fill(d->log, r->ahead);
    } else if (r->result != RECOVERY_CANCELLED) {
        notice(NOTICE_ERROR, "%s: %s", d->dir.path, r->why);
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
    recovery_init(&d->recovery, &d->dir);
    d->recovery.replay.sets.pages = s->pages;
    s->durable = d;
    if (d->event < 0 || pthread_create(&d->reader, NULL, read_directory, s) != 0) {
        notice(NOTICE_ERROR, "cannot start a thread");
        return false;
    }
    d->stage = STAGE_READING;
    return true;
}

int durable_event(const struct server *s)
{
    return s->durable->event;
}

/* ---- making triangulations again ---- */

static void rebuild_next(struct server *s);

static void run_rebuild(struct job *j)
{
    j->status = dt_triangulate(j->dt, &j->options);
}

static void rebuild_done(struct server *s, struct job *j, struct answer *a)
{
    struct durable *d = s->durable;
    (void)a;
    j->set->loading = false;
    d->job = NULL;
    if (j->status != DT_OK && !s->stopping)
        notice(NOTICE_ERROR, "the set %s could not be triangulated again: out of memory",
               j->set->name);
    d->rebuilt++;
    if (!s->stopping)
        rebuild_next(s);
}

/* What is on the disk is read whatever --max-memory says: nothing that was acknowledged is left out. */
static void report_memory(const struct server *s)
{
    size_t taken = budget_of(&s->budget, BUDGET_SETS);
    if (!budget_fits(&s->budget, BUDGET_SETS, 0))
        notice(NOTICE_WARNING,
               "the sets take %zu bytes, which is all that --max-memory allows: points can be "
               "deleted, but not added",
               taken);
}

static void rebuild_next(struct server *s)
{
    struct durable *d = s->durable;
    struct buf out = {0};
    struct answer nobody = {.out = &out};
    if (d->rebuilt < d->rebuilds) {
        struct job *j = job_new(sizeof *j, run_rebuild, rebuild_done);
        d->job = j;
        if (j != NULL)
            job_write(s, &nobody, j, d->rebuild[d->rebuilt], JOB_HEAVY | JOB_BRIEF);
        buf_free(&out);
        if (j != NULL)
            return;
        notice(NOTICE_ERROR, "out of memory; some sets are not triangulated");
        for (; d->rebuilt < d->rebuilds; d->rebuilt++)
            d->rebuild[d->rebuilt]->loading = false;
    }
    d->stage = STAGE_COMPLETE;
    report_memory(s);
    eventfd_write(d->event, 1); /* all is there: somebody may wait */
}

static int by_size(const void *a, const void *b)
{
    const struct dataset *const *x = a, *const *y = b;
    uint32_t m = (*x)->current->sum.points, n = (*y)->current->sum.points;
    return m < n ? -1 : m > n;
}

static void count_set(struct dataset *set, void *ctx)
{
    struct server *s = ctx;
    version_update(&s->sets, set->current);
    s->durable->rebuilds += set->triangulated;
}

static void note_set(struct dataset *set, void *ctx)
{
    struct durable *d = ((struct server *)ctx)->durable;
    set->loading = set->triangulated;
    if (set->triangulated)
        d->rebuild[d->rebuilt++] = set;
}

/* The sets that were read become the server's. */
static bool adopt_sets(struct server *s)
{
    struct durable *d = s->durable;
    struct registry *from = &d->recovery.replay.sets;
    s->sets.bucket = from->bucket;
    s->sets.buckets = from->buckets;
    s->sets.sets = from->sets;
    reservation_set(&s->sets.memory, s->sets.memory.bytes + from->memory.bytes);
    *from = (struct registry){0};
    registry_each(&s->sets, count_set, s);
    d->rebuild = malloc((d->rebuilds + 1) * sizeof(struct dataset *));
    if (d->rebuild == NULL)
        return false;
    registry_each(&s->sets, note_set, s);
    d->rebuilt = 0;
    qsort(d->rebuild, d->rebuilds, sizeof(struct dataset *), by_size);
    return true;
}

/* The reader is done. False: it has failed. */
static bool end_reading(struct server *s)
{
    struct durable *d = s->durable;
    pthread_join(d->reader, NULL);
    d->stage = STAGE_NONE;
    if (d->recovery.result != RECOVERY_OK)
        return false;
    d->saver = (struct saver){.dir = &d->dir,
                              .sets = &s->sets,
                              .held = &s->held,
                              .log = d->log,
                              .event = d->event,
                              .compact_at = &s->config->compact_at,
                              .read_bytes = d->recovery.log_bytes,
                              .snapshot_lsn = d->recovery.replay.snapshot};
    if (!adopt_sets(s)) {
        notice(NOTICE_ERROR, "out of memory");
        return false;
    }
    recovery_clear(&d->recovery);
    log_status(d->log, &d->saver.status);
    s->held.durable = d->saver.status.durable;
    d->stage = STAGE_REBUILDING;
    rebuild_next(s);
    return true;
}

bool durable_is_complete(const struct server *s)
{
    const struct durable *d = s->durable;
    return d == NULL || d->stage == STAGE_COMPLETE;
}

/* ---- snapshots ---- */

void cmd_snapshot(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct durable *d = s->durable;
    (void)set, (void)q;
    if (d == NULL) {
        reply_err(a->out, ERR_IO, "there is no data directory (--data)");
        return;
    }
    if (d->saver.state != SAVER_IDLE) {
        reply_err(a->out, ERR_BUSY, "a snapshot is being written");
        return;
    }
    if (!saver_begin(&d->saver, clock_ms())) {
        answer_out_of_memory(a);
        return;
    }
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "lsn", d->saver.cut);
    reply_end(a->out);
}

/* ---- events ---- */

bool durable_on_event(struct server *s)
{
    struct durable *d = s->durable;
    eventfd_t count;
    eventfd_read(d->event, &count);
    if (d->stage == STAGE_READING && d->read && !end_reading(s))
        return false;
    if (is_running(d))
        saver_step(&d->saver, clock_ms(), s->stopping);
    return true;
}

void durable_tick(struct server *s)
{
    struct durable *d = s->durable;
    if (!is_running(d))
        return;
    if (d->saver.status.state == LOG_FULL)
        log_refill_reserve(d->log);
    saver_step(&d->saver, clock_ms(), s->stopping);
}

/* Whether the log has so much to write that changes wait. */
static bool is_behind(const struct server *s)
{
    size_t room = s->config->max_memory / QUEUE_SHARE;
    room = room < QUEUE_LEAST ? QUEUE_LEAST : room > QUEUE_MOST ? QUEUE_MOST : room;
    return s->queued.bytes > room;
}

void durable_turn_end(struct server *s)
{
    struct durable *d = s->durable;
    if (!is_running(d))
        return;
    log_push(d->log);
    reservation_set(&s->queued, log_queued(d->log));
    if (!is_behind(s) || d->saver.status.state != LOG_GOOD)
        wait_call(&s->log);
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
    free(d->rebuild);
    if (d->event >= 0)
        close(d->event);
    datadir_close(&d->dir);
    free(d);
    s->durable = NULL;
}

/* ---- what clients may do ---- */

bool durable_loaded(struct server *s, struct answer *a)
{
    struct durable *d = s->durable;
    if (d == NULL || d->stage != STAGE_READING)
        return true;
    reply_err(a->out, ERR_LOADING, "the data directory is being read, %u %% so far; try again",
              recovery_percent(&d->recovery));
    return false;
}

bool durable_admits(struct server *s, struct answer *a, const struct dataset *set, bool write,
                    bool frees)
{
    const struct durable *d = s->durable;
    if (d == NULL)
        return true;
    if (set != NULL && set->loading) {
        bool first = d->job != NULL && d->rebuild[d->rebuilt] == set;
        reply_err(a->out, ERR_LOADING, "the set %s is being triangulated, %u %% so far; try again",
                  set->name, first ? d->job->progress : 0);
        return false;
    }
    if (!write)
        return true;
    const struct log_status *status = &d->saver.status;
    bool full = saver_disk_is_full(&d->saver);
    if (status->state != LOG_GOOD && !(frees && full)) {
        reply_err(a->out, ERR_READONLY, "nothing can be saved now: %s%s", strerror(status->error),
                  full ? "; DEL and DROP are possible" : "");
        return false;
    }
    if (!is_behind(s) && wait_is_first(&s->log, a->turn))
        return true;
    answer_wait(a, &s->log, false);
    return false;
}

/* ---- INFO ---- */

void durable_facts(const struct server *s, struct durable_facts *f)
{
    static const char *const state[] = {"good", "full", "readonly"};
    const struct durable *d = s->durable;
    *f = (struct durable_facts){.state = "off", .loaded_percent = 100};
    if (d == NULL)
        return;
    f->state = "loading";
    f->loaded_percent = recovery_percent(&s->durable->recovery);
    if (!is_running(d))
        return;
    f->loaded_percent = durable_is_complete(s) ? 100 : 99; /* triangulations are still made */
    const struct saver *v = &d->saver;
    f->state =
        durable_is_complete(s) || v->status.state != LOG_GOOD ? state[v->status.state] : "loading";
    f->lsn = log_last(d->log);
    f->durable_lsn = v->status.durable;
    f->synced_lsn = v->status.synced;
    f->log_bytes = saver_log_bytes(v);
    f->log_syncs = v->status.syncs;
    f->log_failures = v->status.failures;
    f->snapshot_lsn = v->snapshot_lsn;
    f->snapshot_bytes = v->snapshot_bytes;
    f->snapshots = v->snapshots;
    f->snapshot_running = v->snapshot != NULL;
    f->snapshot_failures = saver_failures(v);
    f->snapshot_retry_s = (uint64_t)(saver_retry_ms(v, clock_ms()) + 999) / 1000;
}
