/* position.h - how far a daemon has the changes of a history: the log sequence number of the last one, and the digest of all up to
 * it (proto/records/record.h). Two daemons with the same position have the same sets. */
#pragma once

#include "proto/records/history.h"

struct position {
    struct history history;
    uint64_t lsn;
    uint64_t digest; /* 0: it has nothing that it wants to continue */
};
