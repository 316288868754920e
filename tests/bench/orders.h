/* orders.h - uniform points in orders that may be slow for engines that sort, or for those that do not. */
#pragma once

#include "tests/oracle/families.h"

/* All of them; the row after the last one has the name NULL. */
extern const struct family orders[];
