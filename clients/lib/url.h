/* url.h - delaunay://[:token@]host[:port][/set] or unix://[:token@]/path: the address of a daemon, and the name of a set. A token may
 * have characters as %xx. The clients for Python and Node read the same URLs (tests/data/urls.txt). */
#pragma once

#include <stdbool.h>

#include "proto/request.h"

#define URL_MOST_PORT 65535
#define URL_PORT "6374"

/* For messages. */
#define URL_FORM "delaunay://[:token@]host[:port] or unix://[:token@]/path"
#define URL_SET_NAMES "a set's name is 1 to 64 of the characters A-Z a-z 0-9 _ . : -"

struct url {
    char host
        [256]; /* without the brackets of an IPv6 address; or the path of a Unix socket, which contains a '/' */
    char port[8], token[256];
    char set[SET_NAME_LIMIT + 1]; /* "" if none is named */
};

/* Whether it is `private:`, a private server (private_daemon.h). */
bool url_is_private(const struct url *url);

/* Whether the text begins like such a URL. */
bool url_is(const char *text);

/* Reads it, or `private:`; the port is URL_PORT unless given. False if it is malformed. */
bool url_read(const char *text, struct url *url);
