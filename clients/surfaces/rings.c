/* rings.c - see rings.h. */
#include "clients/surfaces/rings.h"

#include <string.h>

#include "clients/lib/words.h"
#include "clients/points/nesting.h"

static bool read_row(struct paths *p, const char *row, size_t len, const char **fault)
{
    struct words w = {row, row + len};
    const char *word;
    size_t n = words_next(&w, &word);
    uint32_t corners, id;
    bool hole = n == 4 && memcmp(word, "hole", 4) == 0;
    *fault = "a row of the reply is no loop";
    if ((!hole && (n != 5 || memcmp(word, "outer", 5) != 0)) || !words_next_u32(&w, &corners) ||
        corners < 3 || corners > len)
        return false;
    *fault = "out of memory";
    if (!paths_begin(p, true, 0, 0, 0))
        return false;
    for (uint32_t i = 0; i < corners; i++) {
        *fault = "a row of the reply has too few points";
        if (!words_next_u32(&w, &id))
            return false;
        *fault = "out of memory";
        if (!paths_corner(p, id))
            return false;
    }
    struct path *path = &p->path[p->n - 1];
    path->n = corners;
    path->closed = true;
    path->hole = hole;
    *fault = NULL;
    return true;
}

bool rings_take(struct paths *p, const char *row, size_t len, const char **fault)
{
    const size_t before = p->n;
    bool ok = read_row(p, row, len, fault);
    p->n = ok ? p->n : before;
    return ok;
}

bool rings_to_shapes(struct paths *p, const double *xy, double radius, struct shapes *s)
{
    enum nesting nested = paths_nest(p, 0, true, xy);
    if (nested != NESTING_DONE)
        s->fault = nested == NESTING_NOMEM ? "out of memory"
                                           : "a hole of the shape is in none of its parts";
    bool ok = nested == NESTING_DONE;
    for (size_t k = 0; ok && k < p->n; k++) {
        const struct path *ring = &p->path[k];
        struct shape shape = {.key = radius, .closed = true, .hole = ring->hole, .n = ring->n};
        ok = shapes_add(s, &shape, p->corner + ring->first, xy);
    }
    return ok;
}
