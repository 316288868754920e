/* link.h - the follower's side of the connection to its leader: a thread that connects, asks for what comes after a
 * position, and receives it. Records of the log go to a reactor in pieces (link_take); a snapshot goes into files in a
 * directory aside, is read from there, and replaces everything at once (link_arrival).
 *
 * The thread connects again whenever the connection ends, after a pause. The pause doubles each time: up to 3 seconds, or
 * up to 30 after a failure that repeats a transfer. It is short again after a connection that has lasted longer. */
#pragma once

#include "proto/buf.h"
#include "server/disk/recover.h"
#include "server/follow/dial.h"
#include "server/follow/role.h"
#include "server/sets/budget.h"
#include "server/system/list.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

enum { LINK_WHY = 240, LINK_FIRST_PAUSE_MS = 100 };

enum link_state {
    LINK_CONNECTING,
    LINK_RECEIVING, /* the log */
    LINK_LOADING,   /* a snapshot */
    LINK_REFUSED    /* following the leader needs a confirmation; `why` has the reason */
};

/* Headers of segments, and records, as they came. */
struct link_piece {
    struct list_link link; /* first */
    struct buf bytes;
    uint64_t end; /* bytes of the stream up to its end */
};

/* A snapshot that has been received and read. */
struct link_arrival {
    struct recovery recovery;
    struct datadir dir; /* where its files are */
};

struct link {
    /* set before the start */
    char host[ROLE_ADDRESS];
    struct dial dial;          /* but for the host: link_start sets that */
    bool confirmed;            /* the leader may replace a history that it does not continue */
    atomic_bool own;           /* this daemon may have changes that no leader has sent */
    const struct datadir *dir; /* borrows */
    struct dt_pages *pages;    /* borrows */
    struct budget *budget;     /* borrows */
    char noted[LINK_WHY];      /* the last reason that is on standard error */
    int event; /* borrows; an eventfd, written when there is something for a reactor */
    /* shared */
    pthread_mutex_t mutex;
    enum link_state state;
    char why[LINK_WHY];        /* of LINK_REFUSED, or why there is no connection */
    bool wants_position;       /* the thread waits for link_go */
    struct position from;      /* from link_go */
    struct list pieces;        /* those to take, */
    struct reservation queued; /* their bytes, and those of the buffer for input */
    /* owns until link_installed; not NULL: the thread waits for that */
    struct link_arrival *arrival;
    uint64_t acked, acked_bytes; /* what is to be acknowledged */
    bool works;                  /* a reactor works on a change: that is to be acknowledged, too */
    uint64_t leader_lsn;         /* the last one that is known of the leader */
    bool repeats;                /* the connection has ended by a failure that repeats a transfer */
    pthread_t thread;
};

/* Starts the thread. False with errno. */
bool link_start(struct link *l);

/* The milliseconds until the next connection: after one that has received the log for lasted_ms, which came after a pause
 * of `before`; repeats: it ended by a failure that repeats a transfer. */
int link_pause(int before, bool repeats, int64_t lasted_ms);

/* Ends the thread and frees everything. */
void link_end(struct link *l);

/* ---- on a reactor ---- */

/* Whether the thread wants to know the position from which to continue, and all pieces have been taken. */
bool link_wants_position(struct link *l);
void link_go(struct link *l, const struct position *from);

/* The next piece, which the caller owns; NULL: there is none. */
struct link_piece *link_take(struct link *l);
void link_piece_free(struct link_piece *p);

/* A snapshot that waits to become what this daemon has; NULL: none. */
struct link_arrival *link_arrival(struct link *l);

/* The snapshot, which is that of this lsn, has been installed: the thread continues. */
void link_installed(struct link *l, uint64_t lsn);

/* Changes up to lsn are on the disk, and with them this number of bytes of the stream; 0: unknown. */
void link_acknowledge(struct link *l, uint64_t lsn, uint64_t bytes);

/* A reactor, or a worker, is carrying out what was received: the leader hears that although nothing more is on the
 * disk. */
void link_works(struct link *l);

/* Disconnects, because what was received cannot be carried out; the thread connects again, after a long pause if that
 * happens again and again, and asks for the position. */
void link_again(struct link *l, const char *why);
