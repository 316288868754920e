/* power_history.h - what clients have asked of a daemon, what they know of the outcome, and so what
 * may be there after a power cut.
 *
 * A stream is what one client has asked of one set, one change after the other. However the daemon
 * ends, its first so many changes are there and the others are not: at least those that were
 * acknowledged, at most those that were sent. Either the set is the stream's own, and is exactly
 * what these changes make of it; or clients share it, and each stream's points, which have its
 * number for x, are what its changes make of them.
 *
 * A full disk makes an exception. The daemon then refuses what needs space and carries out what frees
 * some. Its replies come in order, each when the change is on the disk, so a client whose daemon ends
 * has not heard which of its last changes were refused: any of those that need space may be missing.
 *
 * When a client does not know what has become of a change although the daemon lives (the disk has
 * failed), it goes on with another stream. */
#ifndef TESTS_SERVER_POWER_HISTORY_H
#define TESTS_SERVER_POWER_HISTORY_H

#include "server/sets/dataset.h"
#include "tests/faults/power_log.h"
#include "tests/server/power/power_change.h"

#include <pthread.h>

enum {
    WHY_BYTES = 400,
    BURST = 8 /* a client sends at most so many requests before it takes the replies */
};

struct sent_change {
    struct change change;
    bool refused; /* the reply says that it did nothing for now: READONLY, BUSY, CANCELLED */
    char reply[REPLY_BYTES];
};

struct stream {
    char set[SET_NAME_LIMIT + 1];
    bool shared;
    unsigned number;
    struct sent_change *sent; /* owns */
    int n, cap;
    int acknowledged;  /* at the moment that is looked at */
    int found;         /* so many were there */
    unsigned supposed; /* which of the changes without a reply are taken for refused */
    uint32_t own;      /* points of it were in a shared set */
    struct model before;
    uint64_t *digest; /* owns; after the first 0, 1, ... n changes */
    uint32_t *id; /* owns; of a shared set: which id a point of the stream has; DT_NONE: unknown */
    uint32_t ids; /* points that the stream has added so far, if all was well */
    uint32_t known; /* the first so many of them are in id */
};

/* A reply that a connection has taken, up to its byte `end`: to a change, or one that shows a point,
 * and with it that the change has been made which put it there. */
struct heard {
    struct stream *stream; /* borrows; NULL: it shows a point */
    int index;
    struct dt_point point;
    uint64_t end;
};

struct connection {
    unsigned port;
    struct heard *heard; /* owns */
    int n, cap;
};

struct history {
    pthread_mutex_t mutex; /* for the two lists; a stream and a connection are one thread's */
    struct stream **stream;
    struct connection **connection;
    int streams, connections;
    bool shows_unsaved; /* what a reply shows may be lost: the disk fails */
    bool disk_is_full;  /* now and then */
};

void history_init(struct history *h);
void history_clear(struct history *h);
void history_forget_connections(struct history *h);

/* NULL: of a set of its own; else of one that it shares. */
struct stream *history_new_stream(struct history *h, const char *set);
/* NULL: another connection has had that port. */
struct connection *history_new_connection(struct history *h, unsigned port);

/* Takes over the change; returns its index. */
int stream_add(struct stream *s, const struct change *c);

/* The reply to a change. */
void connection_hear(struct connection *c, struct stream *s, int index, uint64_t end,
                     const char *reply);

/* A reply that shows a point of a shared set. */
void connection_see(struct connection *c, struct dt_point p, uint64_t end);

/* Once the daemon has ended: compares the replies with the model, and computes its states. */
void history_close(struct history *h);

/* Looks at the moment when the daemon had done the first n operations of the log, or, for `all`, at
 * its end. */
void history_look(struct history *h, const struct power_log *log, size_t n, bool all);

/* Whether the sets are what may be there. If not, why. */
bool history_allows(struct history *h, const struct registry *sets, char why[WHY_BYTES]);

/* The sets, which history_allows has just found good, are what is there from now on. */
void history_settle(struct history *h, const struct registry *sets);

#endif
