/* room.c - see room.h. */
#include "server/rows/room.h"

bool room_make(struct reservation *memory, struct buf *out, size_t bytes, size_t beside)
{
    size_t all = buf_len(out) + bytes, cap = out->cap > all ? out->cap : all;
    if (bytes + beside <= ROOM_ROW)
        return true;
    if (memory != NULL && memory->bytes < cap + beside &&
        !reservation_resize(memory, cap + beside)) {
        out->failed = true;
        return false;
    }
    return buf_reserve_exactly(out, bytes) != NULL;
}
