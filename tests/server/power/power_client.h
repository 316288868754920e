/* power_client.h - clients that change sets, several at once, until the daemon has gone; each has a
 * set of its own, and there is one that they share. What they ask and hear goes into a history. */
#ifndef TESTS_SERVER_POWER_CLIENT_H
#define TESTS_SERVER_POWER_CLIENT_H

#include "tests/faults/chance.h"
#include "tests/server/power/power_history.h"

#include <stdatomic.h>

enum { CLIENTS = 4 };

struct workload {
    struct history *history;
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
    struct stream *own, *shared; /* NULL: there will be a new one */
    uint32_t places;             /* in shared sets that it has used */
    uint64_t heard;              /* bytes of replies */
    char in[4096];               /* what has come of them, from..to not looked at yet */
    size_t from, to;
};

void client_start(struct client *c, struct workload *w, uint64_t seed);
void client_join(struct client *c);

/* What a daemon was asked in vain may still come to be as long as the power is not cut: whoever goes
 * on after that does so with other sets. */
void client_leave_sets(struct client *c);

#endif
