/* body.h - parses the points, values or pairs that follow LOAD, LOADB, FSETB and the like, incrementally.
 *
 *   BODY_DOT     lines `x y` up to a line that holds a single `.`
 *   BODY_LINES   exactly `count` lines; blank ones and comments count as lines, not as points
 *   BODY_BINARY  exactly `count` points of two little-endian doubles
 *
 * A line, or a point, may have values after its coordinates, or values instead of them (body_columns).
 *
 * Lines may be paths (body_paths): a line that starts with `>` begins the next one.
 *
 * Blank lines and lines that start with `#` are skipped. The first bad line determines the fault; the rest of the
 * body is then read and dropped, so that the next request is found. */
#pragma once

#include "proto/line.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum body_form { BODY_DOT, BODY_LINES, BODY_BINARY };

enum body_fault {
    BODY_GOOD,
    BODY_SYNTAX, /* not two words */
    BODY_ENDED,  /* the input ended within the body */
    BODY_LONGER, /* more input than announced */
    BODY_NUMBER, /* not a number */
    BODY_RANGE,  /* a coordinate that coordinates_ok refuses */
    BODY_VALUE,  /* a value that is infinite */
    BODY_TOOBIG, /* more than `limit` points */
    BODY_NOMEM
};

/* The allocator of the points: grow resizes the array p, NULL at first, to `bytes` and keeps the first `used`;
 * NULL: out of memory, p is unchanged. All zero: malloc. */
struct body_memory {
    void *(*grow)(void *ctx, void *p, size_t used, size_t bytes);
    void (*release)(void *p);
    void *ctx;
};

struct body {
    enum body_form form;
    uint64_t left; /* BODY_LINES: lines to come; BODY_BINARY: points to come */
    /* owns: x, y and the values of each point read so far; NULL once there is a fault */
    double *xy;
    size_t n, cap;             /* points */
    size_t coordinates, width; /* numbers of a point: coordinates, and all of them */
    bool paths;                /* the last number is a mark (body_paths) */
    bool begins;               /* the next point begins a path */
    bool words;                /* BODY_BINARY: a point is 8 bytes of any kind */
    size_t records_from;       /* from this point on they are bytes of any kind (body_records) */
    struct body_memory memory; /* the caller may set it after body_init */
    size_t limit;
    size_t part; /* BODY_BINARY: bytes of the next point that have come; behind the others in xy */
    uint64_t line; /* lines (points, when binary) read so far; the number of the last one, counted
                      from 1 */
    bool complete; /* the end of the body has been read */
    enum body_fault fault;
    uint64_t fault_line;
    enum line_fault line_fault; /* why body_feed returned -1 */
    bool (*coordinates_ok)(const double *v, size_t n);
};

/* Begins a body of at most `limit` points; coordinates_ok checks whether all of v[n] are valid coordinates. Allocates nothing. */
void body_init(struct body *b, enum body_form form, uint64_t count, size_t limit,
               bool (*coordinates_ok)(const double *v, size_t n));
void body_free(struct body *b);

/* To be called after body_init: a point has this number of coordinates (2 or 0), and values after them: finite numbers or
 * nan. */
void body_columns(struct body *b, size_t coordinates, size_t values);

/* The same for lines that are paths: each point has one more number, which is the number of its line; negative, if it begins a path. */
void body_paths(struct body *b);

/* The points of b are those of another body, in its middle. */
void body_columns_of(struct body *b, const struct body *other);

/* Numbers that a line has. */
static inline size_t body_numbers(const struct body *b)
{
    return b->width - b->paths;
}

/* The same for a binary body whose points are 8 bytes of any kind, which take the place of a number. */
void body_words(struct body *b);

/* The same for a binary body of which only the first `points` are points; those behind them are records of any kind, as long as a point. */
void body_records(struct body *b, size_t points);

/* Parses bytes[n]; returns the number of bytes consumed (0: it needs more), or -1 if the framing is broken (a NUL
 * byte, a line that is too long). `last`: there will be no more bytes. Check b->complete after each call. Cost:
 * linear in n. bytes may be NULL if n is 0. */
ptrdiff_t body_feed(struct body *b, const char *bytes, size_t n, bool last);

/* Returns the place of the next bytes of a binary body, for a caller that can have them written to it: *n of them at most. NULL:
 * they have to be fed, because few points have come yet, the body has a fault, or there is no memory for more. */
char *body_room(struct body *b, size_t *n);

/* The first n of these bytes are there, and are parsed. Check b->complete after each call. */
void body_wrote(struct body *b, size_t n);

/* Counts whole lines at the beginning of bytes[n], at most `most` of them, and not the one that ends a BODY_DOT: *lines. Returns their
 * bytes. *ended: the body may end with the next line. */
size_t body_scan(const struct body *b, const char *bytes, size_t n, uint64_t most, uint64_t *lines,
                 bool *ended);

/* Appends the points of a complete BODY_LINES that has read the next lines of b, which has more. False, and nothing has happened: one
 * of the two has a fault, or b would; then the lines have to be fed. */
bool body_join(struct body *b, const struct body *lines);

/* Sets the fault of the body (for instance BODY_NOMEM), unless it has one, and frees the points. */
void body_fail(struct body *b, enum body_fault fault);
