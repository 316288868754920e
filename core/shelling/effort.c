/* effort.c - see effort.h. */
#include "core/shelling/effort.h"

#define BETWEEN_POLLS (1u << 19) /* steps: a millisecond, or ten where they are slow */

bool dt_effort_poll(struct dt_effort *e)
{
    if (e->stop == NULL) {
        e->next = UINT64_MAX;
        return false;
    }
    if (e->spent > e->limit)
        dt_stop_because(e->stop, DT_TOOBIG);
    if (dt_stopped(e->stop))
        return true;
    e->next = e->spent + BETWEEN_POLLS;
    return false;
}
