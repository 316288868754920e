/* arena.c - a list of chunks, each at least twice as large as the request, unless that is large; see
 * arena.h. */
#include "core/memory/arena.h"

#include "core/memory/memory.h"

#define MIN_CHUNK ((size_t)1 << 16)
#define LARGE ((size_t)1 << 20)

struct dt_arena_chunk {
    struct dt_arena_chunk *below;
    size_t used, size;
    _Alignas(16) unsigned char bytes[];
};

void dt_arena_clear(struct dt_arena *a)
{
    dt_arena_return(a, (struct dt_arena_mark){NULL, 0});
    dt_array_free(a->spare);
    a->spare = NULL;
}

static struct dt_arena_chunk *new_chunk(struct dt_arena *a, size_t need)
{
    struct dt_arena_chunk *c = a->spare;
    if (c != NULL && c->size >= need) {
        a->spare = NULL;
        return c;
    }
    size_t size = need > LARGE ? need : need * 2 < MIN_CHUNK ? MIN_CHUNK : need * 2;
    c = dt_array_new_in(a->pages, sizeof *c + size, 1);
    if (c != NULL)
        c->size = size;
    return c;
}

void *dt_arena_take(struct dt_arena *a, size_t n, size_t size)
{
    if (size != 0 && n > SIZE_MAX / 4 / size)
        return NULL;
    size_t need = (n * size + 15) & ~(size_t)15;
    struct dt_arena_chunk *c = a->chunk;
    if (c == NULL || c->size - c->used < need) {
        c = new_chunk(a, need);
        if (c == NULL)
            return NULL;
        c->below = a->chunk;
        c->used = 0;
        a->chunk = c;
    }
    void *p = c->bytes + c->used;
    c->used += need;
    return p;
}

struct dt_arena_mark dt_arena_mark(const struct dt_arena *a)
{
    return (struct dt_arena_mark){a->chunk, a->chunk == NULL ? 0 : a->chunk->used};
}

void dt_arena_return(struct dt_arena *a, struct dt_arena_mark mark)
{
    while (a->chunk != mark.chunk) {
        struct dt_arena_chunk *c = a->chunk;
        a->chunk = c->below;
        if (a->spare == NULL || a->spare->size < c->size) {
            dt_array_free(a->spare);
            a->spare = c;
        } else {
            dt_array_free(c);
        }
    }
    if (a->chunk != NULL)
        a->chunk->used = mark.used;
}
