/* columns.h - values of fields for ids that follow each other: one column for each field. */
#pragma once

#include "proto/records/record.h"
#include "server/changes/name.h"

struct columns {
    size_t count;
    uint32_t first, n; /* the ids are first .. first + n - 1 */
    double *v;         /* owns, from dt_pages_grow: columns of n values, one after the other */
    struct name field[];
};

/* Room for this number of columns, without values; NULL: out of memory. */
struct columns *columns_new(size_t count);
void columns_free(struct columns *c); /* NULL: nothing */

/* The values of column k, of all; NULL: there are none. */
const double *columns_values(const struct columns *c, size_t k);

/* The number of records for the columns; each has at least one. NULL: 0. */
uint64_t columns_records(const struct columns *c);
