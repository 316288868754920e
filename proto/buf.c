/* buf.c - see buf.h. */
#include "proto/buf.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { SMALLEST = 256 };

static bool grow(struct buf *b, size_t want)
{
    size_t cap = b->cap < SMALLEST ? SMALLEST : b->cap;
    while (cap < want) {
        if (cap > SIZE_MAX / 2)
            return false;
        cap *= 2;
    }
    char *data = realloc(b->data, cap);
    if (data == NULL)
        return false;
    b->data = data;
    b->cap = cap;
    return true;
}

char *buf_reserve(struct buf *b, size_t n)
{
    if (b->cap - b->end >= n)
        return b->data + b->end;
    size_t len = buf_len(b);
    /* Moving the content to the front pays only if it is no longer than what was consumed before
     * it. */
    if (b->start >= len && b->start > 0) {
        memmove(b->data, b->data + b->start, len);
        b->start = 0;
        b->end = len;
    }
    if (b->cap - b->end < n && (n > SIZE_MAX - b->end || !grow(b, b->end + n))) {
        b->failed = true;
        return NULL;
    }
    return b->data + b->end;
}

void buf_append(struct buf *b, const void *bytes, size_t n)
{
    if (n == 0)
        return;
    char *to = buf_reserve(b, n);
    if (to == NULL)
        return;
    memcpy(to, bytes, n);
    buf_commit(b, n);
}

void buf_append_text(struct buf *b, const char *text)
{
    buf_append(b, text, strlen(text));
}

void buf_append_char(struct buf *b, char c)
{
    buf_append(b, &c, 1);
}

void buf_consume(struct buf *b, size_t n)
{
    b->start += n;
    if (b->start == b->end)
        b->start = b->end = 0;
}

void buf_rewind(struct buf *b, size_t len)
{
    b->end = b->start + len;
    b->failed = false;
}

void buf_free(struct buf *b)
{
    free(b->data);
    *b = (struct buf){0};
}
