/* backup.h - a copy of a data directory that is in use.
 *
 * A backup is a directory that --data can read. It has the newest snapshot, the segments of the log after it, and the
 * part of the segment in use that was durable at one moment. Only that segment ever grows. The other segments and the snapshot
 * get hard links, which take neither time nor space. If a link is impossible, as on another file system, they are
 * copied. The daemon never changes a file that has a
 * link: it only removes names.
 *
 * The steps: make NAME.tmp, fill it, sync it, rename it to NAME, sync the directory. So there is all of a
 * backup under its name, or nothing. The next backup removes the *.tmp directories of killed daemons. */
#pragma once

#include "server/disk/datadir.h"
#include "server/disk/log.h"

enum { BACKUP_NAME_LIMIT = 64 };

enum backup_result {
    BACKUP_OK,
    BACKUP_EXISTS, /* there is something of that name, and it is not an empty directory */
    BACKUP_BUSY,   /* another backup is being written to the directory of backups */
    BACKUP_LOG_FAILED,
    BACKUP_CANCELLED,
    BACKUP_ERROR
};

struct backup {
    struct datadir *dir; /* borrows, as all up to `cancel` */
    struct log *log;
    const char *under; /* the directory of backups, which is created if it is missing */
    const atomic_bool *cancel;
    uint64_t least; /* every change up to this lsn is to be in it */
    char name[BACKUP_NAME_LIMIT + 1];
    /* what was written */
    uint64_t lsn; /* every change up to this one is in it */
    uint64_t files, bytes, copied;
    int error; /* errno; BACKUP_LOG_FAILED: of the log */
};

/* Whether a backup may have that name: 1 to 64 of A-Z a-z 0-9 _ . : -, without `.` in front or `.tmp` at
 * the end. */
bool backup_may_name(const char *text, size_t len);

/* Writes the backup. It reads and writes files, so it is for a thread that may wait. */
enum backup_result backup_write(struct backup *b);
