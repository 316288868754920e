/* log_file.h - the segment that the log thread is writing, and the reserve. */
#pragma once

#include "proto/buf.h"
#include "proto/records/record.h"
#include "server/changes/pslg.h"
#include "server/disk/datadir.h"

struct log_file {
    const struct datadir *dir; /* borrows */
    int fd;                    /* -1 after a failure */
    int error;                 /* errno of the failure; 0: none */
    int full_error;            /* errno: why there is no reserve */
    bool reserved;             /* the reserve exists */
    bool unsynced;             /* something was written since the last sync */
    struct lineage lineage;    /* of this segment, and of those that follow */
    uint32_t version;          /* the same */
    bool renamed;              /* these are of the next segment */
    uint64_t first;            /* the lsn of its first record */
    uint64_t digest_before;    /* of the records before it, */
    uint64_t digest;           /* and up to now */
    bool broken;               /* SEGMENT_BROKEN of the next segment */
    uint64_t bytes, mark;
    uint64_t before; /* bytes of the segments before it */
    uint64_t syncs;
    int64_t inspected_ms; /* when log_file_inspect last looked */
};

/* digest: of the changes before it; 0: a new one begins. */
void log_file_init(struct log_file *f, const struct datadir *dir, uint64_t digest);
void log_file_clear(struct log_file *f);

/* Closes the descriptor: nothing is written any more. */
void log_file_fail(struct log_file *f, int error);

/* Syncs and closes the segment, and begins one whose first record will have the lsn `first`. Without
 * an error its name and header are durable when this returns. Does nothing after a failure. */
void log_file_start(struct log_file *f, uint64_t first);

/* The same after a failure, which is cleared: the caller knows that every change before `first` is durable
 * elsewhere. */
void log_file_restart(struct log_file *f, uint64_t first, uint64_t digest);

/* Makes a segment without records, whose first one will have the lsn `first`, durable. False with errno. */
bool log_file_begin(const struct datadir *dir, uint64_t first, uint64_t digest);

/* Marks this position: if the disk is full before the next mark, the segment is truncated to it. */
void log_file_mark(struct log_file *f);

/* Writes and consumes all of b, whole records. */
void log_file_write(struct log_file *f, struct buf *b);

/* Writes a LOAD of load->n items, or none, in records of load->type, of the values v, unless NULL, and of constraints; load->lsn
 * is that of the first record. */
void log_file_write_load(struct log_file *f, const struct record *load, const void *items,
                         const struct columns *v, const struct pslg_lists *d);

/* A failure is final: on Linux a second fsync of the same descriptor reports success for pages that were
 * dropped [Rebello et al., "Can Applications Recover from fsync Failures?", ATC 2020]. */
void log_file_sync(struct log_file *f);

/* Fails if a start would not find the segment any more, because the file or its directory is gone or replaced. Looks at most
 * ten times a second, so it may be called after every write. */
void log_file_inspect(struct log_file *f, int64_t now_ms);

/* Allocates the reserve if it does not exist. */
void log_file_reserve(struct log_file *f);
