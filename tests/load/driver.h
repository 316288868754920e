/* driver.h - many connections, one thread, epoll: sends a mix and measures how long replies take.
 *
 * Closed loop (rate 0): each connection sends `pipeline` requests at once, waits for all their replies, and begins again.
 * A latency runs from the sending. Together: it waits for the replies of all connections. Open loop: requests are due
 * at a fixed rate, alternating between the connections, even if earlier ones have not been answered. A latency then runs
 * from the time when the request was due. So it includes the time that the request waited because the server
 * was slow (no coordinated omission). */
#pragma once

#include "server/ops/histogram.h"
#include "tests/load/mix.h"

struct plan {
    unsigned port; /* on the loopback address */
    unsigned connections, pipeline;
    double rate;    /* requests a second; 0: closed loop */
    bool together;  /* closed loop: all connections send at the same moment */
    double seconds; /* after which nothing more is sent */
    uint64_t count; /* of requests, after which nothing more is sent */
};

struct outcome {
    struct histogram latency; /* ns */
    uint64_t replies, errors; /* errors: ERR replies among them */
    double seconds;           /* until the last reply */
};

/* Carries the plan out. False, with the reason on standard error, if a connection fails, a reply violates
 * the protocol, or replies are missing ten seconds after the plan's end. */
bool driver_run(const struct plan *plan, struct mix *mix, struct outcome *o);

/* A connected, blocking socket; -1 with the reason on standard error. */
int driver_connect(unsigned port);

uint64_t driver_now_ns(void);
