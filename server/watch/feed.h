/* feed.h - the watchers of a set with the same scope (scope.h), and the events that they are sent.
 *
 *     ticks of the set   1 2 3 4 5 6 7 8           each a change that has been collected (watch.c)
 *     positions                  a   b c           of the watchers: b has been sent what changed up to 7
 *
 * A watcher is only a position. The changes that it lacks are found when it is served: from the last keys of the set
 * (recent.h) if they are few, otherwise from the stamps of the ids (stamps.h). A sweep over all ids, or over those in a box, is done in
 * parts; changes that come meanwhile follow after it.
 *
 * Watchers in the same position are sent the same text, so the feed keeps its last one until all of them have been sent it. */
#pragma once

#include "server/clients/session_state.h"
#include "server/watch/altered.h"
#include "server/watch/credit.h"
#include "server/watch/event_text.h"
#include "server/watch/recent.h"
#include "server/watch/scope.h"
#include "server/watch/stamps.h"

/* The extent to which a watcher knows a set. All zero: it knows nothing. */
struct position {
    uint64_t tick;  /* all changes up to this one, */
    uint32_t ids;   /* and no id from this one on */
    uint32_t sweep; /* in a sweep: ids from here on have not been looked at */
    uint64_t goal;  /* the tick at which it began; 0: there is none */
    bool reset;     /* the next event begins a reset */
    /* With constraints: */
    uint64_t altered; /* all changes of them before this number (altered.h); */
    bool lists;       /* in a reset: all of them are sent, */
    uint32_t listed;  /* those whose smaller end is below have been */
};

/* A set that is watched, was until lately, or was when it was dropped. */
struct watched {
    struct list_link link;     /* first: in the list of all (watch.c), */
    struct list_link busy;     /* in that of the busy ones, */
    struct list_link deserted; /* or of the deserted ones, */
    int64_t deserted_ms;       /* since then */
    struct server *server;     /* borrows */
    struct dataset *set;       /* borrows; NULL: dropped */
    struct list feeds;         /* owns */
    uint32_t watchers;         /* of all feeds. They are in one of three lists: */
    struct list current;       /* nothing has changed since they were served; */
    struct list queue;         /* served next, in this order; */
    struct list blocked; /* cannot take events, and their connections will say when they can */
    struct list texts;   /* the feeds that keep a text */
    uint64_t version;    /* what has been collected so far */
    uint32_t ids;        /* the next id at that time */
    bool values;         /* changes of values are collected */
    uint64_t all_tick;   /* everything may have changed until this tick, */
    uint64_t value_tick; /* and all values until this one */
    uint64_t line_tick;  /* the last one at which all points were on one line */
    struct recent recent;
    struct altered altered;
    struct stamps row_stamps,
        value_stamps;     /* of the row and the ring, and of the values of each id */
    int64_t retry_ms;     /* no triangulation for watchers before */
    int64_t changed_ns;   /* when it was last changed */
    struct credit credit; /* of the time for events */
    struct timer due;     /* ends a delay of events */
    size_t feed_bytes;    /* of all feeds */
    struct reservation memory;
    char name[SET_NAME_LIMIT + 1];
};

struct feed {
    struct list_link link; /* first */
    struct watched *of;
    struct scope scope;
    uint32_t watchers;
    struct known known; /* with a box: points that a watcher may know */
    bool wide;          /* too many points are in its box for a search */
    /* The last event, from one position to another, and how many watchers have been sent it. */
    struct event text; /* owns */
    struct position from, to;
    uint32_t sent;         /* 0: there is none */
    bool silent;           /* there is nothing to say yet */
    struct list_link kept; /* in `texts` */
    size_t counted;        /* its bytes in feed_bytes */
};

struct watcher {
    struct list_link link; /* first: in a list of the set */
    struct list_link also; /* of the session */
    struct feed *feed;
    struct session *session;
    bool typed;   /* in RESP 3 */
    bool blocked; /* in that list */
    struct position at;
};

/* The tick of the set now. */
static inline uint64_t feed_tick(const struct watched *k)
{
    return k->recent.mark_end;
}

/* Whether who is in that position lacks something that has been collected. */
static inline bool feed_lacks(const struct feed *f, const struct position *p)
{
    return p->goal != 0 || p->tick < feed_tick(f->of) || p->lists ||
           (f->scope.constraints && p->altered < f->of->altered.end);
}

static inline bool feed_lags(const struct watcher *w)
{
    return feed_lacks(w->feed, &w->at);
}

/* Returns the number of points if all are on one line; else 0. A watcher of a part of a line cannot see whether two neighbours
 * of a point are joined, which would be a triangle. So it is sent all of that part after each change. */
uint32_t feed_line(const struct watched *k);

/* Returns the feed of that scope, with one more watcher, and takes ownership of the scope. NULL: out of memory. */
struct feed *feed_enter(struct watched *k, struct scope *scope);

/* The watcher leaves its lists and is freed. The last watcher's feed is freed, too. */
void feed_leave(struct watcher *w);

/* The position of a watcher that knows a version of the set. If the changes since then are not known any more, it knows nothing;
 * resume.c. */
struct position feed_since(struct feed *f, uint64_t version);

/* A watcher who knows less than this tick is sent everything. */
uint64_t feed_first_tick(const struct feed *f);

enum { FEED_KEYS = 1024 }; /* more changes than this are found by a sweep */

/* Finds the points in the box. False: there are too many, or out of memory. */
bool feed_find_box(const struct feed *f, struct dt_ids *found);

/* Whether an event may be sent to the watcher: not within a reply, and its client reads. */
bool feed_can_take(const struct watcher *w);

/* Sends the watcher an event with a part of the changes that it lacks, or none if that part has no rows. All changes of the set have been
 * collected. Returns whether its connection sends the event later. */
bool feed_serve(struct watcher *w);

/* The watcher of a dropped set gets its last event, and leaves. */
void feed_end(struct watcher *w);

/* Frees the texts of all feeds. */
void feed_free_texts(struct watched *k);
