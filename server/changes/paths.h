/* paths.h - rows of paths become points and constraints.
 *
 * A row is x, y, the values of the fields, and a mark: the number of its line, negative if it begins a path (proto/body.h). A path whose
 * last place is its first is a ring, and the last place is no point. */
#pragma once

#include "server/changes/change.h"

/* Returns how many paths there are in rows of that width. */
size_t paths_count(const double *rows, size_t n, size_t width);

/* Makes a change of the rows and takes ownership of them. The points get ids from `first` on. The constraints of path i,
 * counted from 0, are `what` with a number that is greater by i. *c has columns, without values, and a PSLG. False: out of memory. */
bool paths_take(struct change *c, double *rows, size_t n, uint32_t first, uint32_t what);

/* A constraint of LOADB ... CONSTRAINTS; its ends are counted from 0 among the points before it. */
struct paths_record {
    uint32_t a, b, border, number;
};

/* Record i of those behind n rows of that width; a record begins where a row would. */
struct paths_record paths_record_at(const double *rows, size_t n, size_t width, size_t i);

/* Makes a change of n points with their values and `records` constraints, as above. */
bool paths_take_records(struct change *c, double *rows, size_t n, size_t records, uint32_t first);
