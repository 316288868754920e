/* stop.c - see stop.h. */
#include "core/control/stop.h"

#include <string.h>

void dt_stop_because(struct dt_stop *s, enum dt_status why)
{
    int none = DT_OK;
    atomic_compare_exchange_strong(&s->status, &none, (int)why);
}

bool dt_stopped(struct dt_stop *s)
{
    if (s == NULL)
        return false;
    if (s->cancel != NULL && atomic_load_explicit(s->cancel, memory_order_relaxed))
        dt_stop_because(s, DT_CANCELLED);
    return dt_stop_status(s) != DT_OK;
}

void dt_copy(void *to, const void *from, size_t n, size_t size, struct dt_stop *stop)
{
    enum { PIECE = 1 << 20 };
    size_t bytes = n * size;
    for (size_t at = 0, piece; at < bytes && !dt_stopped(stop); at += piece) {
        piece = bytes - at < PIECE ? bytes - at : PIECE;
        memcpy((char *)to + at, (const char *)from + at, piece);
    }
}
