/* sock.h - the sockets that clients come in by. */
#ifndef SERVER_SOCK_H
#define SERVER_SOCK_H

#include <stdbool.h>
#include <stdint.h>

enum sock_kind { SOCK_UNIX, SOCK_V4, SOCK_V6 };

/* Where a client is. */
struct sock_peer {
    enum sock_kind kind;
    uint16_t port;
    uint8_t address[16]; /* SOCK_V4: the first four bytes */
};

enum { SOCK_PEER_TEXT = 64 };

/* A socket that listens on the numeric address and port (0: any free one, told in *port); -1, with
 * the reason on standard error. */
int sock_listen(const char *address, unsigned *port);

/* The same on a Unix socket. A socket file that nobody listens on any more is replaced. */
int sock_listen_unix(const char *path);

/* Whether only this machine's processes can reach the listening socket. */
bool sock_is_local(int fd);

/* Its port; 0 for a Unix socket. */
unsigned sock_port(int fd);

/* Options of a listening socket that Linux hands on to the connections it accepts: no Nagle's delay,
 * and probes that notice when the other machine is gone. sock_listen sets them; to be called for a
 * socket that comes from elsewhere. Without effect on a Unix socket. */
void sock_prepare(int listener);

/* Accepts one non-blocking connection from *peer; -1 with errno. */
int sock_accept(int listener, struct sock_peer *peer);

/* Writes `address:port`, an IPv6 address in brackets, or `unix`. */
void sock_peer_text(const struct sock_peer *peer, char text[SOCK_PEER_TEXT]);

/* Sends one line of refusal as far as the system takes it at once, and closes. A first request that
 * has come already is read, because closing with unread input resets the connection, and a reset
 * may overtake the line. Only so much is read, once: strangers who send without end are reset, and
 * cost those who are being served nothing more. */
void sock_refuse(int fd, const char *line);

#endif
