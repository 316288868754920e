/* power_client.h - clients that change sets concurrently until the daemon ends; each has a set of its own,
 * and there is one that they share. Their requests and replies are recorded in a history. */
#pragma once

#include "tests/faults/chance.h"
#include "tests/server/power/power_history.h"

#include <stdatomic.h>

enum { CLIENTS = 4 };

struct workload {
    struct states *history;
    unsigned port;
    bool large;         /* some loads do not fit into one record of the log */
    atomic_uint shared; /* the number of the set that is shared now */
    atomic_bool stop;
};

struct client {
    struct workload *work;
    struct chance chance;
    pthread_t thread;
    int fd;
    struct connection *connection;
    struct stream *own, *shared; /* NULL: the next change begins a new one */
    uint32_t places;             /* used so far in shared sets */
    uint64_t heard;              /* bytes of replies */
    char in[4096];               /* received bytes; from..to are not parsed yet */
    size_t from, to;
};

void client_start(struct client *c, struct workload *w, uint64_t seed);
void client_join(struct client *c);

/* A request that failed may still take effect as long as the power is not cut, so clients that continue
 * after a failure use other sets. */
void client_leave_sets(struct client *c);
