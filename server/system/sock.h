/* sock.h - listening sockets, and the addresses of clients. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum sock_kind { SOCK_UNIX, SOCK_V4, SOCK_V6 };

/* The address of a client. */
struct sock_peer {
    enum sock_kind kind;
    uint16_t port;
    uint8_t address[16]; /* SOCK_V4: the first four bytes */
};

enum { SOCK_PEER_TEXT = 64 };

/* A socket that listens on the numeric address and port (0: any free one, returned in *port); -1, with
 * the reason on standard error. */
int sock_listen(const char *address, unsigned *port);

/* The same on a Unix socket. A stale socket file is replaced. */
int sock_listen_unix(const char *path);

/* Whether the text is a numeric IPv4 or IPv6 address. *loopback, unless NULL: only this machine's
   processes reach it. */
bool sock_is_address(const char *text, bool *loopback);

/* Whether only this machine's processes can reach the listening socket. */
bool sock_is_local(int fd);

/* Its port; 0 for a Unix socket. */
unsigned sock_port(int fd);

/* Sets options of a listening socket that accepted connections inherit on Linux: TCP_NODELAY, and
 * keepalive probes that detect an unreachable peer. sock_listen calls it. Call it for a socket from another
 * source. No effect on a Unix socket. */
void sock_prepare(int listener);

/* Accepts one non-blocking connection from *peer; -1 with errno. */
int sock_accept(int listener, struct sock_peer *peer);

/* Writes `address:port`, an IPv6 address in brackets, or `unix`. */
void sock_peer_text(const struct sock_peer *peer, char text[SOCK_PEER_TEXT]);

/* Sends one line without blocking, and closes. A request that has already arrived is read first, because
 * closing with unread input resets the connection, and the reset may overtake the line. The read is
 * bounded: a client that sends without end is reset at no further cost. */
void sock_refuse(int fd, const char *line);
