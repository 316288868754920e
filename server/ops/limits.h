/* limits.h - the limits of a server that no setting changes, as section 8 of PROTOCOL.md promises them
 * (tests/server/promises_test.c compares). Those of lines and names are in proto/. */
#ifndef SERVER_LIMITS_H
#define SERVER_LIMITS_H

enum {
    LIMIT_SETS = 65536,
    LIMIT_QUEUED_JOBS = 64,       /* long ones that may wait for a worker */
    LIMIT_TOKEN = 128,            /* bytes */
    LIMIT_CLIENT_NAME = 64,       /* bytes, by CLIENT SETNAME */
    LIMIT_TRACE_POINTS = 1000,    /* of a set that TRACE takes */
    LIMIT_TIMEOUT_S = 1000000,    /* that TIMEOUT takes */
    LIMIT_STALL_S = 60,           /* without taking anything of a reply */
    LIMIT_STRANGER_S = 10,        /* before AUTH */
    LIMIT_STRANGER_BYTES = 16384, /* of a request before AUTH */
    LIMIT_STRANGER_WORDS = 10
};

#endif
