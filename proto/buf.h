/* buf.h - a growing queue of bytes: appended at the end, consumed from the front.
 *
 * A buffer owns its memory and has none while it is new ({0}) or freed, so an idle connection costs nothing. A
 * failed allocation sets `failed` and leaves the content unchanged: writers append without checks, and the
 * owner of the reply checks once at its end. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

struct buf {
    char *data;        /* owns; bytes start .. end - 1 are the content */
    size_t start, end; /* start == end: empty */
    size_t cap;
    bool failed; /* an allocation failed since the last buf_free or buf_rewind */
};

static inline size_t buf_len(const struct buf *b)
{
    return b->end - b->start;
}

/* The first byte of the content; valid until the next append. NULL if the buffer has no memory. */
static inline char *buf_head(const struct buf *b)
{
    return b->start == 0 ? b->data : b->data + b->start;
}

/* The slow path of buf_reserve. */
char *buf_make_room(struct buf *b, size_t n);

/* Makes room for n more bytes and returns their place; NULL, and failed, when out of memory. Cost: amortised
 * constant per byte. */
static inline char *buf_reserve(struct buf *b, size_t n)
{
    return b->cap - b->end >= n ? b->data + b->end : buf_make_room(b, n);
}

/* The same without more room than that. Cost: all bytes. */
char *buf_reserve_exactly(struct buf *b, size_t n);

/* Gives back the room behind the content, if it can. */
void buf_fit(struct buf *b);

/* The first n reserved bytes have been written. */
static inline void buf_commit(struct buf *b, size_t n)
{
    b->end += n;
}

static inline void buf_append(struct buf *b, const void *bytes, size_t n)
{
    char *to = n > 0 ? buf_reserve(b, n) : NULL;
    if (to == NULL)
        return;
    memcpy(to, bytes, n);
    buf_commit(b, n);
}

static inline void buf_append_text(struct buf *b, const char *text)
{
    buf_append(b, text, strlen(text));
}

static inline void buf_append_char(struct buf *b, char c)
{
    buf_append(b, &c, 1);
}

/* Drops n bytes from the front. */
void buf_consume(struct buf *b, size_t n);

/* Truncates the content to its first len bytes and clears `failed`: for a reply that has failed half way. */
void buf_rewind(struct buf *b, size_t len);

/* Frees the memory; the buffer is new again. */
void buf_free(struct buf *b);
