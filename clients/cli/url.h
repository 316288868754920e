/* url.h - delaunay://[:token@]host[:port][/set]: where a daemon is, and which set is meant. */
#ifndef CLIENTS_URL_H
#define CLIENTS_URL_H

#include "clients/lib/delaunay_client.h"
#include "proto/request.h"

struct url {
    char host[256], port[8], token[256]; /* host without the brackets of an IPv6 address */
    char set[SET_NAME_LIMIT + 1];        /* "" if none is named */
};

/* Whether it is `private:`, a server of one's own (private_daemon.h). */
bool url_is_private(const struct url *url);

/* Whether the text claims to be such a URL. */
bool url_is(const char *text);

/* Reads it, or `private:`; the port is DELAUNAY_PORT unless given. False if it is malformed. */
bool url_read(const char *text, struct url *url);

/* Connects and shows the token, if there is one. NULL, with a sentence in why[room], on failure. */
struct delaunay_client *url_connect(const struct url *url, char *why, size_t room);

#endif
