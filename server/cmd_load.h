/* cmd_load.h - a load in progress: points that follow a LOAD or LOADB line. */
#ifndef SERVER_CMD_LOAD_H
#define SERVER_CMD_LOAD_H

#include "proto/body.h"
#include "server/server.h"

struct load {
    struct body body;
    size_t memory;  /* bytes that are accounted for it */
    bool last_seen; /* the input ended within it */
    size_t name_len;
    char name[SET_NAME_LIMIT];
};

/* Feeds it bytes as body_feed does, which see. Gives it up when --max-memory is reached. */
ptrdiff_t load_feed(struct server *s, struct load *l, const char *bytes, size_t n, bool last);

/* Carries out a load whose body is complete: adds the points, or tells what was wrong with them.
 * Afterwards the load is spent unless a->wait is set: then it is to be called again when that set
 * is free. */
void load_commit(struct server *s, struct load *l, struct answer *a);

void load_free(struct server *s, struct load *l);

#endif
