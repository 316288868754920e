/* role.h - what a data directory remembers about its role, in the file `role`:
 *
 *     follow ADDR PORT [own]    it follows that daemon; own: it may have changes that no leader has sent
 *     lead ADDR PORT            it was promoted, and its former leader there has not been informed of that yet
 *     lead                      it was promoted
 *     fenced HISTORY            it has met a newer history of its own origin: a follower of it was promoted
 *     flag ADDR:PORT            a second line: the --follow of the last start
 *
 * A directory without that file is a leader's, and one that was promoted does not need the file without a flag. */
#ifndef SERVER_ROLE_H
#define SERVER_ROLE_H

#include "server/disk/datadir.h"

enum { ROLE_ADDRESS = 80 };

struct remembered_role {
    enum role_kind { ROLE_UNKNOWN, ROLE_FOLLOWS, ROLE_LEADS, ROLE_FENCED } kind;
    char host[ROLE_ADDRESS];
    unsigned port; /* 0: none */
    bool own;
    struct history newer; /* than its own: fenced by that one */
    char flag[ROLE_ADDRESS + 12];
};

/* What the directory of that path remembers; an invalid line counts as none. */
struct remembered_role role_read(const char *path);

/* Replaces the file; durable on return. False with errno. */
bool role_write(const struct datadir *dir, const struct remembered_role *r);

/* The last decision counts: that of a --follow which is not that of the last start, or else what the directory remembers.
 * `flag`: NULL without --follow. False: it is no address. */
bool role_decide(struct remembered_role *r, const char *flag);

/* Reads ADDR:PORT, or [ADDR]:PORT. */
bool role_read_address(const char *text, char host[ROLE_ADDRESS], unsigned *port);

#endif
