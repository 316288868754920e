/* recover.h - reads a data directory: the newest snapshot, then the log from there on.
 *
 * Torn or corrupt? Behind a damaged record, the rest of the log is searched for records that say that it
 * was synced (record.h). If one does, acknowledged changes are damaged: that is corruption, and the daemon
 * does not start. If none does, the end of the log was torn off by a crash, and is cut off. That is certain
 * only if the file ends within a record or within a LOAD. Otherwise the rest may have changes that were
 * acknowledged without a sync: it counts as lost, and is put aside first. */
#pragma once

#include "server/disk/datadir.h"
#include "server/disk/replay.h"

#include <stdatomic.h>
#include <stdio.h>

enum recovery_result {
    RECOVERY_OK,
    RECOVERY_CORRUPT, /* a segment is damaged at `at`; --repair would cut it off there */
    RECOVERY_REFUSED, /* the rest cannot be read; see bad_snapshot and bad_log */
    RECOVERY_ERROR,   /* out of memory, or the disk cannot be read */
    RECOVERY_CANCELLED
};

struct recovery {
    struct datadir *dir; /* borrows */
    FILE *report;        /* borrows; gets a line for each file; NULL: none */
    bool pass_over;      /* ignore the newest snapshot */
    bool mend; /* for --repair: bad_log does not end the reading, only RECOVERY_CORRUPT does */
    atomic_bool cancel;
    atomic_ullong done, total; /* bytes */
    enum recovery_result result;
    char why[512]; /* the reason, unless RECOVERY_OK; with it, if the end was torn off */
    struct replay replay;
    uint64_t log_bytes;       /* of the segments that were read */
    struct lineage lineage;   /* the last one that a segment has */
    uint64_t last;            /* the lsn of the last change */
    uint64_t digest;          /* of the changes up to it; 0: unknown */
    uint64_t snapshot_digest; /* of those up to the snapshot */
    uint64_t ahead;           /* the same, or the lsn of a later one that only the snapshot has */
    struct datafile file;     /* the segment that is torn or corrupt */
    uint64_t at;              /* from this offset on */
    bool torn;
    bool aside;         /* the torn end may have changes, and is put aside */
    bool lost;          /* the same, before it is put aside */
    bool used;          /* the directory shows that there was a log */
    uint64_t synced_at; /* the last segment was certainly synced up to this offset */
    bool bad_snapshot;  /* RECOVERY_REFUSED because of the snapshot; --repair may keep most of it */
    bool bad_log;   /* because of a segment's header, a missing segment, or an impossible record */
    uint64_t later; /* RECOVERY_CORRUPT, or torn: intact records that follow */
};

void recovery_init(struct recovery *r, struct datadir *dir);

/* Reads everything; changes nothing on the disk. */
void recovery_run(struct recovery *r);

/* Reads only the log among the files, from r->replay.snapshot on. */
void recovery_log(struct recovery *r, const struct datafiles *files);

/* Prepares the directory for new changes: cuts off the torn end, removes incomplete snapshots, and syncs what
 * was read, since the process that wrote it may have been killed before its sync. False: the reason is in
 * r->why, which also describes a torn end. */
bool recovery_tidy(struct recovery *r);

void recovery_clear(struct recovery *r);

/* The share that has been read, 0 to 100. */
unsigned recovery_percent(struct recovery *r);
