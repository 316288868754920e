/* reply.c - see reply.h. */
#include "proto/reply.h"

#include "proto/number.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum {
    ID_ROOM = 11,
    U64_ROOM = 20,
    DOUBLE_ROOM = 33
}; /* a number and, but for U64, the character after it */

static const char *const code_name[] = {
    [ERR_SYNTAX] = "SYNTAX",
    [ERR_UNKNOWN] = "UNKNOWN",
    [ERR_NUMBER] = "NUMBER",
    [ERR_RANGE] = "RANGE",
    [ERR_NOSET] = "NOSET",
    [ERR_EXISTS] = "EXISTS",
    [ERR_NOPOINT] = "NOPOINT",
    [ERR_NOEDGE] = "NOEDGE",
    [ERR_NOTRIANGLE] = "NOTRIANGLE",
    [ERR_NOFIELD] = "NOFIELD",
    [ERR_NOCONSTRAINT] = "NOCONSTRAINT",
    [ERR_CROSSES] = "CROSSES",
    [ERR_CONSTRAINED] = "CONSTRAINED",
    [ERR_NOTDELAUNAY] = "NOTDELAUNAY",
    [ERR_NOREGION] = "NOREGION",
    [ERR_OPEN] = "OPEN",
    [ERR_UNTRIANGULATED] = "UNTRIANGULATED",
    [ERR_TOOLONG] = "TOOLONG",
    [ERR_TOOBIG] = "TOOBIG",
    [ERR_BUSY] = "BUSY",
    [ERR_NOMEM] = "NOMEM",
    [ERR_READONLY] = "READONLY",
    [ERR_NOFOLLOWERS] = "NOFOLLOWERS",
    [ERR_NOAUTH] = "NOAUTH",
    [ERR_DENIED] = "DENIED",
    [ERR_TIMEOUT] = "TIMEOUT",
    [ERR_CANCELLED] = "CANCELLED",
    [ERR_LOADING] = "LOADING",
    [ERR_IO] = "IO",
    [ERR_CORRUPT] = "CORRUPT",
};

const char *reply_code_name(enum reply_code code)
{
    return code_name[code];
}

void reply_u64(struct buf *out, uint64_t v)
{
    char *to = buf_reserve(out, U64_ROOM);
    if (to != NULL)
        buf_commit(out, proto_write_u64(to, v));
}

static void append_key(struct buf *out, const char *key)
{
    buf_append_char(out, ' ');
    buf_append_text(out, key);
    buf_append_char(out, '=');
}

void reply_ok(struct buf *out, uint64_t rows)
{
    char *to = buf_reserve(out, 3 + U64_ROOM);
    if (to == NULL)
        return;
    memcpy(to, "OK ", 3);
    buf_commit(out, 3 + proto_write_u64(to + 3, rows));
}

void reply_key_u64(struct buf *out, const char *key, uint64_t value)
{
    size_t len = strlen(key);
    char *to = buf_reserve(out, len + 2 + U64_ROOM);
    if (to == NULL)
        return;
    *to++ = ' ';
    memcpy(to, key, len);
    to[len] = '=';
    buf_commit(out, len + 2 + proto_write_u64(to + len + 1, value));
}

/* A number; beyond the largest double `inf` or `-inf`, and `nan` if there is none. */
static char *write_value(char *to, double value)
{
    if (isfinite(value))
        return to + proto_write_double(to, value);
    if (isinf(value) && value < 0)
        *to++ = '-';
    memcpy(to, isinf(value) ? "inf" : "nan", 3);
    return to + 3;
}

void reply_key_double(struct buf *out, const char *key, double value)
{
    append_key(out, key);
    char *to = buf_reserve(out, DOUBLE_ROOM);
    if (to != NULL)
        buf_commit(out, (size_t)(write_value(to, value) - to));
}

void reply_key_text(struct buf *out, const char *key, const char *value)
{
    append_key(out, key);
    buf_append_text(out, value);
}

void reply_key_doubles(struct buf *out, const char *key, const double *v, size_t n)
{
    append_key(out, key);
    char *const from = buf_reserve(out, n * DOUBLE_ROOM), *to = from;
    for (size_t i = 0; from != NULL && i < n; i++) {
        if (i > 0)
            *to++ = ',';
        to = write_value(to, v[i]);
    }
    if (from != NULL)
        buf_commit(out, (size_t)(to - from));
}

void reply_end(struct buf *out)
{
    buf_append_char(out, '\n');
}

/* A line of text for people, with control bytes replaced: it may quote what a client sent. */
__attribute__((format(printf, 2, 0))) static void append_line(struct buf *out, const char *format,
                                                              va_list ap)
{
    char text[REPLY_ERR_ROOM - 32];
    int n = vsnprintf(text, sizeof text, format, ap);
    size_t len = n < 0 ? 0 : (size_t)n < sizeof text ? (size_t)n : sizeof text - 1;
    for (size_t i = 0; i < len; i++)
        if (text[i] < ' ' || text[i] > '~')
            text[i] = '?';
    buf_append(out, text, len);
    buf_append_char(out, '\n');
}

void reply_err(struct buf *out, enum reply_code code, const char *format, va_list ap)
{
    buf_append(out, "ERR ", 4);
    buf_append_text(out, code_name[code]);
    buf_append_char(out, ' ');
    append_line(out, format, ap);
}

void reply_comment(struct buf *out, const char *format, ...)
{
    va_list ap;
    buf_append(out, "# ", 2);
    va_start(ap, format);
    append_line(out, format, ap);
    va_end(ap);
}

void reply_row_text(struct buf *out, const char *text)
{
    buf_append_text(out, text);
    buf_append_char(out, '\n');
}

void reply_row_ids(struct buf *out, const uint32_t *id, size_t n)
{
    char *const row = buf_reserve(out, n * ID_ROOM + 1);
    if (row == NULL)
        return;
    char *to = row;
    for (size_t i = 0; i < n; i++) {
        if (i > 0)
            *to++ = ' ';
        to += proto_write_u32(to, id[i]);
    }
    *to++ = '\n';
    buf_commit(out, (size_t)(to - row));
}

static char *write_point(char *to, uint32_t id, double x, double y)
{
    to += proto_write_u32(to, id);
    *to++ = ' ';
    to += proto_write_double(to, x);
    *to++ = ' ';
    return to + proto_write_double(to, y);
}

void reply_row_point(struct buf *out, uint32_t id, double x, double y)
{
    char *row = buf_reserve(out, ID_ROOM + 2 * DOUBLE_ROOM);
    if (row == NULL)
        return;
    char *to = write_point(row, id, x, y);
    *to++ = '\n';
    buf_commit(out, (size_t)(to - row));
}

void reply_row_value(struct buf *out, uint32_t id, double value)
{
    char *row = buf_reserve(out, ID_ROOM + DOUBLE_ROOM);
    if (row == NULL)
        return;
    char *to = row + proto_write_u32(row, id);
    *to++ = ' ';
    to = write_value(to, value);
    *to++ = '\n';
    buf_commit(out, (size_t)(to - row));
}

void reply_more_value(struct buf *out, double value)
{
    char *to = buf_reserve(out, DOUBLE_ROOM);
    if (to == NULL)
        return;
    to[-1] = ' '; /* in place of the LF */
    char *end = write_value(to, value);
    *end++ = '\n';
    buf_commit(out, (size_t)(end - to));
}

void reply_row_field(struct buf *out, const char *name, uint32_t values, double least, double most)
{
    size_t len = strlen(name);
    char *row = buf_reserve(out, len + 1 + ID_ROOM + 2 * DOUBLE_ROOM);
    if (row == NULL)
        return;
    memcpy(row, name, len);
    char *to = row + len;
    *to++ = ' ';
    to += proto_write_u32(to, values);
    *to++ = ' ';
    to = write_value(to, least);
    *to++ = ' ';
    to = write_value(to, most);
    *to++ = '\n';
    buf_commit(out, (size_t)(to - row));
}

void reply_row_polygon(struct buf *out, uint32_t id, uint32_t corners, const double *xy)
{
    char *const row = buf_reserve(out, 2 * ID_ROOM + (size_t)corners * 2 * DOUBLE_ROOM);
    if (row == NULL)
        return;
    char *to = row + proto_write_u32(row, id);
    *to++ = ' ';
    to += proto_write_u32(to, corners);
    for (size_t i = 0; i < 2 * (size_t)corners; i++) {
        *to++ = ' ';
        to += proto_write_double(to, xy[i]);
    }
    *to++ = '\n';
    buf_commit(out, (size_t)(to - row));
}

/* n doubles, not necessarily aligned, with a blank before each. */
static char *write_doubles(char *to, const void *numbers, size_t n)
{
    const char *from = numbers;
    for (size_t i = 0; i < n; i++) {
        double value;
        memcpy(&value, from + i * sizeof value, sizeof value);
        *to++ = ' ';
        to = write_value(to, value);
    }
    return to;
}

void reply_row_constraint(struct buf *out, uint32_t a, uint32_t b, bool border, uint32_t number)
{
    reply_u64(out, a);
    buf_append_char(out, ' ');
    reply_u64(out, b);
    buf_append_text(out, border ? " border " : " line ");
    reply_u64(out, number);
    reply_end(out);
}

void reply_row_region(struct buf *out, uint32_t number, bool closed, uint32_t triangles,
                      double area)
{
    reply_u64(out, number);
    buf_append_text(out, closed ? " closed " : " open ");
    reply_row_value(out, triangles, area);
}

void reply_row_numbers(struct buf *out, const void *numbers, size_t n)
{
    char *row = buf_reserve(out, n * DOUBLE_ROOM + 2);
    if (row == NULL)
        return;
    char *to = write_doubles(row, numbers, n);
    memmove(row, row + 1, (size_t)(to - row - 1)); /* no blank before the first one */
    to[-1] = '\n';
    buf_commit(out, (size_t)(to - row));
}

void reply_row_line(struct buf *out, double level, bool closed, const void *xy, size_t n)
{
    char *row = buf_reserve(out, (2 * n + 1) * DOUBLE_ROOM + 16 + ID_ROOM);
    if (row == NULL)
        return;
    char *to = row + proto_write_double(row, level);
    memcpy(to, closed ? " closed " : " open ", closed ? 8 : 6);
    to += closed ? 8 : 6;
    to += proto_write_u32(to, (uint32_t)n);
    to = write_doubles(to, xy, 2 * n);
    *to++ = '\n';
    buf_commit(out, (size_t)(to - row));
}

void reply_row_band(struct buf *out, const double level[2], uint32_t number, bool hole,
                    const void *xy, size_t n)
{
    char *row = buf_reserve(out, (2 * n + 2) * DOUBLE_ROOM + 16 + 2 * ID_ROOM);
    if (row == NULL)
        return;
    char *to = write_value(row, level[0]);
    *to++ = ' ';
    to = write_value(to, level[1]);
    *to++ = ' ';
    to += proto_write_u32(to, number);
    memcpy(to, hole ? " hole " : " outer ", hole ? 6 : 7);
    to += hole ? 6 : 7;
    to += proto_write_u32(to, (uint32_t)n);
    to = write_doubles(to, xy, 2 * n);
    *to++ = '\n';
    buf_commit(out, (size_t)(to - row));
}

void reply_row_neighbour(struct buf *out, uint32_t id, double x, double y, double distance)
{
    char *row = buf_reserve(out, ID_ROOM + 3 * DOUBLE_ROOM);
    if (row == NULL)
        return;
    char *to = write_point(row, id, x, y);
    *to++ = ' ';
    to += proto_write_double(to, distance);
    *to++ = '\n';
    buf_commit(out, (size_t)(to - row));
}

/* n words of `size` bytes, the least significant byte first. */
static void append_words(struct buf *out, const void *word, size_t n, size_t size)
{
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    buf_append(out, word, n * size);
#else
    const unsigned char *byte = word;
    for (size_t i = 0; i < n * size; i++) {
        char c = (char)byte[i / size * size + size - 1 - i % size];
        buf_append(out, &c, 1);
    }
#endif
}

void reply_word_u32(struct buf *out, uint32_t v)
{
    append_words(out, &v, 1, sizeof v);
}

void reply_words_u32(struct buf *out, const uint32_t *v, size_t n)
{
    append_words(out, v, n, sizeof *v);
}

void reply_word_double(struct buf *out, double v)
{
    append_words(out, &v, 1, sizeof v);
}

void reply_words_double(struct buf *out, const double *v, size_t n)
{
    append_words(out, v, n, sizeof *v);
}
