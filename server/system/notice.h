/* notice.h - lines for the operator, on standard error: one place for all of them, with levels and
 * a limit on how many a second, so that no client can fill a disk by misbehaving.
 *
 *     2026-11-21 12:00:00 delaunayd: warning: a client was refused: too many clients
 *
 * With the journal at the other end (JOURNAL_STREAM) the date is left out, and the level comes
 * first as <3>, which the journal understands (sd-daemon(3)). Any thread may call; nothing locks.
 */
#ifndef SERVER_NOTICE_H
#define SERVER_NOTICE_H

#include <stdbool.h>
#include <stdint.h>

enum notice_level { NOTICE_ERROR, NOTICE_WARNING, NOTICE_INFO, NOTICE_DEBUG };

/* Reads a level's name. False if it is none. */
bool notice_parse_level(const char *text, enum notice_level *level);

/* Its name. */
const char *notice_level_name(enum notice_level level);

/* What is less urgent than this is left out from now on. */
void notice_set_level(enum notice_level level);

/* Whether it would be told; for what is costly to prepare. */
bool notice_wanted(enum notice_level level);

/* Tells one line. What is not printable in it becomes '?', and a long one is cut. Beyond 50 a
 * second they are left out and counted, errors excepted. */
__attribute__((format(printf, 2, 3))) void notice(enum notice_level level, const char *format, ...);

/* For a line that strangers can provoke as often as they like: of each kind one in ten seconds. */
struct notice_rarely {
    int64_t told_ms;   /* when the last one was told; 0: none was */
    uint64_t left_out; /* since then */
};

/* Whether such a line may be told now, a moment of the monotonic clock; then *more is how many were
 * not told before it. One thread's. */
bool notice_rarely(struct notice_rarely *r, int64_t now_ms, uint64_t *more);

/* Once a second: tells how many were left out since. */
void notice_tick(void);

#endif
