/* dial.h - the common functions of threads that connect to another daemon: waiting, connecting, and the first
 * question, SYNC. */
#pragma once

#include "proto/buf.h"
#include "server/follow/position.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

enum { DIAL_TOKEN = 128, DIAL_LINE = 512 };

struct dial {
    const char *host; /* borrows: a numeric address */
    unsigned port;
    char token[DIAL_TOKEN]; /* empty: none */
    int patience_ms;        /* how long it waits for an answer, and at most 5 s for a connection */
    int wake;               /* owns; an eventfd, written by a reactor */
    atomic_bool stop;       /* the thread is to end, */
    atomic_bool again;      /* or to connect again */
};

/* Reads the token from the first line of a file; NULL: there is none. False if it cannot be read. */
bool dial_read_token(const char *path, char token[DIAL_TOKEN]);

/* False with errno. */
bool dial_init(struct dial *d);
void dial_clear(struct dial *d);

/* On a reactor: wakes the thread; dial_stop also makes it end. */
void dial_wake(struct dial *d);
void dial_stop(struct dial *d);

/* ---- on the thread ---- */

/* Waits until the socket (-1: none) has one of the events, a reactor wakes the thread, or ms have passed. False: the
 * thread is to end or to connect again. */
bool dial_wait(struct dial *d, int fd, short events, int ms);

/* A socket that is connected, which does not block; -1 with errno. */
int dial_connect(struct dial *d);

/* Sends all bytes. False: the connection has ended. */
bool dial_send(struct dial *d, int fd, const char *bytes, size_t n);

/* Receives all bytes until the other end closes. False: it takes too long, or is more than `most` bytes. */
bool dial_hear_all(struct dial *d, int fd, struct buf *in, size_t most);

/* Sends the token and SYNC with that position, and receives the answer into line[DIAL_LINE]; further bytes stay in `in`.
 * False: there is no answer, or the token is refused: then the line has the refusal, otherwise it is empty. */
bool dial_sync(struct dial *d, int fd, const struct position *from, struct buf *in, char *line);
