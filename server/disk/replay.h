/* replay.h - applies records to sets. */
#pragma once

#include "proto/records/record.h"
#include "server/changes/assembly.h"
#include "server/disk/losses.h"

#include <stdatomic.h>

struct replay {
    /* owns; each set's lsn, version and triangulated are those of its records; its life is that of the segment that is being read */
    struct registry sets;
    uint64_t snapshot;         /* changes up to this lsn are in the snapshot */
    bool out_of_memory;        /* a record was refused for this reason; the data may be good */
    const atomic_bool *cancel; /* borrows; when it is set, any record may fail; NULL: never */
    struct losses *losses;     /* borrows: records of these sets are skipped; NULL: none */
    /* private */
    struct assembly load;          /* a LOAD that is not complete; skipped if the snapshot has it */
    struct dataset *restoring;     /* the set whose rows, or values, are being read */
    bool has_more, restored;       /* it has fields or constraints; all its rows have been read */
    uint32_t rows, next_id;        /* the number of its rows, and its next id */
    uint32_t *id, *representative; /* own cap, hold n */
    struct dt_point *points;       /* owns the same */
    size_t n, cap;
    uint32_t sets_seen;
    bool ended;
};

void replay_init(struct replay *p);
void replay_clear(struct replay *p);

/* Applies one record of the log, or of a snapshot. Returns NULL, or what is wrong with the record; then a record
 * of the log has changed nothing. */
const char *replay_log(struct replay *p, const struct record *r);
const char *replay_snapshot(struct replay *p, const struct record *r);

/* Whether a LOAD has begun and is not complete. */
bool replay_in_load(const struct replay *p);

/* Drops such a LOAD. */
void replay_abandon_load(struct replay *p);

/* Drops the set of a snapshot whose rows are incomplete, if there is one. */
void replay_abandon_set(struct replay *p);
