/* announce.c - see announce.h. */
#include "server/follow/announce.h"

#include "server/follow/consent.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum {
    FIRST_PAUSE_MS = 200,
    LAST_PAUSE_MS = 1000, /* much less than a leader takes to be settled (follower_role.c) */
    PATIENCE_MS = 10 * 1000,
    NO_SUCH_LSN = 999999999999999999 /* so that nothing is sent after the answer */
};

enum announced announce_judge(const char *line, const struct history *own, struct history *theirs)
{
    if (strncmp(line, "ERR READONLY", 12) == 0)
        return ANNOUNCE_HEARD;
    if (!consent_read_history(line, theirs))
        return ANNOUNCE_TRYING;
    switch (history_relation(theirs, own)) {
    case HISTORY_NEWER:
        return ANNOUNCE_NEWER;
    case HISTORY_OLDER: /* it should have refused changes */
        return ANNOUNCE_TRYING;
    default:
        return ANNOUNCE_HEARD;
    }
}

static enum announced inform(struct announcement *a)
{
    struct position here = {.history = a->history, .lsn = NO_SUCH_LSN, .digest = 1};
    struct buf in = {0};
    enum announced got = ANNOUNCE_TRYING;
    int fd = dial_connect(&a->dial);
    if (fd < 0)
        return got;
    if (dial_sync(&a->dial, fd, &here, &in, a->answer))
        got = announce_judge(a->answer, &a->history, &a->theirs);
    buf_free(&in);
    close(fd);
    return got;
}

static void *serve(void *arg)
{
    struct announcement *a = arg;
    enum announced got;
    for (int pause = FIRST_PAUSE_MS; (got = inform(a)) == ANNOUNCE_TRYING;
         pause = pause * 2 < LAST_PAUSE_MS ? pause * 2 : LAST_PAUSE_MS)
        if (!dial_wait(&a->dial, -1, 0, pause))
            return NULL;
    a->state = got;
    eventfd_write(a->event, 1);
    return NULL;
}

struct announcement *announce_start(const char *host, unsigned port, const char *token,
                                    const struct history *h, int event)
{
    struct announcement *a = calloc(1, sizeof *a);
    if (a == NULL)
        return NULL;
    snprintf(a->host, sizeof a->host, "%s", host);
    snprintf(a->dial.token, sizeof a->dial.token, "%s", token);
    a->dial.host = a->host;
    a->dial.port = port;
    a->dial.patience_ms = PATIENCE_MS;
    a->history = *h;
    a->event = event;
    int error = dial_init(&a->dial) ? pthread_create(&a->thread, NULL, serve, a) : errno;
    if (error == 0)
        return a;
    if (a->dial.wake >= 0)
        dial_clear(&a->dial);
    free(a);
    errno = error;
    return NULL;
}

void announce_end(struct announcement *a)
{
    if (a == NULL)
        return;
    dial_stop(&a->dial);
    pthread_join(a->thread, NULL);
    dial_clear(&a->dial);
    free(a);
}
