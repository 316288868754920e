/* buf.c - see buf.h. */
#include "proto/buf.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { SMALLEST = 256 };

static bool resize(struct buf *b, size_t cap)
{
    char *data = realloc(b->data, cap);
    if (data == NULL)
        return false;
    b->data = data;
    b->cap = cap;
    return true;
}

static bool grow(struct buf *b, size_t want)
{
    size_t cap = b->cap < SMALLEST ? SMALLEST : b->cap;
    while (cap < want) {
        if (cap > SIZE_MAX / 2)
            return false;
        cap *= 2;
    }
    return resize(b, cap);
}

static void move_to_front(struct buf *b)
{
    size_t len = buf_len(b);
    memmove(b->data, b->data + b->start, len);
    b->start = 0;
    b->end = len;
}

char *buf_make_room(struct buf *b, size_t n)
{
    /* Moving the content to the front pays only if it is no longer than what was consumed before
     * it. */
    if (b->start >= buf_len(b) && b->start > 0)
        move_to_front(b);
    if (b->cap - b->end < n && (n > SIZE_MAX - b->end || !grow(b, b->end + n))) {
        b->failed = true;
        return NULL;
    }
    return b->data + b->end;
}

char *buf_reserve_exactly(struct buf *b, size_t n)
{
    if (b->cap - b->end >= n)
        return b->end == 0 ? b->data : b->data + b->end; /* there may be no memory */
    if (b->start > 0)
        move_to_front(b);
    if (b->cap - b->end < n && (n > SIZE_MAX - b->end || !resize(b, b->end + n))) {
        b->failed = true;
        return NULL;
    }
    return b->data + b->end;
}

void buf_fit(struct buf *b)
{
    if (b->end == 0)
        buf_free(b);
    else
        resize(b, b->end);
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
