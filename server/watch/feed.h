/* feed.h - the watchers of a set that want to know the same (scope.h), and what they are sent.
 *
 *     feed   shared --> watcher watcher watcher      they have been sent the same so far, and get the same text
 *     late              watcher own, watcher own     each lacks something else
 *
 * A backlog is what its watchers do not know: a bit for each id, or everything from some id on, in a reset. The shared one
 * collects what has changed while no time may be spent on events (watch.c). A watcher whose connection cannot take
 * an event when the others get it becomes late, with a copy of the shared backlog; when it has caught up, it joins
 * the others.
 *
 *     sending ------v
 *     feed    --> watcher watcher unsent watcher     an event is sent to a few in each turn of the loop
 *
 * So other connections need not wait until it has been sent to hundreds. What changes meanwhile is collected. */
#ifndef SERVER_FEED_H
#define SERVER_FEED_H

#include "server/clients/session_state.h"
#include "server/watch/event.h"
#include "server/watch/idset.h"
#include "server/watch/recent.h"
#include "server/watch/scope.h"

struct backlog {
    struct idset ids;
    bool reset;    /* the next event begins a reset */
    bool outdated; /* an event is needed even without rows: the version has changed */
    bool sweeping; /* ids from `sweep` on have not been sent since */
    uint32_t sweep;
};

/* A set that is watched, was until lately, or was when it was dropped. */
struct watched {
    struct list_link link;     /* first: in the list of all (agenda.h), */
    struct list_link busy;     /* in that of the busy ones, */
    struct list_link deserted; /* in that of the deserted ones, */
    int64_t deserted_ms;       /* since when */
    struct server *server;     /* borrows */
    struct dataset *set;       /* borrows; NULL: dropped */
    struct list feeds;         /* own their watchers */
    struct list late;          /* owns watchers; in the order in which they get parts */
    uint64_t version;          /* what has been collected so far */
    uint32_t ids;              /* the next id at that time */
    bool values;               /* changes of values are collected, */
    uint64_t values_since;     /* from this version on */
    struct recent recent;
    int64_t retry_ms;     /* no triangulation for watchers before */
    uint64_t changing;    /* the version at the end of the last turn, */
    int64_t changed_ns;   /* which was new at that time */
    int64_t credit_ns;    /* processor time that may be spent on events, as of `credit_at_ns` */
    int64_t credit_at_ns; /* of that clock */
    int64_t idle_ns;      /* of the loop, at that time */
    unsigned later;       /* events that connections send later, in this turn */
    struct timer due;     /* ends a delay of events */
    struct reservation memory;
    char name[SET_NAME_LIMIT + 1];
};

struct feed {
    struct list_link link; /* first */
    struct watched *of;
    struct scope scope;
    struct list watchers; /* those that are not late */
    unsigned late;        /* how many are */
    struct backlog shared;
    struct event sending;   /* owns; the last event */
    struct watcher *unsent; /* of `watchers`: it and those behind it have not been sent that yet */
    struct known known;     /* with a box: points that a watcher may know */
};

struct watcher {
    struct list_link link; /* first: of the feed, or of those that are late */
    struct list_link also; /* of the session */
    struct feed *feed;
    struct session *session;
    bool typed; /* in RESP 3 */
    bool late;
    struct backlog own; /* what it does not know, if it is late */
    size_t counted;     /* bytes of that in the memory of its connection */
};

/* What edits have touched since the last call; keys of dt_touched_take. */
struct feed_change {
    bool rows_known, values_known; /* false: all may have changed */
    const uint64_t *row, *value;
    size_t rows, values;
    uint32_t from; /* ids from here on are new */
};

bool backlog_lags(const struct backlog *b);
void backlog_all(struct backlog *b);
void backlog_mark(struct backlog *b, uint32_t id, uint32_t ids);
void backlog_clear(struct backlog *b);

/* Reports a change to the watchers of the feed: begins to send it, if that is allowed and it is small, or adds it to their
 * backlogs. */
void feed_change(struct server *s, struct feed *f, const struct feed_change *c, bool now);

/* Begins to send a part of the shared backlog, unless an event is being sent. */
void feed_part(struct server *s, struct feed *f);

/* Sends the event to watchers that lack it, for a while. */
void feed_send(struct server *s, struct feed *f, int64_t end_ns);

/* Sends a late watcher a part of its own; false: its connection cannot take one. It may join the others. */
bool feed_late_part(struct server *s, struct watcher *w);

/* The watchers of a dropped set that can take an event get the last one, and are freed. */
void feed_dropped(struct server *s, struct watched *k);

/* Takes the watcher out of its lists and frees it. */
void feed_leave(struct watcher *w);

/* How many points are on one line, if all are; else 0. Who watches a part of a line cannot see whether two neighbours of a point
 * are joined, which would be a triangle, so it is sent all of that part after each change. */
uint32_t feed_line(const struct watched *k);

/* Appends the ids in the box of the feed, if the set can find them quickly; false: it cannot, or memory is short. */
bool feed_find_box(const struct feed *f, struct dt_ids *found);

/* Whether an event may be sent to the watcher: not within a reply, and its client reads. */
bool feed_can_take(const struct watcher *w);

/* Adds a watcher to the others, or to those that are late. */
void feed_join(struct watcher *w);
void feed_join_late(struct watcher *w);

size_t feed_memory(const struct feed *f);
void feed_free(struct feed *f);

#endif
