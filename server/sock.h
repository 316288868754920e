/* sock.h - the sockets that clients come in by. */
#ifndef SERVER_SOCK_H
#define SERVER_SOCK_H

#include <stdbool.h>

/* A socket that listens on the numeric address and port (0: any free one, told in *port); -1, with
 * the reason on standard error. */
int sock_listen(const char *address, unsigned *port);

/* The same on a Unix socket. A socket file that nobody listens on any more is replaced. */
int sock_listen_unix(const char *path);

/* Whether only this machine's processes can reach the listening socket. */
bool sock_is_local(int fd);

/* Its port; 0 for a Unix socket. */
unsigned sock_port(int fd);

/* Accepts one connection, non-blocking and without Nagle's delay; -1 with errno. */
int sock_accept(int listener);

/* Sends one line of refusal as far as the system takes it at once, and closes. */
void sock_refuse(int fd, const char *line);

#endif
