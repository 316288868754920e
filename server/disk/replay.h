/* replay.h - turns records back into sets. */
#ifndef SERVER_REPLAY_H
#define SERVER_REPLAY_H

#include "proto/record.h"
#include "server/disk/losses.h"
#include "server/sets/dataset.h"

#include <stdatomic.h>

struct replay {
    struct registry sets;      /* owns; each set's lsn and triangulated are what its records say */
    uint64_t snapshot;         /* changes up to this lsn are in the snapshot */
    bool out_of_memory;        /* what stopped it is no fault of the data */
    const atomic_bool *cancel; /* borrows; once it is set, any record may fail. NULL: never */
    struct losses *losses; /* borrows: records of these sets are passed over; NULL: none is lost */
    /* private */
    bool in_load;   /* a LOAD has begun */
    bool skip_load; /* and the snapshot has it already */
    uint32_t load_first;
    struct dt_point *points; /* owns */
    size_t n, cap;
    struct dataset *restoring;     /* the set whose rows are being read */
    uint32_t rows, next_id;        /* that it has in all; and the next id */
    uint32_t *id, *representative; /* own; beside points */
    uint32_t sets_seen;
    bool ended;
};

void replay_init(struct replay *p);
void replay_clear(struct replay *p);

/* Applies one record of the log, or one of a snapshot. Returns NULL, or what is wrong with it; then a
 * record of the log has changed nothing. */
const char *replay_log(struct replay *p, const struct record *r);
const char *replay_snapshot(struct replay *p, const struct record *r);

/* Whether a LOAD has begun that is not complete. */
bool replay_in_load(const struct replay *p);

/* Forgets such a LOAD. */
void replay_abandon_load(struct replay *p);

/* Forgets the set of a snapshot whose rows are not complete, if there is one. */
void replay_abandon_set(struct replay *p);

#endif
