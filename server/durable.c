/* durable.c - see durable.h. Three stages: the directory is read (`reading`), then triangulations
 * are made again, smallest set first (`rebuild`), then there is only log and snapshots. */
#include "server/durable.h"

#include "server/command.h"
#include "server/job.h"
#include "server/loop.h"
#include "server/notice.h"
#include "server/recover.h"
#include "server/snapshot.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum {
    RETRY_MS = 500,
    QUEUE_SHARE = 8,         /* one part of --max-memory in so many is for the log's queue, */
    QUEUE_LEAST = 64 * 1024, /* but no less */
    QUEUE_MOST = 256 << 20   /* and no more than this */
};

struct durable {
    struct datadir dir;
    int event;
    /* reading */
    struct recovery recovery;
    pthread_t reader;
    bool reading;
    atomic_bool read; /* the reader is done */
    struct log *log;  /* owns; NULL while reading */
    /* rebuilding */
    struct dataset **rebuild; /* owns; those that have no triangulation yet, from `rebuilt` on */
    size_t rebuilds, rebuilt;
    struct job *job; /* borrows: what is at work on the first of them */
    /* log and snapshots */
    struct log_status status;
    struct snapshot *snapshot; /* owns; NULL: none is being written */
    bool rotating;             /* a new segment was asked for, then a snapshot begins */
    bool mending;              /* that snapshot makes good for a failure of the log */
    bool resuming;             /* and has done so: the log begins anew */
    uint64_t cut;              /* the snapshot's lsn */
    uint64_t failures;         /* of the log when it was told to resume */
    uint64_t earlier_bytes;    /* of log in earlier segments that the snapshot in place has not */
    uint64_t snapshot_lsn, snapshot_bytes, snapshots, full_lsn;
    int64_t retry_ms;
};

struct log *durable_log(const struct server *s)
{
    return s->durable == NULL || s->durable->reading ? NULL : s->durable->log;
}

/* ---- reading: on a thread of its own ---- */

static void *read_directory(void *arg)
{
    struct server *s = arg;
    struct durable *d = s->durable;
    struct recovery *r = &d->recovery;
    uint64_t one = 1;
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
    ssize_t ignored = write(d->event, &one, sizeof one);
    (void)ignored;
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
    d->reading = true;
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

static void rebuild_next(struct server *s)
{
    struct durable *d = s->durable;
    struct buf out = {0};
    struct answer nobody = {.out = &out};
    uint64_t one = 1;
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
    ssize_t ignored = write(d->event, &one, sizeof one); /* all is there: somebody may wait */
    (void)ignored;
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
    d->reading = false;
    if (d->recovery.result != RECOVERY_OK)
        return false;
    d->snapshot_lsn = d->recovery.replay.snapshot;
    d->earlier_bytes = d->recovery.log_bytes;
    if (!adopt_sets(s)) {
        notice(NOTICE_ERROR, "out of memory");
        return false;
    }
    recovery_clear(&d->recovery);
    log_status(d->log, &d->status);
    s->held.durable = d->status.durable;
    rebuild_next(s);
    return true;
}

bool durable_is_complete(const struct server *s)
{
    const struct durable *d = s->durable;
    return d == NULL || (!d->reading && d->rebuilt == d->rebuilds);
}

/* ---- snapshots ---- */

static void put_off(struct server *s)
{
    struct durable *d = s->durable;
    d->rotating = d->resuming = false;
    d->retry_ms = clock_ms() + RETRY_MS;
    /* Those who wait have waited for this; they are told rather than left hanging. */
    if (d->status.state == LOG_FAILED)
        holders_fail(&s->held);
}

static void begin_snapshot(struct server *s)
{
    struct durable *d = s->durable;
    d->mending = d->status.state == LOG_FAILED;
    d->earlier_bytes += d->status.bytes;
    d->cut = log_rotate(d->log);
    d->snapshot = snapshot_begin(&d->dir, &s->sets, d->cut, d->event);
    d->rotating = d->snapshot != NULL;
    if (d->snapshot == NULL)
        put_off(s);
}

/* Lets the snapshot go when the new segment is there; a failed log needs none now. */
static void continue_rotation(struct server *s)
{
    struct durable *d = s->durable;
    bool failed = d->status.state == LOG_FAILED;
    if (failed && !d->mending) { /* it has failed on the way: from the beginning, for that */
        d->rotating = false;
        snapshot_end(d->snapshot, &s->sets);
        d->snapshot = NULL;
    } else if (failed || d->status.segment > d->cut) {
        d->rotating = false;
        snapshot_go(d->snapshot);
    }
}

static void end_snapshot(struct server *s)
{
    struct durable *d = s->durable;
    uint64_t bytes = d->snapshot->bytes;
    int error = snapshot_end(d->snapshot, &s->sets);
    d->snapshot = NULL;
    if (error != 0) {
        notice(NOTICE_ERROR, "a snapshot could not be written: %s", strerror(error));
        put_off(s);
        return;
    }
    d->snapshot_lsn = d->cut;
    d->snapshot_bytes = bytes;
    d->snapshots++;
    d->earlier_bytes = 0;
    notice(NOTICE_INFO, "a snapshot of %" PRIu64 " bytes was written", bytes);
    if (d->status.state == LOG_FAILED && d->mending) {
        d->resuming = true;
        d->failures = d->status.failures;
        log_resume(d->log, d->cut);
    }
}

static void watch_resumption(struct server *s)
{
    struct durable *d = s->durable;
    if (d->status.state != LOG_FAILED) {
        d->resuming = false;
        holders_recover(&s->held);
        notice(NOTICE_INFO, "the log goes on");
    } else if (d->status.failures > d->failures) {
        put_off(s);
    }
}

static bool wants_snapshot(const struct server *s)
{
    const struct durable *d = s->durable;
    uint64_t limit = s->config->compact_at;
    if (d->snapshot_bytes > limit) /* so that writing it costs no more than the log did */
        limit = d->snapshot_bytes;
    switch (d->status.state) {
    case LOG_FAILED:
        return true;
    case LOG_FULL: /* what was freed meanwhile may be enough */
        return log_last(d->log) != d->full_lsn;
    default:
        return d->earlier_bytes + d->status.bytes > limit;
    }
}

/* One look at log and snapshot, and the next step of whatever is under way. */
static void step(struct server *s)
{
    struct durable *d = s->durable;
    uint64_t durable = d->status.durable;
    log_status(d->log, &d->status);
    if (d->status.durable > durable)
        holders_release(&s->held, d->status.durable);
    if (d->snapshot != NULL)
        snapshot_release(d->snapshot, &s->sets);
    if (d->snapshot != NULL && d->snapshot->done)
        end_snapshot(s);
    if (d->resuming)
        watch_resumption(s);
    if (d->rotating)
        continue_rotation(s);
    bool idle = d->snapshot == NULL && !d->rotating && !d->resuming;
    if (!idle || s->stopping || clock_ms() < d->retry_ms || !wants_snapshot(s))
        return;
    if (d->status.state == LOG_FULL) {
        d->full_lsn = log_last(d->log);
        d->retry_ms = clock_ms() + RETRY_MS;
    }
    begin_snapshot(s);
    if (d->rotating)
        continue_rotation(s);
}

void cmd_snapshot(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct durable *d = s->durable;
    (void)set, (void)q;
    if (d == NULL) {
        reply_err(a->out, ERR_IO, "there is no data directory (--data)");
        return;
    }
    if (d->snapshot != NULL || d->resuming) {
        reply_err(a->out, ERR_BUSY, "a snapshot is being written");
        return;
    }
    begin_snapshot(s);
    if (d->snapshot == NULL) {
        answer_out_of_memory(a);
        return;
    }
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "lsn", d->cut);
    reply_end(a->out);
}

/* ---- events ---- */

bool durable_on_event(struct server *s)
{
    struct durable *d = s->durable;
    uint64_t count;
    ssize_t ignored = read(d->event, &count, sizeof count);
    (void)ignored;
    if (d->reading && d->read && !end_reading(s))
        return false;
    if (d->log != NULL && !d->reading)
        step(s);
    return true;
}

void durable_tick(struct server *s)
{
    struct durable *d = s->durable;
    if (d == NULL || d->reading || d->log == NULL)
        return;
    if (d->status.state == LOG_FULL)
        log_refill_reserve(d->log);
    step(s);
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
    if (d == NULL || d->reading || d->log == NULL)
        return;
    log_push(d->log);
    reservation_set(&s->queued, log_queued(d->log));
    if (!is_behind(s) || d->status.state != LOG_GOOD)
        wait_call(&s->log);
}

void durable_stop(struct server *s)
{
    struct durable *d = s->durable;
    if (d == NULL)
        return;
    d->recovery.cancel = true;
    if (d->reading)
        pthread_join(d->reader, NULL);
    recovery_clear(&d->recovery);
    if (d->snapshot != NULL)
        snapshot_end(d->snapshot, &s->sets);
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
    if (d == NULL || !d->reading)
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
    bool full = d->status.error == ENOSPC || d->status.error == EDQUOT;
    if (d->status.state != LOG_GOOD && !(frees && full)) {
        reply_err(a->out, ERR_READONLY, "nothing can be saved now: %s%s", strerror(d->status.error),
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
    if (d->reading || d->log == NULL)
        return;
    f->loaded_percent = durable_is_complete(s) ? 100 : 99; /* triangulations are still made */
    f->state =
        durable_is_complete(s) || d->status.state != LOG_GOOD ? state[d->status.state] : "loading";
    f->lsn = log_last(d->log);
    f->durable_lsn = d->status.durable;
    f->synced_lsn = d->status.synced;
    f->log_bytes = d->earlier_bytes + d->status.bytes;
    f->log_syncs = d->status.syncs;
    f->log_failures = d->status.failures;
    f->snapshot_lsn = d->snapshot_lsn;
    f->snapshot_bytes = d->snapshot_bytes;
    f->snapshots = d->snapshots;
    f->snapshot_running = d->snapshot != NULL;
}
