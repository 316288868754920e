/* losses.h - the sets that a damaged snapshot has lost, while --repair reads on (salvage.h). */
#ifndef SERVER_LOSSES_H
#define SERVER_LOSSES_H

#include "proto/record.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct loss {
    uint32_t points;  /* that it had in the snapshot */
    uint64_t changes; /* in the log, which count no more */
    bool known;       /* it was named in the snapshot; else only in the log */
    size_t name_len;
    char name[RECORD_NAME_LIMIT + 1];
};

struct losses {
    struct loss *v; /* owns */
    size_t n, cap;
    size_t sets;      /* that were named in the snapshot, whether whole or not */
    size_t announced; /* how many it had; SIZE_MAX: nobody knows */
    bool empty;       /* one whose name is lost may have had no points */
    bool failed;      /* out of memory */
};

void losses_clear(struct losses *l);

/* The set of this RECORD_SET is lost. */
void losses_add(struct losses *l, const char *name, size_t name_len, uint32_t points);

/* Whether a record of the log is about a set that is lost; it names one that is not there. Takes
 * note of it; a DROP means that nobody will miss the set. */
bool losses_take(struct losses *l, const struct record *r);

/* A line for each. */
void losses_tell(const struct losses *l, FILE *out);

#endif
