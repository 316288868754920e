/* sender.h - the leader's side of one follower: a thread that reads the log from its files and sends it.
 *
 * It sends the content of the files: headers of segments, and records. The stream begins with a line,
 *
 *     OK 0 history=H lsn=L continues=yes|no|differs
 *
 * yes: the log has the follower's position; the header and the records after it follow. no: the log does not reach back to it;
 * a snapshot, whole, comes first. differs: the log has other changes up to that lsn, or ends before it; nothing follows.
 * A header comes again before the first record of each segment, and every second while there are none. It has the lsn of
 * the next record and the digest of all records before it. The follower sends lines `ACK lsn bytes`: the last change on its
 * disk, and the bytes of the stream up to that change. It repeats the line once a second while it works on a change.
 *
 * Since it reads files, a slow follower needs no memory of the leader. Only changes that are durable here are sent, so that a
 * follower never has changes that its leader has lost in a crash. */
#pragma once

#include "server/disk/datadir.h"
#include "server/follow/position.h"
#include "server/sets/budget.h"
#include "server/system/list.h"
#include "server/system/sock.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* A follower is disconnected if its machine takes no bytes for this time. */
#define SENDER_TIMEOUT_MS 15000u

enum sender_state { SENDER_STARTING, SENDER_SNAPSHOT, SENDER_LOG, SENDER_ENDED };

struct sender {
    struct list_link link; /* first: in the leader's list */
    int fd;                /* owns; a socket */
    int wake;              /* owns; an eventfd: `durable` has grown, or `stop` */
    int event; /* borrows; an eventfd that is written when something below has changed */
    const struct datadir *dir; /* borrows */
    struct lineage lineage;    /* of the leader */
    struct position from;      /* the follower's */
    struct sock_peer peer;
    struct reservation memory; /* of its buffers */
    int64_t since_ms;
    pthread_t thread;
    /* from a reactor */
    _Atomic uint64_t durable; /* changes up to this lsn may be sent */
    atomic_bool stop;
    /* to a reactor */
    _Atomic uint64_t acked, acked_bytes, sent, sent_bytes;
    /* not 0: it waits for a snapshot of changes up to at least this lsn - 1 */
    _Atomic uint64_t wants_snapshot;
    _Atomic int state;
    /* since when it has acknowledged nothing more of what was sent, in milliseconds; 0: it has everything */
    _Atomic int64_t silent_ms;
    atomic_bool sleeping; /* it is to be woken when `durable` grows */
    /* a reactor's */
    int64_t behind_ms; /* since when the follower does not have everything; 0: it does */
};

/* Starts the thread. False with errno; the caller still owns fd. */
bool sender_start(struct sender *s);

/* Changes up to this lsn are durable now. */
void sender_advance(struct sender *s, uint64_t durable);

/* Ends the thread and frees its memory. */
void sender_end(struct sender *s);
