/* orders.h - uniform points in orders that may be slow for engines that sort, or for those that do not. */
#ifndef BENCH_ORDERS_H
#define BENCH_ORDERS_H

#include "tests/oracle/families.h"

/* All of them; the row after the last one has the name NULL. */
extern const struct family orders[];

#endif
