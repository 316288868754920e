/* single_flight.h - a job serves all requests that were made before it ended. A request that had to wait for the job gets its result
 * instead of a job of its own, unless the set has changed since. TRIANGULATE and CHECK use it. */
#pragma once

#include "core/delaunay.h"

#include <stdbool.h>
#include <stdint.h>

/* The result of the last job of one kind on a set. */
struct single_flight {
    int64_t ended_ns; /* 0: there is none */
    uint64_t version; /* of the set */
    double ms;        /* that it took */
    enum dt_method method;
    bool rebuilt; /* although it was current */
};

/* Whether the result serves a request that has waited since then (0: it has not waited) for the set of that version. */
static inline bool single_flight_serves(const struct single_flight *f, int64_t since_ns,
                                        uint64_t version)
{
    return since_ns != 0 && since_ns < f->ended_ns && version == f->version;
}
