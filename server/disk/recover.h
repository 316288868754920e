/* recover.h - reads a data directory back: the newest snapshot, then the log from there on.
 *
 * Torn or corrupt? Where a record is damaged, whatever follows is searched for records that say it
 * was synced (record.h). If one does, acknowledged changes are damaged: that is corruption, and the
 * daemon does not start. If none does, it is the end that a crash has torn off, and it is cut away.
 * Only where the file ends within a record, or within a LOAD, is that certain. Anything else may
 * hold changes that were acknowledged without being synced, and is put aside first. */
#ifndef SERVER_RECOVER_H
#define SERVER_RECOVER_H

#include "server/disk/datadir.h"
#include "server/disk/replay.h"

#include <stdatomic.h>
#include <stdio.h>

enum recovery_result {
    RECOVERY_OK,
    RECOVERY_CORRUPT, /* a log segment is damaged at `at`; --repair would cut it off there */
    RECOVERY_REFUSED, /* it cannot be read on; see bad_snapshot and bad_log */
    RECOVERY_ERROR,   /* out of memory, or the disk cannot be read */
    RECOVERY_CANCELLED
};

struct recovery {
    const struct datadir *dir; /* borrows */
    FILE *report;              /* borrows; NULL; else a line is written for each file */
    bool pass_over;            /* the newest snapshot is not there */
    bool mend; /* what bad_log speaks of keeps nobody from reading on, up to RECOVERY_CORRUPT */
    atomic_bool cancel;
    atomic_ullong done, total; /* bytes */
    enum recovery_result result;
    char why[512]; /* unless RECOVERY_OK; after it, too, if an end was torn off */
    struct replay replay;
    uint64_t log_bytes;   /* of the segments that were read */
    uint64_t last;        /* the lsn of the last change */
    uint64_t ahead;       /* the same, or that of a later one, which only the snapshot has */
    struct datafile file; /* the segment that is torn or corrupt */
    uint64_t at;          /* from this offset on */
    bool torn;
    bool aside;         /* and may hold changes */
    uint64_t synced_at; /* up to this offset the last segment was synced for certain */
    bool bad_snapshot;  /* RECOVERY_REFUSED for that; --repair may keep most of it */
    bool bad_log;   /* for a segment's header, one that is missing, or a record that cannot be */
    uint64_t later; /* RECOVERY_CORRUPT, or torn: whole records that follow */
};

void recovery_init(struct recovery *r, const struct datadir *dir);

/* Reads everything; changes nothing on the disk. */
void recovery_run(struct recovery *r);

/* Only the log among the files, from r->replay.snapshot on. */
void recovery_log(struct recovery *r, const struct datafiles *files);

/* Makes the directory what the log can go on from: cuts off the torn end, removes snapshots that were
 * not finished, and syncs what was read, since those who wrote it may have been killed before they
 * could. False: r->why tells; it does so as well if an end was torn off. */
bool recovery_tidy(struct recovery *r);

void recovery_clear(struct recovery *r);

/* How much has been read, 0 to 100. */
unsigned recovery_percent(struct recovery *r);

/* The commands delaunayd --check DIR and --repair DIR: tell on standard output, return the exit
 * status: 0 if the directory is good (now), 1 if not. */
int recovery_check(const char *path);
int recovery_repair(const char *path);

#endif
