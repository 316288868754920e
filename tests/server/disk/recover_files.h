/* recover_files.h - a directory whose files are composed record by record, for tests of
 * recovery. */
#pragma once

#include "server/disk/recover.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <string.h>

enum { RECORDS = 16 };

/* ---- files to read ---- */

struct bench {
    struct directory directory;
    struct datadir dir;
    struct recovery r;
    struct buf bytes;    /* of the file that is being composed */
    size_t end[RECORDS]; /* of its records, by lsn */
};

static inline void begin(struct bench *b)
{
    *b = (struct bench){.directory = directory_quick()};
    CHECK(datadir_open(&b->dir, b->directory.path, false));
}

static inline void end(struct bench *b)
{
    recovery_clear(&b->r);
    datadir_close(&b->dir);
    buf_free(&b->bytes);
    directory_remove(&b->directory);
}

static inline void begin_file(struct bench *b, enum segment_kind kind, uint64_t lsn)
{
    struct segment header = {.version = RECORD_VERSION, .kind = kind, .lsn = lsn};
    buf_free(&b->bytes);
    segment_write(buf_reserve(&b->bytes, SEGMENT_HEADER), &header);
    buf_commit(&b->bytes, SEGMENT_HEADER);
}

/* Appends a record about the set t. */
static inline void put(struct bench *b, struct record r)
{
    CHECK(r.lsn < RECORDS);
    if (r.type != RECORD_CHUNK && r.type != RECORD_END) {
        r.name = "t";
        r.name_len = 1;
    }
    record_write(&b->bytes, &r);
    b->end[r.lsn] = buf_len(&b->bytes);
}

static inline void put_point(struct bench *b, uint64_t lsn, uint64_t synced, uint32_t id)
{
    double p[] = {id, 1};
    put(b, (struct record){
               .lsn = lsn, .synced = synced, .type = RECORD_ADD, .first = id, .n = 1, .items = p});
}

static inline void path_of(const struct bench *b, enum datafile_kind kind, uint64_t lsn,
                           char path[128])
{
    char name[DATAFILE_NAME];
    datafile_name(name, kind, lsn);
    snprintf(path, 128, "%s/%s", b->directory.path, name);
}

static inline void end_file(const struct bench *b, enum datafile_kind kind, uint64_t lsn)
{
    char path[128];
    path_of(b, kind, lsn, path);
    file_write(path, buf_head(&b->bytes), buf_len(&b->bytes));
}

/* A log of n points that reports none of them as synced. */
static inline void write_unsynced(struct bench *b, uint32_t points)
{
    begin_file(b, SEGMENT_LOG, 1);
    for (uint32_t i = 0; i < points; i++)
        put_point(b, i + 1, 0, i);
    end_file(b, DATAFILE_LOG, 1);
}

static inline void read_all(struct bench *b)
{
    recovery_init(&b->r, &b->dir);
    recovery_run(&b->r);
}

static inline uint32_t points_of_t(const struct bench *b)
{
    struct word name = {"t", 1};
    struct dataset *set = registry_find(&b->r.replay.sets, &name);
    return set == NULL ? 0 : dt_next_id(set->current->dt);
}
