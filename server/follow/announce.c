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
    INQUIRY_MS = 2 * 1000,
    INQUIRY_ROOM = 1 << 16,          /* for the answer */
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

/* ---- who a daemon is ---- */

/* The value of the line `key:value`. */
static void read_fact(const char *text, const char *key, char *to, size_t size)
{
    size_t n = strlen(key);
    to[0] = '\0';
    for (const char *line = text; line != NULL; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (strncmp(line, key, n) == 0 && line[n] == ':') {
            snprintf(to, size, "%.*s", (int)strcspn(line + n + 1, "\r\n"), line + n + 1);
            return;
        }
    }
}

static void read_refusal(const char *text, char *to, size_t size)
{
    const char *line = strncmp(text, "ERR ", 4) == 0 ? text : strstr(text, "\nERR ");
    if (line != NULL && *line == '\n')
        line++;
    snprintf(to, size, "%.*s", line == NULL ? 0 : (int)strcspn(line, "\r\n"),
             line == NULL ? "" : line);
}

void announce_read(const char *text, struct inquired *who)
{
    read_refusal(text, who->refusal, sizeof who->refusal);
    read_fact(text, "daemon", who->daemon, sizeof who->daemon);
    read_fact(text, "role", who->role, sizeof who->role);
    read_fact(text, "leader", who->leader, sizeof who->leader);
}

static void inquire(struct announcement *a)
{
    char question[DIAL_TOKEN + 40] = "";
    struct buf in = {0};
    int fd = dial_connect(&a->dial);
    if (fd < 0)
        return;
    int n = snprintf(question, sizeof question, "%s%s%sINFO replication\nQUIT\n",
                     a->dial.token[0] != '\0' ? "AUTH " : "", a->dial.token,
                     a->dial.token[0] != '\0' ? "\n" : "");
    if (dial_send(&a->dial, fd, question, (size_t)n) &&
        dial_hear_all(&a->dial, fd, &in, INQUIRY_ROOM)) {
        buf_append(&in, "", 1);
        if (!in.failed)
            announce_read(buf_head(&in), &a->who);
    }
    buf_free(&in);
    close(fd);
}

/* ---- the threads ---- */

static void *serve_inquiry(void *arg)
{
    struct announcement *a = arg;
    inquire(a);
    a->state = ANNOUNCE_HEARD;
    eventfd_write(a->event, 1);
    return NULL;
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
    if (h != NULL)
        a->history = *h;
    snprintf(a->host, sizeof a->host, "%s", host);
    snprintf(a->dial.token, sizeof a->dial.token, "%s", token);
    a->dial.host = a->host;
    a->dial.port = port;
    a->dial.patience_ms = h == NULL ? INQUIRY_MS : PATIENCE_MS;
    a->event = event;
    void *(*run)(void *) = h == NULL ? serve_inquiry : serve;
    int error = dial_init(&a->dial) ? pthread_create(&a->thread, NULL, run, a) : errno;
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
