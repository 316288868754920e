/* load.h - a load in progress: points that follow a LOAD or LOADB line. */
#ifndef SERVER_LOAD_H
#define SERVER_LOAD_H

#include "proto/body.h"
#include "proto/reply.h"
#include "server/jobs/answer.h"
#include "server/jobs/server.h"

struct load {
    struct body body;
    struct server *server;     /* borrows */
    struct reservation memory; /* of the points that have come */
    enum reply_code shortage;  /* what to say if there is no memory for more of them */
    size_t expected;           /* bytes that it will take beside */
    uint64_t came, seen; /* bytes that have come; as many had when load_stalls last saw progress */
    int64_t seen_ms;     /* when that was; 0: not yet */
    bool refused; /* that has been told already: the points are only to be read and dropped */
    size_t name_len;
    char name[SET_NAME_LIMIT];
};

/* Begins a load: a->load, of `count` points or lines. The name is that of the set, and valid; NULL if the
 * points are only read and dropped. */
void load_start(struct server *s, struct answer *a, const struct word *name, enum body_form form,
                uint32_t count);

/* The LOAD or LOADB line q has been refused, as a tells. Its points are to be skipped if the line
 * says how many they are, else nobody knows where the next request starts: closes. */
void load_skip(struct server *s, const struct request *q, struct answer *a);

/* Feeds it bytes as body_feed does, which see. Gives it up when --max-memory is reached. */
ptrdiff_t load_feed(struct server *s, struct load *l, const char *bytes, size_t n, bool last);

/* Whether so little has come for --load-timeout that it holds its memory for nothing. To be asked
 * once a second, while its body is being received. */
bool load_stalls(struct load *l, int64_t now_ms);

/* The points are being handed on: the bytes that they will take beside when they have been added. They
 * are no longer the load's to tell (keep_expect). */
size_t load_hand_on_expected(struct server *s, struct load *l);

void load_free(struct server *s, struct load *l);

#endif
