/* power_history.h - what clients have requested from a daemon, what they know of the outcome, and so
 * which states a power cut may leave.
 *
 * A stream is the sequence of changes that one client has requested of one set. However the daemon
 * ends, a prefix of it survives: at least the acknowledged changes, at most those that were sent. If
 * one stream owns the set, the set is exactly the result of that prefix. If clients share the set, each
 * stream's points, whose x is the stream's number, are the result of its prefix.
 *
 * A full disk is an exception. The daemon then refuses changes that need space and carries out those that
 * free some. Its replies come in order, each when the change is on the disk. A client whose daemon ends
 * cannot know which of its last changes were refused: each one that needs space may be missing.
 *
 * When a client does not know the outcome of a change although the daemon is running (the disk has
 * failed), it continues with another stream. */
#pragma once

#include "server/sets/dataset.h"
#include "tests/faults/power_log.h"
#include "tests/server/power/power_change.h"

#include <pthread.h>

enum {
    WHY_BYTES = 400,
    BURST = 8 /* a client sends at most this many requests before it reads the replies */
};

struct sent_change {
    struct request_change change;
    bool refused; /* the reply says that nothing was changed: READONLY, BUSY, CANCELLED */
    char reply[REPLY_BYTES];
};

struct stream {
    char set[SET_NAME_LIMIT + 1];
    bool shared;
    unsigned number;
    struct sent_change *sent; /* owns */
    int n, cap;
    int acknowledged;  /* at the moment that is examined */
    int found;         /* how many were found to be present */
    unsigned supposed; /* which of the changes without a reply are assumed to be refused */
    uint32_t own;      /* how many of its points were in a shared set */
    struct model before;
    uint64_t *digest; /* owns; after the first 0, 1, ... n changes */
    uint32_t *id; /* owns; of a shared set: which id a point of the stream has; DT_NONE: unknown */
    uint32_t ids; /* points that the stream has added so far, if all succeeded */
    uint32_t known; /* how many of them, from the first, are in id */
};

/* A reply that a connection has received, up to its byte `end`. It answers a change, or it shows a
 * point and so proves that the change that added the point has been made. */
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

struct states {
    pthread_mutex_t mutex; /* for the two lists; a stream and a connection are one thread's */
    struct stream **stream;
    struct connection **connection;
    int streams, connections;
    bool shows_unsaved; /* changes that replies show may be lost: the disk fails */
    bool disk_is_full;  /* occasionally */
};

void history_init(struct states *h);
void history_clear(struct states *h);
void history_forget_connections(struct states *h);

/* set is NULL for a set of its own, or the name of a shared set. */
struct stream *history_new_stream(struct states *h, const char *set);
/* NULL: another connection has used that port. */
struct connection *history_new_connection(struct states *h, unsigned port);

/* Takes over the change; returns its index. */
int stream_add(struct stream *s, const struct request_change *c);

/* The reply to a change. */
void connection_hear(struct connection *c, struct stream *s, int index, uint64_t end,
                     const char *reply);

/* A reply that shows a point of a shared set. */
void connection_see(struct connection *c, struct dt_point p, uint64_t end);

/* Once the daemon has ended: compares the replies with the model, and computes its states. */
void history_close(struct states *h);

/* Chooses the moment when the daemon had done the first n operations of the log, or, for `all`, its
 * end. */
void history_look(struct states *h, const struct power_log *log, size_t n, bool all);

/* Whether the sets are a state that may be left. If not, `why` says what is wrong. */
bool history_allows(struct states *h, const struct registry *sets, char why[WHY_BYTES]);

/* Makes the sets, which history_allows has just accepted, the state that the next life begins with. */
void history_settle(struct states *h, const struct registry *sets);
