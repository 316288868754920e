/* saver.c - see saver.h. */
#include "server/disk/saver.h"

#include "server/system/notice.h"
#include "server/system/own_file.h"
#include "server/system/random.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

static bool log_has_failed(const struct saver *v)
{
    return v->status.state == LOG_FAILED;
}

int saver_error(const struct saver *v)
{
    return log_has_failed(v) && v->lost != 0 ? v->lost : v->status.error;
}

bool saver_disk_is_full(const struct saver *v)
{
    return own_file_lacks_space(v->status.error);
}

uint64_t saver_log_bytes(const struct saver *v)
{
    return v->read_bytes + v->status.total - v->base_bytes;
}

/* ---- the state of the log ---- */

/* The log accepts changes again; the next change shows whether that lasts. */
static void note_recovery(struct saver *v)
{
    v->unproven = true;
    holders_recover(v->held, HOLD_DISK);
    notice(NOTICE_INFO, "the log continues");
}

static void look_at_log(struct saver *v, int64_t now_ms)
{
    bool failed = log_has_failed(v);
    uint64_t durable = v->status.durable;
    log_status(v->log, &v->status);
    if (v->status.durable > durable)
        holders_release(v->held, v->status.durable);
    if (failed && !log_has_failed(v))
        note_recovery(v);
    else if (!failed && log_has_failed(v) && v->unproven) /* it had not recovered */
        backoff_failed(&v->mending, now_ms);
    if (v->unproven && !log_has_failed(v) && v->status.durable > v->cut) {
        v->unproven = false;
        backoff_succeeded(&v->mending);
    }
}

/* ---- steps ---- */

static void end_snapshot(struct saver *v)
{
    snapshot_end(v->snapshot, v->sets);
    v->snapshot = NULL;
}

/* The snapshot, or the log after it, has failed. */
static void give_up(struct saver *v, int64_t now_ms)
{
    backoff_failed(v->state == SAVER_MENDING || v->state == SAVER_RESUMING ? &v->mending
                                                                           : &v->compaction,
                   now_ms);
    v->state = SAVER_IDLE;
    v->ended_ms = now_ms;
}

/* The digest of all changes so far, some of which the log may have lost: the leader's digest, or a new one. */
static uint64_t new_digest(const struct saver *v)
{
    return v->applied != NULL && *v->applied != 0 ? *v->applied : random_bits();
}

bool saver_begin(struct saver *v, int64_t now_ms)
{
    v->state = log_has_failed(v) ? SAVER_MENDING : SAVER_ROTATING;
    v->cut = log_rotate(v->log, NULL);
    v->cut_bytes = v->status.total;
    v->snapshot = snapshot_begin(v->dir, v->sets, v->cut, v->event);
    if (v->snapshot == NULL)
        give_up(v, now_ms);
    else if (v->state == SAVER_MENDING)
        snapshot_go(v->snapshot, v->cut_digest = new_digest(v));
    return v->snapshot != NULL;
}

static void step_rotating(struct saver *v)
{
    if (log_has_failed(v)) { /* another snapshot begins at once, without a new segment */
        end_snapshot(v);
        v->state = SAVER_IDLE;
    } else if (v->status.rotated > v->cut) {
        v->state = SAVER_WRITING;
        v->cut_bytes = v->status.total - v->status.bytes;
        snapshot_go(v->snapshot, v->status.rotated_digest);
    }
}

static void note_snapshot(struct saver *v, uint64_t bytes, int64_t now_ms)
{
    v->ended_ms = now_ms;
    v->snapshot_lsn = v->cut;
    v->snapshot_bytes = bytes;
    v->snapshots++;
    v->read_bytes = 0;
    v->base_bytes = v->cut_bytes;
    notice(NOTICE_INFO, "a snapshot of %" PRIu64 " bytes was written", bytes);
}

static void step_writing(struct saver *v, int64_t now_ms)
{
    snapshot_release(v->snapshot, v->sets);
    if (!v->snapshot->done)
        return;
    uint64_t bytes = v->snapshot->bytes;
    int error = snapshot_end(v->snapshot, v->sets);
    v->snapshot = NULL;
    if (error != 0) {
        give_up(v, now_ms);
        notice_error("a snapshot could not be written: %s; the next attempt is in %.1f s",
                     datadir_error(error), (double)saver_retry_ms(v, now_ms) / 1000);
        return;
    }
    note_snapshot(v, bytes, now_ms);
    if (v->state == SAVER_WRITING) {
        backoff_succeeded(&v->compaction);
        v->state = SAVER_IDLE;
    } else {
        v->state = SAVER_RESUMING;
        v->failures = v->status.failures;
        log_resume(v->log, v->cut, v->cut_digest);
    }
}

static void step_resuming(struct saver *v, int64_t now_ms)
{
    if (!log_has_failed(v)) {
        v->state = SAVER_IDLE;
    } else if (v->status.failures > v->failures) {
        give_up(v, now_ms);
    }
}

/* ---- what to begin ---- */

/* Whether the disk was full, and points may have been deleted since the last attempt. */
static bool may_have_space(const struct saver *v)
{
    return saver_disk_is_full(v) && log_last(v->log) > v->cut;
}

static bool is_rested(const struct saver *v, int64_t now_ms)
{
    return now_ms >= v->ended_ms + BACKOFF_FIRST_MS;
}

static bool may_mend(struct saver *v, int64_t now_ms)
{
    v->lost = datadir_regain(v->dir) ? 0 : errno;
    if (v->lost != 0) /* there is nothing to write to */
        return false;
    return may_have_space(v) ? is_rested(v, now_ms) : backoff_allows(&v->mending, now_ms);
}

static bool is_due(struct saver *v, int64_t now_ms)
{
    uint64_t limit = *v->compact_at;
    if (v->snapshot_bytes > limit) /* so that snapshots cost no more than the log */
        limit = v->snapshot_bytes;
    switch (v->status.state) {
    case LOG_FAILED:
        return may_mend(v, now_ms);
    case LOG_FULL:
        return may_have_space(v) && is_rested(v, now_ms);
    default:
        return saver_log_bytes(v) > limit && backoff_allows(&v->compaction, now_ms);
    }
}

void saver_step(struct saver *v, int64_t now_ms, bool stopping)
{
    look_at_log(v, now_ms);
    switch (v->state) {
    case SAVER_IDLE:
        break;
    case SAVER_ROTATING:
        step_rotating(v);
        break;
    case SAVER_WRITING:
    case SAVER_MENDING:
        step_writing(v, now_ms);
        break;
    case SAVER_RESUMING:
        step_resuming(v, now_ms);
        break;
    }
    if (v->state == SAVER_IDLE && !stopping && is_due(v, now_ms))
        saver_begin(v, now_ms);
    /* No attempt is under way: replies that wait for the log get an error. */
    if (v->state == SAVER_IDLE && log_has_failed(v) && !may_have_space(v))
        holders_fail(v->held, HOLD_DISK);
}

void saver_clear(struct saver *v)
{
    if (v->snapshot != NULL)
        end_snapshot(v);
}

/* ---- for INFO ---- */

static const struct backoff *backoff_of(const struct saver *v)
{
    return log_has_failed(v) ? &v->mending : &v->compaction;
}

unsigned saver_failures(const struct saver *v)
{
    return backoff_of(v)->failures;
}

int64_t saver_retry_ms(const struct saver *v, int64_t now_ms)
{
    const struct backoff *b = backoff_of(v);
    return v->state != SAVER_IDLE || backoff_allows(b, now_ms) ? 0 : b->next_ms - now_ms;
}
