/* arena.h - scratch memory in stack order: a recursion allocates what it needs and releases it by returning to
 * a mark. */
#pragma once

#include <stddef.h>

struct dt_arena_chunk;
struct dt_pages;

struct dt_arena {
    struct dt_pages *pages;       /* borrows; where large chunks come from; NULL: the system */
    struct dt_arena_chunk *chunk; /* owns a list, the one in use first */
    struct dt_arena_chunk *spare; /* owns one that was given back, or NULL */
};

struct dt_arena_mark {
    struct dt_arena_chunk *chunk;
    size_t used;
};

/* Start with {0}, or set only `pages`. */
void dt_arena_clear(struct dt_arena *a);

/* n items of size bytes, aligned to 16, not initialised, valid until a mark taken before is
 * returned to; NULL: out of memory. */
void *dt_arena_take(struct dt_arena *a, size_t n, size_t size);

struct dt_arena_mark dt_arena_mark(const struct dt_arena *a);
void dt_arena_return(struct dt_arena *a, struct dt_arena_mark mark);
