/* resp.h - the second framing: requests and replies in the protocol of Redis (RESP).
 *
 * A request is an array of bulk strings; each string is one word, with any bytes:
 *
 *     *3\r\n$7\r\nNEAREST\r\n...        the words of `NEAREST set x y`
 *
 * Commands do not know this framing. They answer in lines, which resp_reframe converts to RESP. Specification:
 * redis.io/docs/reference/protocol-spec. */
#pragma once

#include "proto/buf.h"
#include "proto/reply_read.h"
#include "proto/request.h"

enum {
    RESP_LIMIT = 128 * 1024,  /* bytes of a request, with its headers, without its body */
    RESP_BODY_LIMIT = 1 << 30 /* bytes of a body */
};

enum resp_fault { RESP_WHOLE, RESP_BROKEN, RESP_TOO_LONG, RESP_NOMEM };

struct resp {
    size_t need; /* if 0 is returned: with fewer bytes than this it would return 0 again */
    /* the last word is a body (resp.c says of which requests) and has not been read yet: */
    bool has_body;
    size_t body; /* its bytes, followed by \r\n; of 5, all are needed to tell it from PATHS */
    enum resp_fault fault; /* if -1 is returned */
};

/* Parses the request at the front of bytes[n], whose first byte is '*'. Returns the number of bytes consumed; the words of q
 * borrow them, and q->n is 0 for an empty array, which is no request. Returns 0 if it is incomplete, -1 if it is not such an
 * array or too long. Cost: linear in the request; if it arrives in small pieces, callers should wait for `need` bytes. */
ptrdiff_t resp_read(const char *bytes, size_t n, struct request *q, struct resp *out);

const char *resp_fault_text(enum resp_fault fault);

/* Converts bytes[n] of line replies to RESP, appended to out. `OK 0 keys` becomes the simple string `OK keys`, rows an
 * array of bulk strings, raw bytes a bulk string, `ERR CODE text` the error `CODE text`; comments are left out.
 * The bytes end with a line or within raw bytes; r has the position between calls. False: not a reply, which would
 * be a bug. */
bool resp_reframe(struct reply_reader *r, const char *bytes, size_t n, struct buf *out);

/* The same for one part of a reply, which r has just read. */
void resp_part(struct buf *out, const struct reply_reader *r, const struct reply_part *part);

/* Pieces of replies. */
void resp_bulk(struct buf *out, const char *text, size_t len);
void resp_array(struct buf *out, size_t n);
