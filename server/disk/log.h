/* log.h - the log of all changes: appended by reactors, written and synced by a thread of its own, so
 * that only replies that depend on the disk wait for it.
 *
 * Group commit: records that have been appended while the disk was busy are written and synced together.
 * A record counts as durable when it has been synced (LOG_ALWAYS) or written (otherwise). A written record survives a
 * crash of the process. It survives a power failure only once it is synced, which takes about a second with
 * LOG_EVERYSEC, and any time with LOG_NO.
 *
 * After a failed write or sync the state of the disk is unknown, and a second sync of the same descriptor
 * may wrongly succeed. So the descriptor is closed (LOG_FAILED), and new records stay in memory until log_resume is
 * called, when a snapshot has every change up to some lsn. The log continues after that lsn in a
 * new segment. */
#pragma once

#include "proto/records/record.h"
#include "server/changes/pslg.h"
#include "server/disk/datadir.h"
#include "server/ops/config.h"

enum log_state {
    LOG_GOOD,
    LOG_FULL,  /* the disk is full: the reserve is in use, for changes that free space */
    LOG_FAILED /* nothing is written any more */
};

struct log_status {
    enum log_state state;
    int error;        /* errno of the failure that led to LOG_FULL or LOG_FAILED */
    uint64_t durable; /* changes up to this lsn are durable: replies may be sent */
    uint64_t synced;  /* changes up to this lsn are synced */
    uint64_t digest;  /* of the changes up to `durable` */
    uint64_t segment; /* first lsn of the current segment */
    uint64_t rotated; /* first lsn of the last segment that log_rotate or the start has begun */
    uint64_t rotated_digest; /* of the changes before it */
    uint64_t bytes;          /* of the current segment */
    uint64_t total;          /* of this and all segments before it since the start */
    uint64_t syncs, failures;
};

struct log;

/* Starts the thread, and a segment of dir->lineage whose first record will have the lsn `first`; digest: of the
 * changes before it; 0: a new one begins. `event` is an eventfd (borrowed) that is written when the status has
 * changed. NULL: the reason is on standard error. */
struct log *log_new(const struct datadir *dir, enum log_policy policy, uint64_t first,
                    uint64_t digest, int event);

/* Writes and syncs everything, then ends the thread. */
void log_free(struct log *log);

/* Whether log_free appends RECORD_CLOSE; it does unless this says otherwise. */
void log_close_mark(struct log *log, bool writes);

/* ---- for reactors, any of them at any time ---- */

/* Appends a copy of the record with the next lsn, which is returned. Running out of memory counts as a failed
 * write: the state becomes LOG_FAILED. */
uint64_t log_append(struct log *log, struct record *r);

/* The same for records bytes[n] of another log, whose lsns are the next ones here: one record, or all of a LOAD. Returns the
 * lsn of the last one. */
uint64_t log_append_copy(struct log *log, const char *bytes, size_t n);

/* Appends a LOAD of n items (from dt_pages_grow), or none, in records of r->type, together with values (NULL: none) and
 * constraints (NULL: none), all of which move to the log. */
uint64_t log_append_load(struct log *log, struct record *r, void *items, struct columns *v,
                         struct pslg_lists *d);

/* Appends empty records up to that lsn: these numbers belong to changes that a snapshot has but the log has
 * lost. */
void log_fill(struct log *log, uint64_t lsn);

/* Has the thread write the appended records; to be called at the end of a turn. */
void log_push(struct log *log);

/* Bytes that have been appended but not written yet. */
size_t log_queued(const struct log *log);

/* The lsn of the last record so far. */
uint64_t log_last(const struct log *log);

/* Requests a new segment, which begins after the records so far; returns the lsn of the last of them. When
 * the segment exists, status.rotated is one more. l: the lineage that this and later segments have; NULL: the same as before. */
uint64_t log_rotate(struct log *log, const struct lineage *l);

/* After LOG_FAILED: every change up to lsn is in a durable snapshot, which has this digest for them; continues in a new
 * segment from lsn + 1. lsn is from log_rotate. */
void log_resume(struct log *log, uint64_t lsn, uint64_t digest);

/* To be called once a second, but not in LOG_FAILED: finds out whether the directory is in its place, and tries to allocate the
 * reserve again if it is missing. */
void log_tend(struct log *log);

void log_status(struct log *log, struct log_status *status);
