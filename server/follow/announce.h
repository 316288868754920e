/* announce.h - informs a former leader that there is a newer history, so that it refuses changes: a thread that connects to it
 * until it has answered. */
#ifndef SERVER_ANNOUNCE_H
#define SERVER_ANNOUNCE_H

#include "server/follow/dial.h"
#include "server/follow/role.h"

#include <pthread.h>

enum announced {
    ANNOUNCE_TRYING, /* no answer yet, or one that is not final */
    ANNOUNCE_HEARD,  /* it refuses changes, or has another history */
    ANNOUNCE_NEWER   /* its history is newer than the one here */
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
};

/* Starts the thread, which informs the daemon at that address about the history. NULL with errno. */
struct announcement *announce_start(const char *host, unsigned port, const char *token,
                                    const struct history *h, int event);

/* Ends the thread. */
void announce_end(struct announcement *a);

/* What the answer to SYNC means. */
enum announced announce_judge(const char *line, const struct history *own, struct history *theirs);

#endif
