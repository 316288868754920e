/* reactor.h - a thread with an event loop that serves some of the connections, and what it needs to carry out one request
 * after the other. All reactors are equal, except that the first one accepts connections and has the timers, workers
 * and files of the daemon. A connection stays with its reactor.
 *
 * A reactor uses its own fields while it shares the world (loop.h). Everything else of a server is the world, which a
 * reactor only reads while it shares the world. */
#pragma once

#include "core/delaunay.h"
#include "proto/request.h"
#include "server/ops/stats.h"
#include "server/system/loop.h"

#include <pthread.h>

struct command;
struct server;

struct reactor {
    struct loop loop; /* first: the loop's view */
    unsigned number;
    pthread_t thread;          /* of all but the first */
    struct server *server;     /* borrows */
    struct task push;          /* of what it has appended to the log while it shared the world */
    uint32_t sessions;         /* that it serves */
    struct dt_ids scratch;     /* owns; the result of a query that is answered at once */
    struct request request;    /* owns; the words of the current request */
    struct prefetch *prefetch; /* owns; the requests after it in the connection's input */
    const struct command *command; /* of the last request, often that of the next; NULL: none */
    struct buf lines;              /* owns; a reply in lines before it is converted to RESP */
    uint64_t commands;             /* carried out, successfully or not */
    uint64_t errors;               /* of these, with an ERR reply, */
    uint64_t slow;                 /* and those in the slow log */
    struct stats stats;
};
