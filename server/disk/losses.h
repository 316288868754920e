/* losses.h - the sets that are lost with a damaged snapshot, as --repair finds them (salvage.h). */
#pragma once

#include "proto/records/record.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct loss {
    uint32_t points;  /* in the snapshot */
    uint64_t changes; /* of it in the log, which are lost too */
    bool known;       /* its name is in the snapshot; else only in the log */
    size_t name_len;
    char name[RECORD_NAME_LIMIT + 1];
};

struct losses {
    struct loss *v; /* owns */
    size_t n, cap;
    size_t sets;      /* whose names are in the snapshot, intact or not */
    size_t announced; /* sets that the snapshot had in all; SIZE_MAX: unknown */
    bool empty;       /* a set whose name is lost may have had no points */
    bool failed;      /* out of memory */
};

void losses_clear(struct losses *l);

/* The set of this RECORD_SET is lost. */
void losses_add(struct losses *l, const char *name, size_t name_len, uint32_t points);

/* Whether a record of the log, whose set does not exist, is about a lost set. Records that; a DROP means that
 * the set is no loss. */
bool losses_take(struct losses *l, const struct record *r);

/* Prints a line for each. */
void losses_print(const struct losses *l, FILE *out);
