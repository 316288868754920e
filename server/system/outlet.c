/* outlet.c - see outlet.h. */
#include "server/system/outlet.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

/* Whether all bytes have been written; *wrote: how many. Others may have made the descriptor non-blocking. */
static bool write_all(int fd, const char *bytes, size_t n, size_t *wrote)
{
    for (*wrote = 0; *wrote < n;) {
        ssize_t took = write(fd, bytes + *wrote, n - *wrote);
        struct pollfd room = {.fd = fd, .events = POLLOUT};
        if (took > 0)
            *wrote += (size_t)took;
        else if (took < 0 && errno == EAGAIN)
            poll(&room, 1, -1);
        else if (took == 0 || errno != EINTR)
            return false;
    }
    return true;
}

/* Writes a line, behind the rest of a torn one on a line of its own. Only one thread at a time. */
static bool write_line(struct outlet *o, const struct outlet_line *line)
{
    char text[OUTLET_LINE + 1] = "\n";
    size_t before = o->torn ? 1 : 0, wrote;
    memcpy(text + before, line->text, line->len);
    bool good = write_all(o->fd, text, before + line->len, &wrote);
    if (wrote > 0)
        o->torn = !good && wrote > before;
    return good;
}

/* ---- the thread ---- */

static void *serve(void *ctx)
{
    struct outlet *o = ctx;
    pthread_mutex_lock(&o->mutex);
    for (;;) {
        while (o->n == 0)
            pthread_cond_wait(&o->came, &o->mutex);
        const struct outlet_line *line = &o->line[o->first]; /* stays until it has been written */
        pthread_mutex_unlock(&o->mutex);
        bool good = write_line(o, line);
        pthread_mutex_lock(&o->mutex);
        if (!good)
            o->lost += line->worth;
        o->first = (o->first + 1) % OUTLET_LINES;
        o->n--;
    }
    return NULL;
}

/* The thread takes no signals: a closed pipe is an error of write, not the end of the process, and a background process
 * may write to its terminal. */
static bool start(struct outlet *o)
{
    pthread_t thread;
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    bool good = pthread_create(&thread, NULL, serve, o) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (good)
        pthread_detach(thread);
    return good;
}

/* ---- lines ---- */

/* Without a thread, a line is written at once if there seems to be room. */
static void write_here(struct outlet *o, const struct outlet_line *line)
{
    struct pollfd room = {.fd = o->fd, .events = POLLOUT};
    if (poll(&room, 1, 0) != 1 || !write_line(o, line))
        o->lost += line->worth;
}

void outlet_put(struct outlet *o, const char *text, size_t n, uint32_t worth)
{
    pthread_mutex_lock(&o->mutex);
    struct outlet_line *line = &o->line[(o->first + o->n) % OUTLET_LINES];
    if (o->n == OUTLET_LINES) {
        o->lost += worth;
    } else {
        line->len = n < OUTLET_LINE ? n : OUTLET_LINE;
        line->worth = worth;
        memcpy(line->text, text, line->len);
        o->started = o->started || start(o);
        if (o->started)
            o->n++;
        else
            write_here(o, line);
        pthread_cond_signal(&o->came);
    }
    pthread_mutex_unlock(&o->mutex);
}

uint32_t outlet_take_lost(struct outlet *o)
{
    pthread_mutex_lock(&o->mutex);
    uint32_t n = o->lost;
    o->lost = 0;
    pthread_mutex_unlock(&o->mutex);
    return n;
}

void outlet_flush(struct outlet *o, unsigned ms)
{
    for (bool more = true; more && ms > 0; ms--) {
        pthread_mutex_lock(&o->mutex);
        more = o->n > 0;
        pthread_mutex_unlock(&o->mutex);
        if (more)
            poll(NULL, 0, 1); /* needs no clock, which somebody may set */
    }
}
