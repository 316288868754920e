/* row_memory.c - see row_memory.h. */
#include "server/rows/row_memory.h"

bool row_memory_reserve(struct reservation *memory, struct buf *out, size_t bytes, size_t beside)
{
    size_t all = buf_len(out) + bytes, cap = out->cap > all ? out->cap : all;
    if (bytes + beside <= ROW_MEMORY_SHORT)
        return true;
    if (memory != NULL && memory->bytes < cap + beside &&
        !reservation_resize(memory, cap + beside)) {
        out->failed = true;
        return false;
    }
    return buf_reserve_exactly(out, bytes) != NULL;
}
