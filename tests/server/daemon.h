/* daemon.h - a daemon of its own for a test, and conversations with it. Whatever fails ends the
 * test. */
#ifndef TESTS_SERVER_DAEMON_H
#define TESTS_SERVER_DAEMON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct daemon {
    pid_t pid;
    unsigned port;
};

/* Starts $DELAUNAYD on a free port of the loopback address with these further arguments
 * (NULL-terminated; NULL for none) and waits for its ready line. It goes when the test goes. */
struct daemon daemon_start(const char *const *arguments);

/* Sends the signal, waits, returns the exit status (-1: it was killed). */
int daemon_stop(const struct daemon *d, int sig);

/* Connects; the caller closes. */
int daemon_connect(const struct daemon *d);

void say(int fd, const char *text);
void say_bytes(int fd, const void *bytes, size_t n);

/* Reads exactly as much as `want` is long and compares. */
void expect(int fd, const char *want);

/* Reads one line that is no comment, its LF removed; the text lives until the next call. */
const char *hear_line(int fd);

/* Reads to the end of input; the caller frees it. It is NUL-terminated. */
char *hear_all(int fd, size_t *n);

/* The daemon has closed the connection, with nothing left to read. */
void expect_end(int fd);

/* A connection of its own: sends all of `request`, closes the sending side, and compares all that
 * comes back. */
void converse(const struct daemon *d, const char *request, const char *want);

/* The value of an INFO key. */
uint64_t daemon_info(const struct daemon *d, const char *key);

/* Waits until an INFO key has this value; gives up after some seconds. */
void await_info(const struct daemon *d, const char *key, uint64_t want);

/* Loads n points at random places of the unit square into the new set. */
void load_random(int fd, const char *set, uint32_t n);

/* Resident memory and consumed processor time of the daemon. */
size_t daemon_resident(const struct daemon *d);
double daemon_cpu_seconds(const struct daemon *d);

/* Whether these say something about the daemon: a sanitizer keeps freed memory, and has threads of
 * its own. */
bool costs_are_telling(void);

double seconds(void);
void pause_ms(unsigned ms);

#endif
