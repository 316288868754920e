/* saver.h - decides when a snapshot is written, and what follows a failure of the log. The I/O thread
 * calls it whenever the log or the snapshot's thread has something to tell, and once a second.
 *
 *            the log is good            its new segment is there
 *     IDLE --------------------> ROTATING ---------------------> WRITING --> IDLE
 *       \
 *        \   the log has failed              in place             the log goes on
 *         +--------------------> MENDING --------------> RESUMING --------------> IDLE
 *
 * A snapshot in good times makes the log shorter. After a failure of the log it is the only way for
 * the changes since to become durable, since nobody knows what is in the log: then it begins at
 * once, and the log goes on behind it. Whatever fails leads back to IDLE, and is tried again later,
 * at longer and longer intervals (backoff.h). */
#ifndef SERVER_SAVER_H
#define SERVER_SAVER_H

#include "server/disk/hold.h"
#include "server/disk/log.h"
#include "server/disk/snapshot.h"
#include "server/sets/dataset.h"
#include "server/system/backoff.h"

enum saver_state { SAVER_IDLE, SAVER_ROTATING, SAVER_WRITING, SAVER_MENDING, SAVER_RESUMING };

struct saver {
    const struct datadir *dir; /* borrows, as all up to `event` */
    struct registry *sets;
    struct holders *held; /* replies that wait for the log */
    struct log *log;
    const size_t *compact_at; /* bytes of log after which a snapshot is due */
    int event;                /* an eventfd */
    enum saver_state state;
    struct log_status status;  /* at the last look */
    struct snapshot *snapshot; /* owns; from ROTATING or MENDING on, until it is in place */
    uint64_t cut;              /* its lsn; of the last one, when there is none */
    uint64_t cut_bytes;        /* of log up to there */
    uint64_t base_bytes;       /* of log that the snapshot in place has */
    uint64_t read_bytes;       /* of log that was read at the start, and is in no snapshot yet */
    uint64_t failures;         /* of the log when it was told to go on */
    bool unproven;             /* it has gone on, and has saved nothing since */
    struct backoff compaction, mending;
    int64_t ended_ms; /* when the last snapshot was in place, or given up */
    /* of the snapshot in place */
    uint64_t snapshot_lsn, snapshot_bytes;
    uint64_t snapshots; /* so far */
};

/* Looks at the log and the snapshot, and does the next step of what is under way; begins something
 * unless `stopping`. */
void saver_step(struct saver *v, int64_t now_ms, bool stopping);

/* Begins a snapshot now, in state IDLE; its lsn is v->cut. False: out of memory. */
bool saver_begin(struct saver *v, int64_t now_ms);

/* Gives up what is under way. */
void saver_clear(struct saver *v);

/* Bytes of log that the snapshot in place does not have. */
uint64_t saver_log_bytes(const struct saver *v);

/* Whether the log takes no changes but those that free space, because the disk is full. */
bool saver_disk_is_full(const struct saver *v);

/* Attempts in a row that have failed, and milliseconds until the next one. */
unsigned saver_failures(const struct saver *v);
int64_t saver_retry_ms(const struct saver *v, int64_t now_ms);

#endif
