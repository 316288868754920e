/* peer.h - the other end of a connection: a server that the test itself runs in a child process. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Listens on a free port of the loopback address and, in a child process, calls serve(fd) for one
 * connection after the other; the child ends with the test. The port's digits go to port[8]. */
void peer_start(char *port, void (*serve)(int fd));

/* The same on a Unix socket. */
void peer_start_unix(const char *path, void (*serve)(int fd));

/* Writes n bytes, or as many as the other side accepts before it disconnects. */
void peer_send(int fd, const void *bytes, size_t n);

/* The same for a text. */
void peer_say(int fd, const char *text);

/* Reads a line into line[room], without its LF; false at the end of the input. */
bool peer_hear(int fd, char *line, size_t room);

/* Runs a shell command; returns its standard output (static storage) and, in *status, its exit status. */
const char *peer_shell(int *status, const char *format, ...) __attribute__((format(printf, 2, 3)));
