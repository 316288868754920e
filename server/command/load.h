/* load.h - the body of a request: points, or places, that follow its line. They are collected as they
 * arrive; when they are all there, the request is carried out, as any other is. */
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
    bool adds;                 /* the points are to be added to a set */
    uint64_t came, seen; /* bytes that have come; as many had when load_stalls last saw progress */
    int64_t seen_ms;     /* when that was; 0: not yet */
    bool refused;    /* that has been told already: the points are only to be read and dropped */
    struct buf line; /* owns: the words of the request, separated by blanks */
};

/* Begins to receive the body of q: a->load. `adds`: it changes the set. If the line does not say how much
 * follows, a says so. */
void load_start(struct server *s, const struct request *q, struct answer *a, bool adds);

/* The request q has been refused, as a tells. Its body is to be skipped if the line says how long it is,
 * else nobody knows where the next request starts: closes. */
void load_skip(struct server *s, const struct request *q, struct answer *a);

/* Says what is wrong with a body that is complete; false: nothing is. */
bool load_refuse(struct server *s, const struct load *l, struct answer *a);

/* Feeds it bytes as body_feed does, which see. Gives it up when --max-memory is reached. */
ptrdiff_t load_feed(struct server *s, struct load *l, const char *bytes, size_t n, bool last);

/* Whether so little has come for --load-timeout that it holds its memory for nothing. To be asked
 * once a second, while its body is being received. */
bool load_stalls(struct load *l, int64_t now_ms);

/* Hands the points on, with their memory: to `memory`, which may have some already. */
struct dt_point *load_take(struct load *l, struct reservation *memory);

/* Of points that are being handed on: the bytes that they will take beside when they have been added. They
 * are no longer the load's to tell (keep_expect). */
size_t load_hand_on_expected(struct server *s, struct load *l);

void load_free(struct server *s, struct load *l);

#endif
