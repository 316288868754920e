/* file_calls.h - the calls by which the server changes files: recorded in order, and made to fail or to
 * stop.
 *
 * With -Wl,--wrap=write and so on every such call of the test binary goes through file_calls.c. Each call
 * on a file of the watched directory is recorded as one line; consecutive writes to one file are one line:
 *
 *     create log.1      openat with O_CREAT
 *     write log.1
 *     sync log.1        fsync or fdatasync; `sync .` is the directory, `sync ..` its parent
 *     cut log.1         ftruncate
 *     rename snapshot.4.tmp snapshot.4
 *     link log.1 damaged.log.1
 *     remove log.1
 *
 * The leading zeros of a log sequence number are left out. Failed calls are not recorded. These calls can be made to fail,
 * too, but are never recorded:
 *
 *     read log.1
 *     list .            readdir
 *     allocate reserve  posix_fallocate
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Starts recording; forgets earlier lines and failures that were set up. */
void calls_watch(const char *directory);

/* The lines so far, valid until the next call of this file. */
const char *calls_text(void);

/* Returns how many of them equal this line. */
unsigned calls_count(const char *line);

/* Whether these lines are the last ones. */
bool calls_end(const char *lines);

/* Of the calls from now on that are this line, the n-th (counted from 1) and `times` - 1 after it
 * fail with this error. The line "*": of all calls; if all from the n-th on fail, the files are those after a kill. */
void calls_fail(const char *line, unsigned n, unsigned times, int error);

/* Returns how many calls have failed so far. */
unsigned calls_failed(void);

/* From now on `bytes` bytes can be written; a write beyond that writes what fits, the next one fails
 * with ENOSPC. Removing the file `reserve` makes room for the same number again. */
void calls_limit_space(size_t bytes);

/* Calls that are this line wait from now on, until calls_go_on. */
void calls_stop(const char *line);

/* Waits until a call has stopped. */
void calls_await_stopped(void);
void calls_go_on(void);
