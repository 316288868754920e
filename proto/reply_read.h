/* reply_read.h - parses the server's replies, incrementally: the client's side of the framing.
 *
 *     struct reply_reader r = {0};
 *     while ((used = reply_read(&r, bytes, n, &part)) > 0)
 *         ... part is a status line, a row, raw bytes or a comment; drop `used` bytes ...
 *
 * It needs no knowledge of commands: the status line says what follows. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { REPLY_STATUS_LIMIT = 65536 }; /* bytes of a status line or comment; rows have no limit */

enum reply_part_kind {
    REPLY_OK,     /* the status line of a request that was carried out */
    REPLY_ERR,    /* the status line of one that was refused */
    REPLY_ROW,    /* one of the lines announced */
    REPLY_BYTES,  /* some of the raw bytes announced */
    REPLY_EVENT,  /* the first line of an event, between replies (WATCH); its lines follow */
    REPLY_COMMENT /* a line that starts with '#', before a status line */
};

struct reply_part {
    enum reply_part_kind kind;
    const char *text; /* borrows the input; a line comes without its LF or CRLF */
    size_t len;
    bool last; /* the reply ends here; what follows belongs to the next one */
};

/* All zero: between two replies. */
struct reply_reader {
    uint64_t rows_left, bytes_left; /* of the current reply */
    size_t scanned;                 /* bytes at the front without an end of line */
    bool events;                    /* the connection may have events between replies (WATCH) */
    const char *fault;              /* why reply_read returned -1: a static sentence */
};

/* Reads the next part from bytes[n]. Returns the number of bytes consumed. Returns 0 if it needs more: call it again with
 * the same bytes and more after them. Returns -1 if this is not a reply of the protocol: the reason is in r->fault, and the
 * connection is unusable. Cost: linear in the bytes, for pieces of any size. */
ptrdiff_t reply_read(struct reply_reader *r, const char *bytes, size_t n, struct reply_part *part);

/* Whether the reader is between two replies, so that the end of the connection loses nothing. */
bool reply_reader_idle(const struct reply_reader *r);

/* The value of ` key=value` in a status line; false if it has none. *value borrows the line. */
bool reply_key(const struct reply_part *status, const char *key, const char **value, size_t *len);

/* The same for a whole number; false also if the value is not one. */
bool reply_key_number(const struct reply_part *status, const char *key, uint64_t *value);

/* The number of rows in an OK line. */
uint64_t reply_rows(const struct reply_part *status);
