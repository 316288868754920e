/* log.h - the log of all changes: appended by the I/O thread, written and synced by a thread of its
 * own, so that the disk holds nobody up but those who wait for it.
 *
 * Group commit: what has been appended while the disk was busy is written and synced together. A
 * record is durable when it has been synced (LOG_ALWAYS) or written (otherwise: it survives the
 * process, and the machine only once synced: within a second or so with LOG_EVERYSEC, whenever the
 * system likes with LOG_NO).
 *
 * After a failed write or sync nobody knows what is on the disk, and a sync that is tried again on
 * the same descriptor may lie. So the descriptor is given up (LOG_FAILED) and what is appended from
 * then on waits in memory, until log_resume tells that a snapshot has everything up to some lsn:
 * from there a new segment goes on. */
#ifndef SERVER_LOG_H
#define SERVER_LOG_H

#include "proto/record.h"
#include "server/disk/datadir.h"
#include "server/ops/config.h"

enum log_state {
    LOG_GOOD,
    LOG_FULL,  /* the disk is full: the reserve is in use, for what frees space */
    LOG_FAILED /* nothing is written any more */
};

struct log_status {
    enum log_state state;
    int error;        /* errno of the failure that led to LOG_FULL or LOG_FAILED */
    uint64_t durable; /* lsn up to which replies may be sent */
    uint64_t synced;  /* lsn up to which all is on the disk */
    uint64_t segment; /* first lsn of the current segment */
    uint64_t bytes;   /* of the current segment */
    uint64_t total;   /* of this and all segments before it since the start */
    uint64_t syncs, failures;
};

struct log;

/* Starts a segment whose first record will have the lsn `first`, and the thread. `event` is an
 * eventfd (borrowed) that is written when the status has changed. NULL: the reason is on standard
 * error. */
struct log *log_new(const struct datadir *dir, enum log_policy policy, uint64_t first, int event);

/* Writes and syncs everything, ends the thread. */
void log_free(struct log *log);

/* ---- the I/O thread's side ---- */

/* Gives the record the next lsn, which is returned, and takes a copy. Running out of memory counts
 * as a failed write: the state becomes LOG_FAILED. */
uint64_t log_append(struct log *log, struct record *r);

/* The same for an ADD of n points at xy (x, y each; from dt_pages_grow, now the log's). */
uint64_t log_append_points(struct log *log, struct record *r, double *xy);

/* Appends records that say nothing, up to that lsn: these numbers have been given to changes that a
 * snapshot has, and the log has lost. */
void log_fill(struct log *log, uint64_t lsn);

/* Passes what was appended on to the thread; to be called once a turn. */
void log_push(struct log *log);

/* Bytes of what has been appended and not been written yet. */
size_t log_queued(const struct log *log);

/* The lsn of the last record so far. */
uint64_t log_last(const struct log *log);

/* Asks for a new segment that begins after the records so far; returns the lsn of the last of
 * these. When it is there, status.segment is one more. */
uint64_t log_rotate(struct log *log);

/* After LOG_FAILED: every change up to lsn is safe in a snapshot; goes on in a new segment from
 * lsn + 1. lsn is what log_rotate has returned. */
void log_resume(struct log *log, uint64_t lsn);

/* In LOG_FULL: looks whether the reserve can be had again. */
void log_refill_reserve(struct log *log);

void log_status(struct log *log, struct log_status *status);

#endif
