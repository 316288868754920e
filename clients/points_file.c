/* points_file.c - points from text, a block of the file at a time. */
#include "clients/points_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "proto/number.h"

#define BLOCK (256 * 1024)
#define LINE_MAX_BYTES 65536

static bool fault(struct points_file *f, const char *what)
{
    f->fault = what;
    return false;
}

static bool append(struct points_file *f, double x, double y)
{
    if (f->n == f->cap) {
        size_t cap = f->cap == 0 ? 4096 : 2 * f->cap;
        double *xy = realloc(f->xy, cap * 2 * sizeof xy[0]);
        if (xy == NULL) {
            f->line = 0;
            return fault(f, "out of memory");
        }
        f->xy = xy;
        f->cap = cap;
    }
    f->xy[2 * f->n] = x;
    f->xy[2 * f->n + 1] = y;
    f->n++;
    return true;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
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

/* What the server would refuse as RANGE, said here with the line's number [PROTOCOL.md, section 1].
 */
static bool in_range(double v)
{
    return v == 0 || (fabs(v) >= 0x1p-142 && fabs(v) <= 0x1p201);
}

static bool read_line(struct points_file *f, const char *s, const char *end)
{
    const char *word, *rest;
    double v[2];
    f->line++;
    for (int i = 0; i < 2; i++) {
        size_t len = next_word(&s, end, &word);
        if (i == 0 && (len == 0 || word[0] == '#'))
            return true;
        if (len == 0)
            return fault(f, "a point needs x and y");
        if (!proto_read_double(word, len, &v[i]))
            return fault(f, "not a number");
        if (!in_range(v[i]))
            return fault(f, "a coordinate must be 0 or from 2^-142 to 2^201 in magnitude");
    }
    if (next_word(&s, end, &rest) > 0)
        return fault(f, "more than x and y");
    return append(f, v[0], v[1]);
}

/* Reads the whole lines of block[n]; *used is where the rest begins. */
static bool read_lines(struct points_file *f, const char *block, size_t n, size_t *used)
{
    const char *s = block, *end = block + n, *lf;
    while (s < end && (lf = memchr(s, '\n', (size_t)(end - s))) != NULL) {
        if (!read_line(f, s, lf))
            return false;
        s = lf + 1;
    }
    *used = (size_t)(s - block);
    if (n - *used <= LINE_MAX_BYTES)
        return true;
    f->line++;
    return fault(f, "the line is too long");
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
            return fault(f, strerror(errno));
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
    return have == 0 || read_line(f, block, block + have);
}

bool points_file_read(struct points_file *f, int fd, points_file_progress_fn *progress, void *ctx)
{
    char *block = malloc(LINE_MAX_BYTES + BLOCK);
    if (block == NULL)
        return fault(f, "out of memory");
    bool ok = read_blocks(f, fd, block, progress, ctx);
    free(block);
    return ok;
}

void points_file_free(struct points_file *f)
{
    free(f->xy);
    *f = (struct points_file){0};
}
