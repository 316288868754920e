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

static char *write_values(char *to, const double *v, size_t n, char between)
{
    for (size_t i = 0; i < n; i++) {
        if (i > 0)
            *to++ = between;
        to = write_value(to, v[i]);
    }
    return to;
}

static char *write_ids(char *to, const uint32_t *id, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (i > 0)
            *to++ = ' ';
        to += proto_write_u32(to, id[i]);
    }
    return to;
}

/* Ends the row, which has been written to where there was room. */
static void commit_row(struct buf *out, const char *row, char *to)
{
    *to++ = '\n';
    buf_commit(out, (size_t)(to - row));
}

void reply_key_text(struct buf *out, const char *key, const char *value)
{
    append_key(out, key);
    buf_append_text(out, value);
}

void reply_key_double(struct buf *out, const char *key, double value)
{
    reply_key_doubles(out, key, &value, 1);
}

void reply_key_doubles(struct buf *out, const char *key, const double *v, size_t n)
{
    append_key(out, key);
    char *row = buf_reserve(out, n * DOUBLE_ROOM);
    if (row != NULL)
        buf_commit(out, (size_t)(write_values(row, v, n, ',') - row));
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
    char *row = buf_reserve(out, n * ID_ROOM + 1);
    if (row != NULL)
        commit_row(out, row, write_ids(row, id, n));
}

void reply_row_values(struct buf *out, uint32_t id, const double *v, size_t n)
{
    char *row = buf_reserve(out, ID_ROOM + n * DOUBLE_ROOM + 1), *to = row;
    if (row == NULL)
        return;
    to += proto_write_u32(to, id);
    *to++ = ' ';
    commit_row(out, row, write_values(to, v, n, ' '));
}

void reply_more_value(struct buf *out, double value)
{
    char *row = buf_reserve(out, DOUBLE_ROOM);
    if (row == NULL)
        return;
    row[-1] = ' '; /* in place of the LF */
    commit_row(out, row, write_value(row, value));
}

void reply_row_field(struct buf *out, const char *name, uint32_t values, double least, double most)
{
    buf_append_text(out, name);
    buf_append_char(out, ' ');
    reply_row_values(out, values, (const double[]){least, most}, 2);
}

void reply_row_polygon(struct buf *out, uint32_t id, uint32_t corners, const double *xy)
{
    size_t n = 2 * (size_t)corners;
    char *row = buf_reserve(out, 2 * ID_ROOM + n * DOUBLE_ROOM), *to = row;
    if (row == NULL)
        return;
    to = write_ids(to, (const uint32_t[]){id, corners}, 2);
    if (n > 0)
        *to++ = ' ';
    commit_row(out, row, write_values(to, xy, n, ' '));
}

void reply_row_numbers(struct buf *out, const double *v, size_t n)
{
    char *row = buf_reserve(out, n * DOUBLE_ROOM + 1);
    if (row != NULL && n > 0)
        commit_row(out, row, write_values(row, v, n, ' '));
}

/* ---- rows of words ---- */

static size_t words_of(char column, const uint32_t *word)
{
    size_t each = column == 'I' ? 1 : column == 'D' ? 4 : 0;
    return column == 'd' ? 2 : each == 0 ? 1 : 1 + each * *word;
}

size_t reply_row_words(const char *format, const uint32_t *word)
{
    size_t n = 0;
    for (; *format != '\0'; format++)
        n += words_of(*format, word + n);
    return n;
}

size_t reply_row_room(const char *format, const uint32_t *word)
{
    size_t each = strchr(format, 'I') != NULL ? ID_ROOM : DOUBLE_ROOM / 2 + 1;
    return reply_row_words(format, word) * each + strlen(format) * DOUBLE_ROOM;
}

static char *write_column(char *to, char column, const uint32_t *word, size_t words)
{
    static const char *const text[] = {"line ", "border ", "open", "closed", "outer", "hole"};
    const size_t ids = column == 'd' ? 0 : column == 'I' ? words : 1;
    if (column == 'b' || column == 'c' || column == 'h') {
        const char *name = text[(column == 'b' ? 0 : column == 'c' ? 2 : 4) + (*word & 1)];
        memcpy(to, name, strlen(name));
        to += strlen(name);
        return column == 'b' ? to + proto_write_u32(to, *word >> 1) : to;
    }
    to = write_ids(to, word, ids);
    for (size_t i = ids; i < words; i += 2) {
        double v;
        memcpy(&v, word + i, sizeof v);
        if (i > 0)
            *to++ = ' ';
        to = write_value(to, v);
    }
    return to;
}

void reply_row(struct buf *out, const char *format, const uint32_t *word)
{
    char *const row = buf_reserve(out, reply_row_room(format, word)), *to = row;
    for (size_t n; row != NULL && *format != '\0'; format++, word += n) {
        n = words_of(*format, word);
        to = write_column(to, *format, word, n);
        *to++ = format[1] != '\0' ? ' ' : '\n';
    }
    if (row != NULL)
        buf_commit(out, (size_t)(to - row));
}

void reply_word_u32(struct buf *out, uint32_t v)
{
    buf_append(out, &v, sizeof v);
}

void reply_words_u32(struct buf *out, const uint32_t *v, size_t n)
{
    buf_append(out, v, n * sizeof *v);
}

void reply_word_double(struct buf *out, double v)
{
    buf_append(out, &v, sizeof v);
}

void reply_words_double(struct buf *out, const double *v, size_t n)
{
    buf_append(out, v, n * sizeof *v);
}
