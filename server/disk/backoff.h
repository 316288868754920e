/* backoff.h - exponential backoff: the first retry comes after half a second, and the interval doubles
 * with each failure, up to a minute. Times are in milliseconds of any monotonic clock. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum { BACKOFF_FIRST_MS = 500, BACKOFF_LIMIT_MS = 60 * 1000 };

struct backoff {
    unsigned failures; /* in a row */
    int64_t next_ms;   /* no retry before this time */
};

static inline void backoff_failed(struct backoff *b, int64_t now_ms)
{
    unsigned doublings = b->failures < 7 ? b->failures : 7;
    int64_t wait = (int64_t)BACKOFF_FIRST_MS << doublings;
    b->failures++;
    b->next_ms = now_ms + (wait < BACKOFF_LIMIT_MS ? wait : BACKOFF_LIMIT_MS);
}

static inline void backoff_succeeded(struct backoff *b)
{
    *b = (struct backoff){0};
}

static inline bool backoff_allows(const struct backoff *b, int64_t now_ms)
{
    return b->failures == 0 || now_ms >= b->next_ms;
}
