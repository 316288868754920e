/* reply.h - writes replies: one status line, then rows.
 *
 * These functions do not report errors: when memory runs out, the buffer's `failed` is set (buf.h), and the owner of
 * the reply replaces it. */
#pragma once

#include "proto/buf.h"

#include <stdarg.h>
#include <stdint.h>

/* The codes of ERR lines, in the order of PROTOCOL.md. */
enum reply_code {
    ERR_SYNTAX,
    ERR_UNKNOWN,
    ERR_NUMBER,
    ERR_RANGE,
    ERR_NOSET,
    ERR_EXISTS,
    ERR_NOPOINT,
    ERR_NOEDGE,
    ERR_NOTRIANGLE,
    ERR_NOFIELD,
    ERR_NOCONSTRAINT,
    ERR_CROSSES,
    ERR_CONSTRAINED,
    ERR_NOTDELAUNAY,
    ERR_NOREGION,
    ERR_OPEN,
    ERR_UNTRIANGULATED,
    ERR_TOOLONG,
    ERR_TOOBIG,
    ERR_BUSY,
    ERR_NOMEM,
    ERR_READONLY,
    ERR_NOFOLLOWERS,
    ERR_NOAUTH,
    ERR_DENIED,
    ERR_TIMEOUT,
    ERR_CANCELLED,
    ERR_LOADING,
    ERR_IO,
    ERR_CORRUPT
};

enum { REPLY_ERR_ROOM = 320 }; /* an ERR line is never longer than this */

const char *reply_code_name(enum reply_code code);

/* The status line: reply_ok begins it with the number of rows, keys extend it, reply_end ends it. */
void reply_ok(struct buf *out, uint64_t rows);
void reply_key_u64(struct buf *out, const char *key, uint64_t value);
void reply_key_double(struct buf *out, const char *key, double value); /* may be nan */
void reply_key_doubles(struct buf *out, const char *key, const double *v,
                       size_t n); /* with commas */
void reply_key_text(struct buf *out, const char *key, const char *value);
void reply_end(struct buf *out);

/* A number without a key. */
void reply_u64(struct buf *out, uint64_t value);

/* A whole ERR line. Characters that are not printable become '?', and a long text is cut. */
__attribute__((format(printf, 3, 0))) void reply_err(struct buf *out, enum reply_code code,
                                                     const char *format, va_list ap);

/* A comment line, `# text`. */
__attribute__((format(printf, 2, 3))) void reply_comment(struct buf *out, const char *format, ...);

/* Rows. */
void reply_row_text(struct buf *out, const char *text);
void reply_row_ids(struct buf *out, const uint32_t *id, size_t n);
/* An id and n numbers; nan is written as `nan`. */
void reply_row_values(struct buf *out, uint32_t id, const double *v, size_t n);
/* Appends a number to the row that was written last. */
void reply_more_value(struct buf *out, double value);
void reply_row_field(struct buf *out, const char *name, uint32_t values, double least, double most);
void reply_row_polygon(struct buf *out, uint32_t id, uint32_t corners, const double *xy);
/* n doubles; nan is written as `nan`. */
void reply_row_numbers(struct buf *out, const double *v, size_t n);

/* A row of columns that are words in memory; each letter of the format is a column:
 *
 *     i  an id or a count
 *     d  a double, of two words
 *     c  `open` or `closed`, h `outer` or `hole`: 0 or 1
 *     b  `line` or `border`, and a number: twice the number, plus 1 for a border
 *     I  k, and k ids: 1 + k words; only the last column, as is
 *     D  k, and k places, which are two doubles each: 1 + 4 k words */
void reply_row(struct buf *out, const char *format, const uint32_t *word);
/* The words of the row, and the bytes of its text, at most. */
size_t reply_row_words(const char *format, const uint32_t *word);
size_t reply_row_room(const char *format, const uint32_t *word);

/* Little-endian words of a binary reply. */
void reply_word_u32(struct buf *out, uint32_t v);
void reply_words_u32(struct buf *out, const uint32_t *v, size_t n);
void reply_word_double(struct buf *out, double v);
void reply_words_double(struct buf *out, const double *v, size_t n);
