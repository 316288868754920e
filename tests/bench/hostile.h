/* hostile.h - the table of all families and of hostile orders of input, compared with the same number of uniform
 * points. */
#pragma once

#include <stddef.h>

/* For min_n, 10 min_n, ... up to max_n points: prints the cost of adding and triangulating them
 * per point, one thread, METHOD divide, and the ratio to uniform points in random order. */
void hostile_tables(size_t min_n, size_t max_n);
