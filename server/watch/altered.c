/* altered.c - see altered.h. */
#include "server/watch/altered.h"

#include <stdlib.h>
#include <string.h>

void altered_clear(struct altered *r)
{
    free(r->row);
    *r = (struct altered){.cap = 0};
}

void altered_forget(struct altered *r)
{
    r->first = ++r->end; /* a new number, so that nobody who knows the last one misses this */
}

/* Makes room for n more; at most half of the others are forgotten at a time, so each moves few times. */
static bool make_room(struct altered *r, size_t n)
{
    size_t have = (size_t)(r->end - r->first), cap = 2 * (have + n);
    if (have + n > ALTERED_MOST && have > ALTERED_MOST / 2) {
        size_t gone = have - ALTERED_MOST / 2;
        have -= gone;
        memmove(r->row, r->row + gone, have * sizeof *r->row);
        r->first += gone;
    }
    if (have + n <= r->cap)
        return true;
    cap = cap < ALTERED_MOST ? cap : ALTERED_MOST;
    struct dt_touched_constraint *row = have + n <= cap ? realloc(r->row, cap * sizeof *row) : NULL;
    if (row == NULL)
        return false;
    r->row = row;
    r->cap = cap;
    return true;
}

void altered_put(struct altered *r, const struct dt_touched_constraint *c, size_t n)
{
    if (n == 0)
        return;
    if (!make_room(r, n)) {
        altered_forget(r);
        return;
    }
    memcpy(r->row + (r->end - r->first), c, n * sizeof *c);
    r->end += n;
}
