/* body.h - reads the points that follow LOAD and LOADB, in whatever pieces they arrive.
 *
 *   BODY_DOT     lines `x y` up to a line that holds a single `.`
 *   BODY_LINES   exactly `count` lines; blank ones and comments count as lines, not as points
 *   BODY_BINARY  exactly `count` points of two little-endian doubles
 *
 * A blank line or one that starts with `#` is no point. The first bad line decides the fault; from
 * there on the body is read to its end and dropped, so that the request after it is found. */
#ifndef PROTO_BODY_H
#define PROTO_BODY_H

#include "proto/line.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum body_form { BODY_DOT, BODY_LINES, BODY_BINARY };

enum body_fault {
    BODY_GOOD,
    BODY_SYNTAX, /* not two words */
    BODY_ENDED,  /* the input ended within the body */
    BODY_LONGER, /* more came than was announced */
    BODY_NUMBER, /* not a number */
    BODY_RANGE,  /* a coordinate that the caller's rule refuses */
    BODY_TOOBIG, /* more than `limit` points */
    BODY_NOMEM
};

/* Where the points are kept: grow makes room for `bytes` in the array p, NULL at first, and keeps what
 * is in the first `used`; NULL: there is none, p is as it was. All zero: malloc's. */
struct body_memory {
    void *(*grow)(void *ctx, void *p, size_t used, size_t bytes);
    void (*release)(void *p);
    void *ctx;
};

struct body {
    enum body_form form;
    uint64_t left; /* BODY_LINES: lines to come; BODY_BINARY: points to come */
    double *xy;    /* owns: x, y of each point read so far; NULL once there is a fault */
    size_t n, cap; /* points */
    struct body_memory memory; /* the caller may set it after body_init */
    size_t limit;
    uint64_t line; /* lines (points, when binary) read so far; the number of the last one, counted
                      from 1 */
    bool complete; /* the end of the body has been read */
    enum body_fault fault;
    uint64_t fault_line;
    enum line_fault line_fault; /* why body_feed returned -1 */
    bool (*coordinate_ok)(double v);
};

/* Starts a body of at most `limit` points; coordinate_ok decides about every coordinate. Allocates
 * nothing. */
void body_init(struct body *b, enum body_form form, uint64_t count, size_t limit,
               bool (*coordinate_ok)(double v));
void body_free(struct body *b);

/* Reads from bytes[n]; returns how many bytes it took (0: it needs more), or -1 if the framing is
 * broken (a NUL, an endless line). With `last` no more bytes will come. Check b->complete after
 * each call. Cost: linear in n. */
ptrdiff_t body_feed(struct body *b, const char *bytes, size_t n, bool last);

/* Gives the body a fault from outside (for instance BODY_NOMEM); the first fault stays. Frees the
 * points. */
void body_fail(struct body *b, enum body_fault fault);

#endif
