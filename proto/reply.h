/* reply.h - writes replies: one status line, then rows.
 *
 * These functions do not report errors: when memory runs out, the buffer's `failed` is set (buf.h), and the owner of
 * the reply replaces it. */
#ifndef PROTO_REPLY_H
#define PROTO_REPLY_H

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
void reply_row_point(struct buf *out, uint32_t id, double x, double y);
/* nan is written as `nan`. */
void reply_row_value(struct buf *out, uint32_t id, double value);
/* Appends a number to the row that was written last. */
void reply_more_value(struct buf *out, double value);
void reply_row_field(struct buf *out, const char *name, uint32_t values, double least, double most);
void reply_row_polygon(struct buf *out, uint32_t id, uint32_t corners, const double *xy);
void reply_row_constraint(struct buf *out, uint32_t a, uint32_t b, bool border, uint32_t number);
/* number closed|open triangles area */
void reply_row_region(struct buf *out, uint32_t number, bool closed, uint32_t triangles,
                      double area);
/* n doubles, in memory wherever they are; nan is written as `nan`. */
void reply_row_numbers(struct buf *out, const void *numbers, size_t n);
/* level closed|open n x y ...: of 2 n doubles. */
void reply_row_line(struct buf *out, double level, bool closed, const void *xy, size_t n);
/* low high number outer|hole n x y ...: the same; a level may be infinite. */
void reply_row_band(struct buf *out, const double level[2], uint32_t number, bool hole,
                    const void *xy, size_t n);
void reply_row_neighbour(struct buf *out, uint32_t id, double x, double y, double distance);

/* Little-endian words of a binary reply. */
void reply_word_u32(struct buf *out, uint32_t v);
void reply_words_u32(struct buf *out, const uint32_t *v, size_t n);
void reply_word_double(struct buf *out, double v);
void reply_words_double(struct buf *out, const double *v, size_t n);

#endif
