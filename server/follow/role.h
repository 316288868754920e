/* role.h - what a data directory remembers about its role, in the file `role`:
 *
 *     follow ADDR PORT [own]    it follows that daemon; own: it may have changes that no leader has sent
 *     lead ADDR PORT            it was promoted, and its former leader there has not been informed of that yet
 *     lead                      it was promoted
 *     fenced HISTORY            it has met a newer history of its own origin: a follower of it was promoted
 *     flag ADDR:PORT            a further line: the --follow of the last start
 *     history HISTORY           a further line after a promotion: the history that began with it; the log gets it later
 *
 * A directory without that file is a leader's. */
#pragma once

#include "server/disk/datadir.h"

enum { ROLE_ADDRESS = 80 };

struct remembered_role {
    enum role_kind { ROLE_UNKNOWN, ROLE_FOLLOWS, ROLE_LEADS, ROLE_FENCED } kind;
    char host[ROLE_ADDRESS];
    unsigned port; /* 0: none */
    bool own;
    /* ROLE_FENCED: the history that is newer than its own; ROLE_LEADS: the one that its promotion began, or none. */
    struct history newer;
    char flag[ROLE_ADDRESS + 12];
};

/* Returns the role that the directory of that path remembers; an invalid line counts as none. */
struct remembered_role role_read(const char *path);

/* Replaces the file; durable on return. False with errno. */
bool role_write(const struct datadir *dir, const struct remembered_role *r);

/* The last decision counts: an address of --follow that differs from that of the last start, otherwise the remembered
 * role. `flag`: NULL without --follow. False: it is no address. */
bool role_decide(struct remembered_role *r, const char *flag);

/* Writes ADDR:PORT, with brackets around an IPv6 address. */
enum { ROLE_TEXT = ROLE_ADDRESS + 14 };
void role_write_address(char text[ROLE_TEXT], const char *host, unsigned port);

/* Reads ADDR:PORT, or [ADDR]:PORT. */
bool role_read_address(const char *text, char host[ROLE_ADDRESS], unsigned *port);
