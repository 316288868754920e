/* notice.c - see notice.h. */
#include "server/system/notice.h"

#include "server/system/outlet.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { PER_SECOND = 50, LINE = OUTLET_LINE, RARELY_MS = 10 * 1000 };

static const char *const level_name[] = {"error", "warning", "info", "debug"};
static const int priority[] = {3, 4, 6, 7}; /* syslog's */

static atomic_int limit = NOTICE_INFO;
static _Atomic int64_t second; /* in which `written` lines were written */
static atomic_uint written, left_out;
static struct outlet outlet = OUTLET(STDERR_FILENO);

bool notice_parse_level(const char *text, enum notice_level *level)
{
    for (int i = NOTICE_ERROR; i <= NOTICE_DEBUG; i++) {
        if (strcmp(text, level_name[i]) == 0) {
            *level = (enum notice_level)i;
            return true;
        }
    }
    return false;
}

const char *notice_level_name(enum notice_level level)
{
    return level_name[level];
}

void notice_set_level(enum notice_level level)
{
    limit = (int)level;
}

bool notice_wanted(enum notice_level level)
{
    return (int)level <= limit;
}

/* Writes the date and the level; returns their length. */
static size_t write_head(char *line, enum notice_level level, time_t now)
{
    struct tm t;
    char date[32] = "";
    int n = 0;
    if (getenv("JOURNAL_STREAM") != NULL)
        n = snprintf(line, LINE, "<%d>delaunayd: ", priority[level]);
    else if (localtime_r(&now, &t) != NULL && strftime(date, sizeof date, "%F %T", &t) > 0)
        n = snprintf(line, LINE, "%s delaunayd: %s: ", date, level_name[level]);
    return n > 0 ? (size_t)n : 0;
}

/* worth: lines that are lost with this one. */
__attribute__((format(printf, 3, 0))) static void
vwrite_line(enum notice_level level, unsigned worth, const char *format, va_list ap)
{
    char line[LINE];
    size_t at = write_head(line, level, time(NULL));
    int n = vsnprintf(line + at, LINE - at, format, ap);
    size_t end = n < 0 ? at : at + (size_t)n < LINE ? at + (size_t)n : LINE - 1;
    for (size_t i = at; i < end; i++)
        if (line[i] < ' ' || line[i] > '~')
            line[i] = '?';
    line[end++] = '\n';
    outlet_put(&outlet, line, end, worth);
}

__attribute__((format(printf, 2, 3))) static void report_left_out(unsigned n, const char *format,
                                                                  ...)
{
    va_list ap;
    va_start(ap, format);
    vwrite_line(NOTICE_WARNING, n, format, ap);
    va_end(ap);
}

/* Whether this second has room for one more line. */
static bool may_write(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    int64_t now = (int64_t)t.tv_sec;
    if (atomic_exchange(&second, now) != now)
        written = 0;
    return atomic_fetch_add(&written, 1) < PER_SECOND;
}

void notice(enum notice_level level, const char *format, ...)
{
    va_list ap;
    if (!notice_wanted(level))
        return;
    if (!may_write() && level != NOTICE_ERROR) {
        left_out++;
        return;
    }
    va_start(ap, format);
    vwrite_line(level, 1, format, ap);
    va_end(ap);
}

bool notice_error(const char *format, ...)
{
    va_list ap;
    (void)may_write(); /* it counts */
    va_start(ap, format);
    vwrite_line(NOTICE_ERROR, 1, format, ap);
    va_end(ap);
    return false;
}

bool notice_rarely(struct notice_rarely *r, int64_t now_ms, uint64_t *more)
{
    if (r->last_ms != 0 && now_ms - r->last_ms < RARELY_MS) {
        r->left_out++;
        return false;
    }
    *more = r->left_out;
    *r = (struct notice_rarely){.last_ms = now_ms};
    return true;
}

void notice_tick(void)
{
    unsigned n = atomic_exchange(&left_out, 0) + outlet_take_lost(&outlet);
    if (n > 0)
        report_left_out(n, "%u lines were left out", n);
}

void notice_flush(unsigned ms)
{
    outlet_flush(&outlet, ms);
}
