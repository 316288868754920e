/* role.h - what a data directory remembers in its file `role`, so that a follower is not a leader after a restart: one line,
 * `follow ADDR PORT`, or `fenced HISTORY` after it has met a newer history of its own origin (a follower of it was promoted).
 * A leader has no such file. */
#ifndef SERVER_ROLE_H
#define SERVER_ROLE_H

#include "server/disk/datadir.h"

enum { ROLE_ADDRESS = 80 };

struct remembered_role {
    char host[ROLE_ADDRESS];
    unsigned port; /* 0: it follows none */
    bool fenced;
    struct history newer; /* if it is fenced */
};

/* What the directory of that path remembers; an invalid file counts as none. */
struct remembered_role role_read(const char *path);

/* Replaces the line, "" removes the file; durable on return. False with errno. */
bool role_write(const struct datadir *dir, const char *line);

/* Reads ADDR:PORT, or [ADDR]:PORT. */
bool role_read_address(const char *text, char host[ROLE_ADDRESS], unsigned *port);

#endif
