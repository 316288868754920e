/* points_file.c - points from text, a block of the file at a time. */
#include "clients/files/points_file.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "proto/number.h"

#define BLOCK (256 * 1024)
#define LINE_MAX_BYTES 65536

bool points_file_fault(struct points_file *f, const char *what)
{
    f->fault = what;
    return false;
}

bool points_file_stop(struct points_file *f, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(f->text, sizeof f->text, format, values);
    va_end(values);
    f->fault = f->text;
    f->fatal = true;
    return false;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

bool points_file_skip(struct points_file *f, const char *s, size_t len)
{
    if (!f->skip_bad || f->fatal)
        return false;
    if (f->skipped < SKIPPED_SHOWN) {
        f->skip[f->skipped].line = f->line;
        snprintf(f->skip[f->skipped].fault, sizeof f->skip[0].fault, "%s", f->fault);
        while (len > 0 && is_blank(s[len - 1]))
            len--;
        snprintf(f->skip[f->skipped].text, sizeof f->skip[0].text, "%.*s", len < 59 ? (int)len : 59,
                 s);
    }
    f->skipped++;
    return true;
}

static bool grow(struct points_file *f)
{
    size_t cap = f->cap == 0 ? 4096 : 2 * f->cap;
    double *xy = realloc(f->xy, cap * 2 * sizeof xy[0]);
    if (xy != NULL)
        f->xy = xy;
    double *value = f->fields > 0 ? realloc(f->value, cap * f->fields * sizeof value[0]) : NULL;
    if (value != NULL)
        f->value = value;
    if (xy == NULL || (value == NULL && f->fields > 0)) {
        f->line = 0;
        return points_file_stop(f, "out of memory");
    }
    f->cap = cap;
    return true;
}

static bool append(struct points_file *f, double x, double y)
{
    if (f->n == f->cap && !grow(f))
        return false;
    f->xy[2 * f->n] = x;
    f->xy[2 * f->n + 1] = y;
    for (size_t i = 0; i < f->fields; i++)
        f->value[f->fields * f->n + i] = f->row != NULL ? f->row[i] : (double)NAN;
    f->n++;
    return true;
}

/* The next word of *s .. end, moved behind it; its length is 0 at the end of the line. */
static size_t next_word(const char **s, const char *end, const char **word)
{
    const char *p = *s;
    while (p < end && is_blank(*p))
        p++;
    *word = p;
    while (p < end && !is_blank(*p))
        p++;
    *s = p;
    return (size_t)(p - *word);
}

/* Values that the server would refuse as RANGE, reported here with the line's number [PROTOCOL.md, section
 * 1]. */
static bool in_range(double v)
{
    return v == 0 || (fabs(v) >= 0x1p-142 && fabs(v) <= 0x1p201);
}

bool points_file_add(struct points_file *f, const char *x, size_t x_len, const char *y,
                     size_t y_len)
{
    double v[2];
    if (!proto_read_double(x, x_len, &v[0]) || !proto_read_double(y, y_len, &v[1]))
        return points_file_fault(f, "not a number");
    if (!in_range(v[0]) || !in_range(v[1]))
        return points_file_fault(f, "a coordinate must be 0 or from 2^-142 to 2^201 in magnitude");
    return append(f, v[0], v[1]);
}

static bool read_xy(struct points_file *f, const char *s, const char *end)
{
    const char *x, *y, *rest;
    size_t x_len = next_word(&s, end, &x);
    if (x_len == 0 || x[0] == '#')
        return true;
    size_t y_len = next_word(&s, end, &y);
    double v;
    if (y_len == 0)
        return points_file_fault(f, proto_read_double(x, x_len, &v) ? "a point needs x and y"
                                                                    : "not a number");
    return points_file_add(f, x, x_len, y, y_len) &&
           (next_word(&s, end, &rest) == 0 ||
            points_file_fault(f, "more than x and y; --columns 1,2 takes the first two"));
}

static bool read_line(struct points_file *f, const char *s, const char *end)
{
    f->line++;
    if (f->line == 1 && end - s >= 3 && memcmp(s, "\xEF\xBB\xBF", 3) == 0)
        s += 3; /* the byte order mark of UTF-8 */
    uint64_t first = f->line;
    for (const char *lf = s; f->find_end != NULL && lf < end; lf++) {
        lf = memchr(lf, '\n', (size_t)(end - lf));
        if (lf == NULL)
            break;
        f->line++; /* a line break in quotes */
    }
    uint64_t last = f->line;
    f->line = first;
    bool ok = f->parse_line != NULL ? f->parse_line(f, s, end) : read_xy(f, s, end);
    if (!ok && !points_file_skip(f, s, (size_t)(end - s)))
        return false;
    f->line += last - first;
    return true;
}

static const char *find_end(const struct points_file *f, const char *s, const char *end)
{
    return f->find_end != NULL ? f->find_end(f, s, end) : memchr(s, '\n', (size_t)(end - s));
}

/* Reads the whole lines of block[n]; *used is where the rest begins. */
static bool read_lines(struct points_file *f, const char *block, size_t n, size_t *used)
{
    const char *s = block, *end = block + n, *lf;
    while (s < end && (lf = find_end(f, s, end)) != NULL) {
        if (!read_line(f, s, lf))
            return false;
        s = lf + 1;
    }
    *used = (size_t)(s - block);
    if (n - *used <= LINE_MAX_BYTES)
        return true;
    f->line++;
    return points_file_stop(f, memchr(s, '"', (size_t)(end - s)) != NULL
                                   ? "the line is too long, or a quote is not closed"
                                   : "the line is too long");
}

static bool read_blocks(struct points_file *f, int fd, char *block,
                        points_file_progress_fn *progress, void *ctx)
{
    size_t have = 0, used = 0;
    uint64_t total = 0;
    ssize_t n;
    while ((n = read(fd, block + have, BLOCK)) != 0) {
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0) {
            f->line = 0;
            return points_file_stop(f, "%s", strerror(errno));
        }
        have += (size_t)n;
        total += (uint64_t)n;
        if (!read_lines(f, block, have, &used))
            return false;
        have -= used;
        memmove(block, block + used, have);
        if (progress != NULL)
            progress(ctx, total, f->n);
    }
    if (f->find_end != NULL && memchr(block, '\n', have) != NULL) {
        f->line++;
        return points_file_stop(f, "a quote is not closed");
    }
    return have == 0 || read_line(f, block, block + have);
}

bool points_file_read(struct points_file *f, int fd, points_file_progress_fn *progress, void *ctx)
{
    char *block = malloc(LINE_MAX_BYTES + BLOCK);
    if (block == NULL)
        return points_file_stop(f, "out of memory");
    bool ok = read_blocks(f, fd, block, progress, ctx);
    free(block);
    return ok;
}

void points_file_free(struct points_file *f)
{
    free(f->xy);
    free(f->value);
    *f = (struct points_file){0};
}
