/* reply_read.c - the framing of replies: a status line, then the number of lines or bytes that it states. */
#include "proto/reply_read.h"

#include "proto/number.h"

#include <string.h>

static ptrdiff_t bad(struct reply_reader *r, const char *fault)
{
    r->fault = fault;
    return -1;
}

static bool starts_with(const char *s, size_t len, const char *prefix)
{
    size_t n = strlen(prefix);
    return len >= n && memcmp(s, prefix, n) == 0;
}

static bool is_event(const char *s, size_t len)
{
    return starts_with(s, len, "EVENT ");
}

/* The number after "OK " or "EVENT ". */
static bool read_row_count(const char *s, size_t len, uint64_t *rows)
{
    size_t word = is_event(s, len) ? 6 : 3;
    if (word == 3 && !starts_with(s, len, "OK "))
        return false;
    const char *space = memchr(s + word, ' ', len - word);
    return proto_read_u64(s + word, (space != NULL ? (size_t)(space - s) : len) - word, rows);
}

/* "ERR CODE text"; the text may be missing. */
static bool is_error(const char *s, size_t len)
{
    return starts_with(s, len, "ERR ") && len > 4 && s[4] >= 'A' && s[4] <= 'Z';
}

static bool read_status(struct reply_reader *r, struct reply_part *part)
{
    if (is_error(part->text, part->len)) {
        part->kind = REPLY_ERR;
        part->last = true;
        return true;
    }
    uint64_t rows, bytes = 0;
    const char *value;
    size_t len;
    part->kind = is_event(part->text, part->len) ? REPLY_EVENT : REPLY_OK;
    if ((part->kind == REPLY_EVENT && !r->events) || !read_row_count(part->text, part->len, &rows))
        return false;
    if (rows == 0 && reply_key(part, "bytes", &value, &len) && !proto_read_u64(value, len, &bytes))
        return false;
    r->rows_left = rows;
    r->bytes_left = bytes;
    part->last = rows == 0 && bytes == 0;
    return true;
}

static ptrdiff_t read_bytes(struct reply_reader *r, const char *bytes, size_t n,
                            struct reply_part *part)
{
    size_t take = n < r->bytes_left ? n : (size_t)r->bytes_left;
    r->bytes_left -= take;
    *part = (struct reply_part){REPLY_BYTES, bytes, take, r->bytes_left == 0};
    return (ptrdiff_t)take;
}

ptrdiff_t reply_read(struct reply_reader *r, const char *bytes, size_t n, struct reply_part *part)
{
    if (r->fault != NULL)
        return -1;
    if (r->bytes_left > 0)
        return read_bytes(r, bytes, n, part);
    const char *lf = n > r->scanned ? memchr(bytes + r->scanned, '\n', n - r->scanned) : NULL;
    size_t len = lf != NULL ? (size_t)(lf - bytes) : n;
    if (r->rows_left == 0 && len > REPLY_STATUS_LIMIT)
        return bad(r, "a status line without end");
    if (lf == NULL) {
        r->scanned = n;
        return 0;
    }
    r->scanned = 0;
    *part = (struct reply_part){REPLY_ROW, bytes, len - (len > 0 && bytes[len - 1] == '\r'), false};
    if (memchr(bytes, 0, len) != NULL)
        return bad(r, "a NUL byte in a line");
    if (r->rows_left > 0)
        part->last = --r->rows_left == 0;
    else if (len > 0 && bytes[0] == '#')
        part->kind = REPLY_COMMENT;
    else if (!read_status(r, part))
        return bad(r, "neither OK nor ERR nor a comment");
    return (ptrdiff_t)len + 1;
}

bool reply_reader_idle(const struct reply_reader *r)
{
    return r->rows_left == 0 && r->bytes_left == 0 && r->scanned == 0;
}

bool reply_key(const struct reply_part *status, const char *key, const char **value, size_t *len)
{
    const char *p = status->text, *end = p + status->len;
    size_t n = strlen(key);
    while (p < end && (p = memchr(p, ' ', (size_t)(end - p))) != NULL) {
        p++;
        if (!starts_with(p, (size_t)(end - p), key) || (size_t)(end - p) == n || p[n] != '=')
            continue;
        *value = p + n + 1;
        const char *space = memchr(*value, ' ', (size_t)(end - *value));
        *len = (size_t)((space != NULL ? space : end) - *value);
        return true;
    }
    return false;
}

bool reply_key_number(const struct reply_part *status, const char *key, uint64_t *value)
{
    const char *text;
    size_t len;
    return reply_key(status, key, &text, &len) && proto_read_u64(text, len, value);
}

uint64_t reply_rows(const struct reply_part *status)
{
    uint64_t rows = 0;
    if (status->kind == REPLY_OK || status->kind == REPLY_EVENT)
        read_row_count(status->text, status->len, &rows);
    return rows;
}
