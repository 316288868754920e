/* notice.h - messages to the operator, on standard error, with levels and a limit on how many a
 * second, so that no client can fill a disk by misbehaving.
 *
 *     2026-11-21 12:00:00 delaunayd: warning: a client was refused: too many clients
 *
 * If standard error is the journal (JOURNAL_STREAM), the date is left out and the level comes first, as
 * <3> (sd-daemon(3)). Any thread may call, and none waits: see outlet.h. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum notice_level { NOTICE_ERROR, NOTICE_WARNING, NOTICE_INFO, NOTICE_DEBUG };

/* Parses a level's name. False: it is none. */
bool notice_parse_level(const char *text, enum notice_level *level);

/* Its name. */
const char *notice_level_name(enum notice_level level);

/* Less urgent messages are left out from now on. */
void notice_set_level(enum notice_level level);

/* Whether a message of this level is written; for messages that are expensive to prepare. */
bool notice_wanted(enum notice_level level);

/* Writes one line, soon. Characters that are not printable become '?', and a long line is cut. Beyond 50 lines a second,
 * all but errors are left out and counted; so are lines that standard error does not take. */
__attribute__((format(printf, 2, 3))) void notice(enum notice_level level, const char *format, ...);

/* The same for an error. Returns false, which a caller that has failed returns. */
__attribute__((format(printf, 1, 2))) bool notice_error(const char *format, ...);

/* For a message that clients can provoke as often as they like: at most one in ten seconds. */
struct notice_rarely {
    int64_t last_ms;   /* when the last one was written; 0: never */
    uint64_t left_out; /* since then */
};

/* Whether such a message may be written at now_ms (monotonic); then *more is how many were left out
 * before it. Not for several threads. */
bool notice_rarely(struct notice_rarely *r, int64_t now_ms, uint64_t *more);

/* To be called once a second: reports how many lines were left out. */
void notice_tick(void);

/* At the end of the process: waits until the lines have been written, at most `ms` milliseconds. */
void notice_flush(unsigned ms);
