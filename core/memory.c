/* memory.c - arrays that may be large; see memory.h. */
#include "core/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define HUGE_PAGE ((size_t)2 << 20)

void *dt_array_new(size_t n, size_t size)
{
    if (size != 0 && n > (SIZE_MAX - HUGE_PAGE) / size)
        return NULL;
    size_t bytes = n * size;
    if (bytes < 2 * HUGE_PAGE)
        return malloc(bytes > 0 ? bytes : 1);
    bytes = (bytes + HUGE_PAGE - 1) & ~(HUGE_PAGE - 1);
    void *p = aligned_alloc(HUGE_PAGE, bytes);
    if (p != NULL)
        (void)madvise(p, bytes,
                      MADV_HUGEPAGE); /* a wish: without it everything works, only slower */
    return p;
}

void *dt_array_grow(void *p, size_t used, size_t n, size_t size)
{
    void *larger = dt_array_new(n, size);
    if (larger == NULL)
        return NULL;
    if (used > 0)
        memcpy(larger, p, used * size);
    free(p);
    return larger;
}

size_t dt_array_room(size_t cap, size_t need, size_t limit)
{
    size_t room = cap + cap / 2;
    if (room < need)
        room = need;
    if (room < 16)
        room = 16;
    return room > limit ? limit : room;
}
