/* announce.h - threads that ask another daemon one thing. One informs a former leader that there is a newer history, so that it
 * refuses changes: it connects until that has answered. The other asks once who a daemon is, before this one follows it. */
#pragma once

#include "server/follow/dial.h"
#include "server/follow/role.h"

#include <pthread.h>

enum announced {
    ANNOUNCE_TRYING, /* no answer yet, or one that is not final */
    ANNOUNCE_HEARD,  /* it refuses changes, or has another history */
    ANNOUNCE_NEWER   /* its history is newer than the one here */
};

/* The answer of a daemon to INFO replication, which describes it. */
struct inquired {
    char daemon[20]; /* random digits of the process; "": it has not answered */
    char role[16];
    char leader[ROLE_TEXT];
    char refusal[120]; /* its first error; "": none */
};

struct announcement {
    struct dial dial;
    char host[ROLE_ADDRESS];
    struct history history; /* the one here */
    int event;              /* borrows; an eventfd, written when there is a final answer */
    pthread_t thread;
    /* not ANNOUNCE_TRYING: the thread writes the rest no more */
    _Atomic enum announced state;
    struct history theirs; /* of ANNOUNCE_NEWER */
    char answer[DIAL_LINE];
    struct inquired who; /* of ANNOUNCE_HEARD, if it has asked who the daemon is */
};

/* Starts the thread, which informs the daemon at that address about the history. h NULL: it asks who the daemon is, for some
 * seconds at most. NULL with errno. */
struct announcement *announce_start(const char *host, unsigned port, const char *token,
                                    const struct history *h, int event);

/* Ends the thread. */
void announce_end(struct announcement *a);

/* Reads what the answer to INFO replication says. */
void announce_read(const char *text, struct inquired *who);

/* Judges the answer to SYNC. */
enum announced announce_judge(const char *line, const struct history *own, struct history *theirs);
