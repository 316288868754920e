/* saver.h - decides when a snapshot is written, and how the log continues after a failure. A reactor
 * calls it on every notification of the log or of the snapshot's thread, and once a second.
 *
 *            the log is good            its new segment is there
 *     IDLE --------------------> ROTATING ---------------------> WRITING --> IDLE
 *       \
 *        \   the log has failed              in place           the log continues
 *         +--------------------> MENDING --------------> RESUMING --------------> IDLE
 *
 * While the log works, a snapshot makes it shorter. After a failure of the log, whose contents are unknown
 * then, a snapshot is the only way to make later changes durable: it begins at once, and the log continues
 * behind it. Any failure leads back to IDLE, with a retry at growing intervals (backoff.h). */
#pragma once

#include "server/disk/backoff.h"
#include "server/disk/log.h"
#include "server/disk/reply_hold.h"
#include "server/disk/snapshot.h"
#include "server/sets/dataset.h"

enum saver_state { SAVER_IDLE, SAVER_ROTATING, SAVER_WRITING, SAVER_MENDING, SAVER_RESUMING };

struct saver {
    struct datadir *dir; /* borrows, as all up to `event` */
    struct registry *sets;
    struct holders *held; /* replies that wait for the log (reply_hold.h) */
    struct log *log;
    const size_t *compact_at; /* bytes of log after which a snapshot is due */
    int event;                /* an eventfd */
    enum saver_state state;
    struct log_status status; /* when it was last read */
    int lost; /* errno: the directory is not in its place (datadir_in_place); 0: it is */
    struct snapshot *snapshot; /* owns; from ROTATING or MENDING on, until it is in place */
    uint64_t cut;              /* the lsn of `snapshot`, or of the last one */
    /* borrows: the digest of all changes, of a follower (server/follow); NULL: unknown */
    const uint64_t *applied;
    uint64_t cut_digest; /* after a failure: what the log continues from */
    uint64_t cut_bytes;  /* bytes of log up to there */
    uint64_t base_bytes; /* bytes of log that the snapshot in place covers */
    uint64_t read_bytes; /* bytes of log that were read at the start and are in no snapshot */
    uint64_t failures;   /* of the log, when log_resume was called */
    bool unproven;       /* the log has resumed, and nothing has been durable since */
    struct backoff compaction, mending;
    int64_t ended_ms; /* when the last snapshot was complete or failed */
    /* of the snapshot in place */
    uint64_t snapshot_lsn, snapshot_bytes;
    uint64_t snapshots; /* so far */
};

/* Checks the log and the snapshot, and does the next step; begins a snapshot if one is due, unless
 * `stopping`. */
void saver_step(struct saver *v, int64_t now_ms, bool stopping);

/* Begins a snapshot now, in state IDLE; its lsn is v->cut. False: out of memory. */
bool saver_begin(struct saver *v, int64_t now_ms);

/* Cancels a snapshot that is being written. */
void saver_clear(struct saver *v);

/* Bytes of log that the snapshot in place does not cover. */
uint64_t saver_log_bytes(const struct saver *v);

/* The errno why the log has failed or is full, and the directory's if it is not in its place. */
int saver_error(const struct saver *v);

/* Whether the disk is full, so that only changes that free space are possible. */
bool saver_disk_is_full(const struct saver *v);

/* Failed attempts in a row, and milliseconds until the next attempt. */
unsigned saver_failures(const struct saver *v);
int64_t saver_retry_ms(const struct saver *v, int64_t now_ms);
