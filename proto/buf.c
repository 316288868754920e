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

char *buf_make_room(struct buf *b, size_t n)
{
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
