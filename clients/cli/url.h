/* url.h - delaunay://[:token@]host[:port][/set]: the address of a daemon, and the name of a set. */
#ifndef CLIENTS_URL_H
#define CLIENTS_URL_H

#include "clients/lib/delaunay_client.h"
#include "proto/request.h"

struct url {
    char host[256], port[8], token[256]; /* host without the brackets of an IPv6 address */
    char set[SET_NAME_LIMIT + 1];        /* "" if none is named */
};

/* Whether it is `private:`, a private server (private_daemon.h). */
bool url_is_private(const struct url *url);

/* Whether the text begins like such a URL. */
bool url_is(const char *text);

/* Reads it, or `private:`; the port is DELAUNAY_PORT unless given. False if it is malformed. */
bool url_read(const char *text, struct url *url);

/* Connects and authenticates, if there is a token. NULL, with a sentence in why[room], on failure. */
struct delaunay_client *url_connect(const struct url *url, char *why, size_t room);

#endif
