/* cmd_load.h - a load in progress: points that follow a LOAD or LOADB line. */
#ifndef SERVER_CMD_LOAD_H
#define SERVER_CMD_LOAD_H

#include "proto/body.h"
#include "proto/reply.h"
#include "server/server.h"

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

/* The LOAD or LOADB line q has been refused, as a tells. Its points are to be skipped if the line
 * says how many they are, else nobody knows where the next request starts: closes. */
void load_skip(struct server *s, const struct request *q, struct answer *a);

/* Feeds it bytes as body_feed does, which see. Gives it up when --max-memory is reached. */
ptrdiff_t load_feed(struct server *s, struct load *l, const char *bytes, size_t n, bool last);

/* Whether so little has come for --load-timeout that it holds its memory for nothing. To be asked
 * once a second, while its body is being received. */
bool load_stalls(struct load *l, int64_t now_ms);

/* Carries out a load whose body is complete: adds the points, or tells what was wrong with them.
 * Afterwards the load is spent unless a->next is ANSWER_WAIT: then it is to be called again when its turn
 * comes. */
void load_commit(struct server *s, struct load *l, struct answer *a);

void load_free(struct server *s, struct load *l);

#endif
