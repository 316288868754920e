/* row_memory.h - the memory that long rows take while they are made: counted in the budget before it is taken.
 *
 * A piece of a reply has reserved the usual size. A row that may be longer asks here first, so however long rows are,
 * replies stay within --max-memory. */
#pragma once

#include "proto/buf.h"
#include "server/sets/budget.h"

enum { ROW_MEMORY_SHORT = 4096 }; /* bytes; shorter rows need not ask */

/* Reserves memory for exactly `bytes` more at the end of out. `memory`, unless NULL, then covers all of out and `beside` more
 * bytes, which the caller allocates. False, and out->failed: there is no memory. */
bool row_memory_reserve(struct reservation *memory, struct buf *out, size_t bytes, size_t beside);
