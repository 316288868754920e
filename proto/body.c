/* body.c - see body.h. */
#include "proto/body.h"

#include "proto/number.h"
#include "proto/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FIRST_CAPACITY = 64,
    POINT_BYTES = 16 /* in a binary body */
};

void body_init(struct body *b, enum body_form form, uint64_t count, size_t limit,
               bool (*coordinates_ok)(const double *v, size_t n))
{
    *b = (struct body){
        .form = form, .left = count, .limit = limit, .coordinates_ok = coordinates_ok};
    b->complete = form != BODY_DOT && count == 0;
    body_columns(b, 2, 0);
}

void body_columns(struct body *b, size_t coordinates, size_t values)
{
    b->coordinates = coordinates;
    b->width = coordinates + values;
}

/* Bytes of a point. */
static size_t point_bytes(const struct body *b)
{
    return b->width * sizeof *b->xy;
}

void body_free(struct body *b)
{
    if (b->memory.release != NULL)
        b->memory.release(b->xy);
    else
        free(b->xy);
    b->xy = NULL;
    b->n = b->cap = 0;
}

void body_fail(struct body *b, enum body_fault fault)
{
    if (b->fault != BODY_GOOD)
        return;
    b->fault = fault;
    b->fault_line = b->line;
    body_free(b);
}

/* The number of points to allocate room for. The announced count is not trusted: memory follows what has
 * arrived. Once an eighth has arrived, the announced count is probably true. */
static size_t capacity(const struct body *b)
{
    size_t cap = b->cap == 0 ? FIRST_CAPACITY : 2 * b->cap;
    if (b->form == BODY_DOT)
        return cap;
    uint64_t all = b->n + b->left + 1; /* `left` may or may not include the current point */
    all = all < b->limit ? all : b->limit;
    return all > b->n && all <= 4 * (uint64_t)cap ? (size_t)all : cap;
}

static bool grow(struct body *b)
{
    size_t cap = capacity(b), bytes = point_bytes(b);
    if (cap > SIZE_MAX / bytes)
        return false;
    double *xy = b->memory.grow == NULL
                     ? realloc(b->xy, cap * bytes)
                     : b->memory.grow(b->memory.ctx, b->xy, b->n * bytes, cap * bytes);
    if (xy == NULL)
        return false;
    b->xy = xy;
    b->cap = cap;
    return true;
}

/* Makes room for one more point. */
static bool reserve(struct body *b)
{
    if (b->n >= b->limit)
        body_fail(b, BODY_TOOBIG);
    else if (b->n == b->cap && !grow(b))
        body_fail(b, BODY_NOMEM);
    return b->fault == BODY_GOOD;
}

static void add_point(struct body *b, double x, double y)
{
    const double v[2] = {x, y};
    if (b->fault != BODY_GOOD)
        return;
    if (!b->coordinates_ok(v, 2)) { /* only a binary body can have a NaN */
        body_fail(b, isnan(x) || isnan(y) ? BODY_NUMBER : BODY_RANGE);
    } else if (reserve(b)) {
        b->xy[2 * b->n] = x;
        b->xy[2 * b->n + 1] = y;
        b->n++;
    }
}

/* The error for number i of a point. */
static enum body_fault judge(const struct body *b, size_t i, double v)
{
    if (i >= b->coordinates)
        return isinf(v) ? BODY_VALUE : BODY_GOOD;
    return isnan(v) ? BODY_NUMBER : b->coordinates_ok(&v, 1) ? BODY_GOOD : BODY_RANGE;
}

/* ---- text ---- */

/* The next word between *p and end, moving *p behind it; its length is 0 at the end. */
static const char *next_word(const char **p, const char *end, size_t *len)
{
    while (*p < end && text_is_blank(**p))
        (*p)++;
    const char *word = *p;
    while (*p < end && !text_is_blank(**p))
        (*p)++;
    *len = (size_t)(*p - word);
    return word;
}

static bool read_number(const struct body *b, size_t i, const char *word, size_t len, double *v)
{
    if (i < b->coordinates || len != 3 || (word[0] | 0x20) != 'n' || (word[1] | 0x20) != 'a' ||
        (word[2] | 0x20) != 'n')
        return proto_read_double(word, len, v);
    *v = (double)NAN;
    return true;
}

/* A line with the values of fields. */
static void take_wide_line(struct body *b, const struct line *line)
{
    const char *p = line->text, *end = p + line->len;
    size_t len, i = 0;
    const char *word = next_word(&p, end, &len);
    if (b->fault != BODY_GOOD || len == 0 || *word == '#' || !reserve(b))
        return;
    double *to = b->xy + b->n * b->width;
    enum body_fault fault = BODY_GOOD;
    for (; i < b->width && len > 0 && fault == BODY_GOOD; i++) {
        fault = read_number(b, i, word, len, &to[i]) ? judge(b, i, to[i]) : BODY_NUMBER;
        word = next_word(&p, end, &len);
    }
    if (fault == BODY_GOOD && (i < b->width || len > 0))
        fault = BODY_SYNTAX;
    if (fault != BODY_GOOD)
        body_fail(b, fault);
    else
        b->n++;
}

static void take_line(struct body *b, const struct line *line)
{
    if (b->width != 2 || b->coordinates != 2) {
        take_wide_line(b, line);
        return;
    }
    const char *p = line->text, *end = p + line->len;
    size_t x_len, y_len, more_len;
    const char *x_word = next_word(&p, end, &x_len);
    if (b->fault != BODY_GOOD || x_len == 0 || *x_word == '#')
        return;
    const char *y_word = next_word(&p, end, &y_len);
    next_word(&p, end, &more_len);
    double x, y;
    if (y_len == 0 || more_len != 0)
        body_fail(b, BODY_SYNTAX);
    else if (!proto_read_double(x_word, x_len, &x) || !proto_read_double(y_word, y_len, &y))
        body_fail(b, BODY_NUMBER);
    else
        add_point(b, x, y);
}

/* Reads a complete line that is exactly `x y`, including its LF or CRLF; returns its number of
 * bytes. 0: the line is different or incomplete; then line_read and take_line
 * decide. One pass over the bytes instead of five. */
static size_t take_plain_line(struct body *b, const char *bytes, size_t n)
{
    const char *p = bytes, *end = bytes + n;
    double x, y;
    bool plain = b->fault == BODY_GOOD && b->width == 2;
    size_t len = plain ? proto_read_leading_double(p, n, &x) : 0;
    p += len;
    if (len == 0 || p == end || !text_is_blank(*p))
        return 0;
    while (p < end && text_is_blank(*p))
        p++;
    len = proto_read_leading_double(p, (size_t)(end - p), &y);
    p += len;
    if (len == 0 || p == end)
        return 0;
    p += *p == '\r';
    if (p == end || *p != '\n' || p - bytes > LINE_LIMIT)
        return 0;
    b->line++;
    add_point(b, x, y);
    return (size_t)(p + 1 - bytes);
}

static bool is_dot(const struct line *line)
{
    return line->len == 1 && line->text[0] == '.';
}

static ptrdiff_t feed_lines(struct body *b, const char *bytes, size_t n, bool last)
{
    size_t at = 0;
    while (!b->complete) {
        struct line line;
        size_t plain = take_plain_line(b, bytes + at, n - at);
        if (plain > 0) {
            at += plain;
            b->complete = b->form == BODY_LINES && --b->left == 0;
            continue;
        }
        ptrdiff_t took = line_read(bytes + at, n - at, last, &line);
        if (took < 0) {
            b->line_fault = line.fault;
            return -1;
        }
        if (took == 0)
            break;
        at += (size_t)took;
        b->line++;
        if (b->form == BODY_DOT && is_dot(&line)) {
            b->complete = true;
        } else {
            take_line(b, &line);
            b->complete = b->form == BODY_LINES && --b->left == 0;
        }
    }
    return (ptrdiff_t)at;
}

/* ---- binary ---- */

static double little_endian_double(const char *bytes)
{
    uint64_t bits = 0;
    double v;
    for (unsigned i = 0; i < 8; i++)
        bits |= (uint64_t)(unsigned char)bytes[i] << 8 * i;
    memcpy(&v, &bits, sizeof v);
    return v;
}

static void take_wide_point(struct body *b, const char *bytes)
{
    if (b->fault != BODY_GOOD || !reserve(b))
        return;
    double *to = b->xy + b->n * b->width;
    enum body_fault fault = BODY_GOOD;
    for (size_t i = 0; i < b->width && fault == BODY_GOOD; i++) {
        to[i] = little_endian_double(bytes + 8 * i);
        fault = judge(b, i, to[i]);
    }
    if (fault != BODY_GOOD)
        body_fail(b, fault);
    else
        b->n++;
}

/* Drops bytes of points of a body that has a fault. A point may be longer than the caller's buffer. */
static ptrdiff_t skip_points(struct body *b, size_t n)
{
    uint64_t size = point_bytes(b), all = b->left * size - b->dropped, at;
    n = n < all ? n : (size_t)all;
    at = b->dropped + n;
    b->left -= at / size;
    b->line += at / size;
    b->dropped = (size_t)(at % size);
    b->complete = b->left == 0;
    return (ptrdiff_t)n;
}

static ptrdiff_t feed_wide(struct body *b, const char *bytes, size_t n)
{
    size_t at = 0, size = point_bytes(b);
    if (b->fault != BODY_GOOD)
        return skip_points(b, n);
    for (; b->left > 0 && n - at >= size; at += size) {
        b->left--;
        b->line++;
        take_wide_point(b, bytes + at);
    }
    b->complete = b->left == 0;
    return (ptrdiff_t)at;
}

static void copy_doubles(double *to, const char *bytes, size_t n)
{
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    memcpy(to, bytes, n * sizeof *to);
#else
    for (size_t i = 0; i < n; i++)
        to[i] = little_endian_double(bytes + 8 * i);
#endif
}

/* Adds n points at once. False, with nothing done: there is no room, or one of them is invalid. A binary body never has
 * room for more than `limit` (capacity). */
static bool add_run(struct body *b, const char *bytes, size_t n)
{
    if (n > b->cap - b->n)
        return false;
    double *to = b->xy + 2 * b->n;
    copy_doubles(to, bytes, 2 * n);
    if (!b->coordinates_ok(to, 2 * n))
        return false;
    b->n += n;
    return true;
}

static void take_points(struct body *b, const char *bytes, size_t n)
{
    if (b->fault != BODY_GOOD || add_run(b, bytes, n)) {
        b->line += n;
        return;
    }
    for (const char *end = bytes + n * POINT_BYTES; bytes < end; bytes += POINT_BYTES) {
        b->line++;
        add_point(b, little_endian_double(bytes), little_endian_double(bytes + 8));
    }
}

static ptrdiff_t feed_binary(struct body *b, const char *bytes, size_t n)
{
    if (b->width != 2 || b->coordinates != 2)
        return feed_wide(b, bytes, n);
    size_t points = n / POINT_BYTES < b->left ? n / POINT_BYTES : (size_t)b->left;
    if (points > 0)
        take_points(b, bytes, points);
    b->left -= points;
    b->complete = b->left == 0;
    return (ptrdiff_t)(points * POINT_BYTES);
}

ptrdiff_t body_feed(struct body *b, const char *bytes, size_t n, bool last)
{
    if (bytes == NULL) /* an empty buffer has no address to count from */
        bytes = "";
    ptrdiff_t took =
        b->form == BODY_BINARY ? feed_binary(b, bytes, n) : feed_lines(b, bytes, n, last);
    if (last && took >= 0 && !b->complete) {
        b->line++;
        body_fail(b, BODY_ENDED);
        b->complete = true;
        return (ptrdiff_t)n;
    }
    return took;
}
