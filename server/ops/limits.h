/* limits.h - the fixed limits of a server, as stated in section 8 of PROTOCOL.md
 * (tests/server/ops/promises_test.c compares them). The limits of lines and names are in proto/. */
#pragma once

enum {
    LIMIT_SETS = 65536,
    LIMIT_QUEUED_JOBS = 64,       /* long jobs that may wait for a worker */
    LIMIT_TOKEN = 128,            /* bytes */
    LIMIT_CLIENT_NAME = 64,       /* bytes, in CLIENT SETNAME */
    LIMIT_TRACE_POINTS = 1000,    /* of a set, for TRACE */
    LIMIT_NEAREST_MANY = 4096,    /* points for each place of NEARESTB */
    LIMIT_RASTER_SIDE = 65536,    /* columns, and rows */
    LIMIT_RASTER_CELLS = 1 << 27, /* 1 GiB of values */
    LIMIT_LEVELS = 10000,         /* of CONTOUR */
    LIMIT_TIMEOUT_S = 1000000,    /* of TIMEOUT */
    LIMIT_STALL_S = 60,           /* in which a client receives nothing of a reply */
    LIMIT_STRANGER_S = 10,        /* before AUTH */
    LIMIT_STRANGER_BYTES = 16384, /* of a request before AUTH */
    LIMIT_STRANGER_WORDS = 10
};
