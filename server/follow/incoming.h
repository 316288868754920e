/* incoming.h - what a leader sends to a follower (sender.h), as it comes: headers of segments and records, and
 * snapshots, which go into files aside. */
#pragma once

#include "proto/buf.h"
#include "proto/records/record.h"
#include "server/disk/aside.h"

#include <stdbool.h>
#include <stdint.h>

/* The receiver of the parts. Each call can end the stream by returning false. */
struct incoming_calls {
    /* A header; snapshot: one begins. */
    bool (*header)(void *ctx, const struct segment *h);
    /* Whole headers and records of the log, bytes[n]. */
    bool (*log)(void *ctx, const char *bytes, size_t n);
    /* A snapshot with that header is complete; aside_complete is to be called. */
    bool (*snapshot)(void *ctx, struct aside *a, const struct segment *h);
};

struct incoming {
    const struct datadir *dir;          /* borrows: a snapshot comes into a folder of it */
    const struct incoming_calls *calls; /* borrows */
    void *ctx;
    struct buf in;  /* owns: what has come, and has not been taken */
    uint64_t taken; /* bytes of the stream so far */
    bool in_snapshot;
    char why[200];    /* why incoming_take returned false; empty: a call did */
    bool disk_failed; /* a snapshot could not be written */
    /* private */
    struct aside aside;
    struct segment snapshot;
};

/* Takes all whole headers and records off s->in. False: it ends here. */
bool incoming_take(struct incoming *s);

/* The message of a snapshot that cannot be written: the reason, and what an operator can do. */
const char *incoming_disk_fault(int error);

/* Frees everything, and removes an incomplete snapshot. */
void incoming_clear(struct incoming *s);
