/* resp.h - the second framing: requests and replies as Redis clients write and read them (RESP).
 *
 * A request is an array of bulk strings; each string is one word, whatever bytes it holds:
 *
 *     *3\r\n$7\r\nNEAREST\r\n...        the words of `NEAREST set x y`
 *
 * The commands know nothing of this framing. They answer in lines, and resp_reframe turns those
 * lines into RESP as they are sent. The serialization is told at
 * redis.io/docs/reference/protocol-spec. */
#ifndef PROTO_RESP_H
#define PROTO_RESP_H

#include "proto/buf.h"
#include "proto/reply_read.h"
#include "proto/request.h"

enum {
    RESP_LIMIT = 128 * 1024,  /* bytes of a request, its headers included, its body not */
    RESP_BODY_LIMIT = 1 << 30 /* bytes of a body */
};

enum resp_fault { RESP_WHOLE, RESP_BROKEN, RESP_TOO_LONG, RESP_NOMEM };

struct resp {
    size_t need;   /* with 0 returned: it is no use to try again with fewer bytes than this */
    bool has_body; /* a LOAD or LOADB of four words: the fourth has not been read yet; */
    size_t body;   /* it holds so many bytes, and \r\n follows them */
    enum resp_fault fault; /* with -1 returned */
};

/* Reads the request at the front of bytes[n], whose first byte is '*'. Returns how many bytes it
 * took (words of q borrow them; q->n is 0 for an empty array, which is no request), 0 if it has not
 * arrived whole, -1 if it is no such array or too long. Cost: linear in the request; however small
 * the pieces are in which it arrives, if `need` is heeded it is looked at O(log n) times for every
 * byte-wise cut header. */
ptrdiff_t resp_read(const char *bytes, size_t n, struct request *q, struct resp *out);

const char *resp_fault_text(enum resp_fault fault);

/* Turns bytes[n] of line replies into RESP replies appended to out: `OK 0 keys` into the simple
 * string `OK keys`, rows into an array of bulk strings, raw bytes into a bulk string, `ERR CODE
 * text` into the error `CODE text`; comments are left out. The bytes end with a line or within raw
 * bytes; r keeps the place from call to call. False if they are no reply (an error of ours). */
bool resp_reframe(struct reply_reader *r, const char *bytes, size_t n, struct buf *out);

/* Pieces of replies. */
void resp_bulk(struct buf *out, const char *text, size_t len);
void resp_array(struct buf *out, size_t n);

#endif
