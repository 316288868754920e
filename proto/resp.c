/* resp.c - see resp.h.
 *
 * The reader keeps no position within an incomplete request, since the bytes may move; it
 * starts again and reports how many bytes are needed before a new attempt is useful. */
#include "proto/resp.h"

#include "proto/number.h"

#include <stdint.h>
#include <string.h>

enum {
    DIGITS_LIMIT = 10,
    LEAST_WORD = 4, /* bytes read of the shortest word: the header, if it is a body */
    WORDS_LIMIT = RESP_LIMIT / LEAST_WORD
};

/* Reads `<mark><digits>\r\n`; its number goes to *v, -1 for -1. Returns its length, 0 if more bytes
 * are needed, -1 if it is something else. */
static ptrdiff_t read_header(const char *bytes, size_t n, char mark, long long *v)
{
    if (n >= 4 && bytes[0] == mark && bytes[2] == '\r' && bytes[3] == '\n' && bytes[1] >= '0' &&
        bytes[1] <= '9') { /* the common case */
        *v = bytes[1] - '0';
        return 4;
    }
    size_t at = 1, digits = 0;
    bool negative = n > 1 && bytes[1] == '-';
    *v = 0;
    if (n > 0 && bytes[0] != mark)
        return -1;
    for (at += negative; at < n && bytes[at] >= '0' && bytes[at] <= '9' && digits <= DIGITS_LIMIT;
         at++, digits++)
        *v = 10 * *v + (bytes[at] - '0');
    if (digits > DIGITS_LIMIT)
        return -1;
    if (at >= n)
        return 0;
    if (digits == 0 || bytes[at] != '\r' || (negative && *v != 1))
        return -1;
    if (at + 1 == n)
        return 0;
    if (negative)
        *v = -1;
    return bytes[at + 1] == '\n' ? (ptrdiff_t)at + 2 : -1;
}

static ptrdiff_t bad(struct resp *out, enum resp_fault fault)
{
    out->fault = fault;
    return -1;
}

/* More bytes are needed: at least `need` altogether. */
static ptrdiff_t wait_for(struct resp *out, size_t need)
{
    if (need > RESP_LIMIT)
        return bad(out, RESP_TOO_LONG);
    out->need = need;
    return 0;
}

enum { DIGITS = 10 }; /* of a number in a request, at most; a place has 16 bytes */

/* INTERPOLATEB or GRADIENTB, set field n, options, and then the body, unless the last word is a part of an option. */
static bool ends_with_places(const struct word *word, size_t words, long long len)
{
    enum { INSIDE = sizeof "INSIDE" - 1 };
    size_t i = 4, last = words - 1;
    bool number = false; /* the last word may be the number of INSIDE k */
    while (i < last) {
        bool inside = word_is(&word[i], "INSIDE");
        number = inside && i + 1 == last;
        i += inside && (number || word[i + 1].text[0] < '0' || word[i + 1].text[0] > '9') ? 1 : 2;
    }
    return i == last && len != INSIDE && !(number && len > 0 && len <= DIGITS);
}

/* LOADB set n, CONSTRAINTS m [SPLIT], FIELDS a,b, and then the body, unless the last word is SPLIT. */
static bool ends_with_records(const struct word *word, size_t words, long long len)
{
    enum { SPLIT = sizeof "SPLIT" - 1 };
    size_t i = 5, last = words - 1;
    if (i == last && len == SPLIT)
        return false;
    i += i < last && word_is(&word[i], "SPLIT");
    i += i < last && word_is(&word[i], "FIELDS") ? 2 : 0;
    return i == last;
}

/* Whether a request of `words` words, of which all but the last are at `word`, ends with a body of `len` bytes. */
static bool ends_with_body(const struct word *word, size_t words, long long len)
{
    if (words < 4)
        return false;
    if (word_is(word, "INTERPOLATEB") || word_is(word, "GRADIENTB"))
        return ends_with_places(word, words, len);
    if (word_is(word, "LOAD") &&
        (word_is(&word[2], "PATHS") || (words > 4 && word_is(&word[3], "PATHS"))))
        return false; /* lines follow */
    if (word_is(word, "LOADB") && words > 4 && word_is(&word[3], "CONSTRAINTS"))
        return ends_with_records(word, words, len);
    if (words > 6)
        return false;
    if (words == 6)
        return word_is(word, "LOAD") || word_is(word, "LOADB") || word_is(word, "FSETB");
    if (word_is(word, "NEARESTB")) /* NEARESTB set n k: places follow */
        return words == 5 || len == 0 || len > DIGITS;
    if (words == 5)
        return false;
    if (word_is(word, "LOAD"))
        return !word_is(&word[2], "FIELDS"); /* LOAD set FIELDS z: lines follow */
    return word_is(word, "LOADB") || word_is(word, "LOCATEB");
}

/* Whether the last one of the words, which comes next and has `len` bytes, is a body. */
static bool has_body(const struct request *q, size_t words, long long len)
{
    size_t prefix = 0;
    if (q->n == 0 || q->n + 1 != words)
        return false;
    while (prefix + 2 < q->n && word_is(&q->word[prefix], "TIMEOUT"))
        prefix += 2;
    return ends_with_body(q->word + prefix, words - prefix, len);
}

enum { PATHS = sizeof "PATHS" - 1 };

/* Whether the last word, which has_body says is a body, may be that of LOAD set n PATHS, where lines follow. */
static bool may_be_paths(const struct request *q, long long len)
{
    return len == PATHS && word_is(&q->word[q->n - 3], "LOAD");
}

/* Reads the word at bytes[*at], of which `after` more follow, and moves *at behind it. Returns 1, 0
 * or -1. */
static ptrdiff_t read_word(const char *bytes, size_t n, size_t *at, size_t after, struct request *q,
                           struct resp *out)
{
    long long len;
    ptrdiff_t took = read_header(bytes + *at, n - *at, '$', &len);
    if (took < 0 || (took > 0 && len < 0))
        return bad(out, RESP_BROKEN);
    if (took == 0) {
        size_t header = n + 1 > *at + LEAST_WORD ? n + 1 : *at + LEAST_WORD;
        return wait_for(out, header + after * LEAST_WORD);
    }
    *at += (size_t)took;
    bool body = has_body(q, q->n + 1 + after, len);
    if (body && may_be_paths(q, len)) {
        const struct word word = {bytes + *at, PATHS};
        if (n - *at < PATHS)
            return wait_for(out, *at + PATHS);
        body = !word_is(&word, "PATHS");
    }
    if (body) {
        out->has_body = true;
        out->body = (size_t)len;
        return len <= RESP_BODY_LIMIT ? 1 : bad(out, RESP_TOO_LONG);
    }
    if (len > RESP_LIMIT)
        return bad(out, RESP_TOO_LONG);
    size_t end = *at + (size_t)len;
    if (n < end + 2)
        return wait_for(out, end + 2 + after * LEAST_WORD);
    if (memcmp(bytes + end, "\r\n", 2) != 0)
        return bad(out, RESP_BROKEN);
    if (!request_add(q, bytes + *at, (size_t)len))
        return bad(out, RESP_NOMEM);
    *at = end + 2;
    return 1;
}

ptrdiff_t resp_read(const char *bytes, size_t n, struct request *q, struct resp *out)
{
    long long words;
    *out = (struct resp){0};
    q->n = 0;
    ptrdiff_t took = read_header(bytes, n, '*', &words);
    if (took < 0)
        return bad(out, RESP_BROKEN);
    if (took == 0)
        return wait_for(out, n + 1);
    if (words > WORDS_LIMIT)
        return bad(out, RESP_TOO_LONG);
    size_t at = (size_t)took;
    for (long long left = words; left > 0; left--) {
        ptrdiff_t read = read_word(bytes, n, &at, (size_t)left - 1, q, out);
        if (read <= 0)
            return read;
    }
    return at <= RESP_LIMIT ? (ptrdiff_t)at : bad(out, RESP_TOO_LONG);
}

const char *resp_fault_text(enum resp_fault fault)
{
    static const char *const text[] = {
        "a request",
        "not an array of bulk strings",
        "a request has at most 131072 bytes; LOAD and LOADB take many points",
        "out of memory; nothing has changed",
    };
    return text[fault];
}

/* ---- replies ---- */

enum { HEADER_ROOM = 23 }; /* the mark, a number, CR LF */

/* `<mark><n>\r\n`; returns its length. */
static size_t write_header(char *to, char mark, uint64_t n)
{
    to[0] = mark;
    size_t digits = proto_write_u64(to + 1, n);
    memcpy(to + digits + 1, "\r\n", 2);
    return digits + 3;
}

static void header(struct buf *out, char mark, uint64_t n)
{
    char *to = buf_reserve(out, HEADER_ROOM);
    if (to != NULL)
        buf_commit(out, write_header(to, mark, n));
}

void resp_array(struct buf *out, size_t n)
{
    header(out, '*', n);
}

void resp_bulk(struct buf *out, const char *text, size_t len)
{
    char *to = buf_reserve(out, HEADER_ROOM + len + 2);
    if (to == NULL)
        return;
    size_t at = write_header(to, '$', len);
    if (len > 0) /* there may be no text */
        memcpy(to + at, text, len);
    memcpy(to + at + len, "\r\n", 2);
    buf_commit(out, at + len + 2);
}

/* `OK n keys`: the array's or the bulk string's header, or the whole simple string. */
static void reframe_status(struct buf *out, const struct reply_reader *r,
                           const struct reply_part *part)
{
    if (r->bytes_left > 0) {
        header(out, '$', r->bytes_left);
    } else if (r->rows_left > 0) {
        header(out, '*', r->rows_left);
    } else if (reply_key(part, "bytes", &(const char *){0}, &(size_t){0})) {
        header(out, '$', 0);
        buf_append(out, "\r\n", 2);
    } else {
        buf_append(out, "+OK", 3);
        buf_append(out, part->text + 4, part->len - 4); /* "OK 0" is cut off */
        buf_append(out, "\r\n", 2);
    }
}

void resp_part(struct buf *out, const struct reply_reader *r, const struct reply_part *part)
{
    switch (part->kind) {
    case REPLY_OK:
        reframe_status(out, r, part);
        break;
    case REPLY_ERR:
        buf_append_char(out, '-');
        buf_append(out, part->text + 4, part->len - 4); /* "ERR " is cut off */
        buf_append(out, "\r\n", 2);
        break;
    case REPLY_ROW:
        resp_bulk(out, part->text, part->len);
        break;
    case REPLY_BYTES:
        buf_append(out, part->text, part->len);
        if (part->last)
            buf_append(out, "\r\n", 2);
        break;
    case REPLY_EVENT: /* see server/replies/resp3.h */
    case REPLY_COMMENT:
        break;
    }
}

bool resp_reframe(struct reply_reader *r, const char *bytes, size_t n, struct buf *out)
{
    struct reply_part part;
    while (n > 0) {
        ptrdiff_t took = reply_read(r, bytes, n, &part);
        if (took <= 0)
            return false;
        resp_part(out, r, &part);
        bytes += took;
        n -= (size_t)took;
    }
    return true;
}
