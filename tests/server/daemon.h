/* daemon.h - conversations with a test's daemon (tests/daemon.h), and its resource usage. Any
 * failure ends the test. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tests/daemon.h"

void say(int fd, const char *text);
void say_bytes(int fd, const void *bytes, size_t n);

/* Reads exactly the length of `want` and compares. */
void expect(int fd, const char *want);
#define expect(...) TEST_CALL(expect(__VA_ARGS__))

/* Reads one line that is no comment, its LF removed; the text lives until the next call. */
const char *hear_line(int fd);

/* Reads exactly n bytes. */
void hear_exactly(int fd, void *to, size_t n);

/* Reads to the end of input and leaves out comments about progress, which a client that has closed
 * its sending side may get; the caller frees it. It is NUL-terminated. */
char *hear_all(int fd, size_t *n);

/* The same with the comments. */
char *hear_all_and_comments(int fd, size_t *n);

/* The daemon has closed the connection, with nothing left to read. */
void expect_end(int fd);

/* A connection of its own: sends all of `request`, closes the sending side, and compares all that
 * comes back. */
void converse(const struct daemon *d, const char *request, const char *want);
#define converse(...) TEST_CALL(converse(__VA_ARGS__))

/* A connection to a Unix socket; -1: no process listens at the path. */
int connect_unix(const char *path);

/* The value of an INFO key. */
uint64_t daemon_info(const struct daemon *d, const char *key);

/* Waits until an INFO key has this value; fails if it does not change for some seconds. */
void await_info(const struct daemon *d, const char *key, uint64_t want);

/* Waits until an INFO key has at least this value, at most 10 seconds. */
void await_info_least(const struct daemon *d, const char *key, uint64_t least);

/* The value of an INFO key on an open connection: a new connection might be refused. */
uint64_t info_of(int fd, const char *key);

/* Waits until bytes can be read, and leaves them there: a reply has begun. At most 10 seconds. */
void await_input(int fd);

/* Loads n points at random places of the unit square into the new set. */
void load_random(int fd, const char *set, uint32_t n);

/* Resident memory of the daemon now, and the most that it has had; consumed processor time. */
size_t daemon_resident(const struct daemon *d);
size_t daemon_peak_resident(const struct daemon *d);
double daemon_cpu_seconds(const struct daemon *d);

double seconds(void);
void pause_ms(unsigned ms);
