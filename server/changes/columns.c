/* columns.c - see columns.h. */
#include "server/changes/columns.h"

#include "core/delaunay.h"

#include <stdlib.h>

struct columns *columns_new(size_t count)
{
    struct columns *c = calloc(1, sizeof *c + count * sizeof c->field[0]);
    if (c != NULL)
        c->count = count;
    return c;
}

void columns_free(struct columns *c)
{
    if (c != NULL)
        dt_pages_release(c->v);
    free(c);
}

const double *columns_values(const struct columns *c, size_t k)
{
    return c->v == NULL ? NULL : c->v + k * (size_t)c->n;
}

uint64_t columns_records(const struct columns *c)
{
    if (c == NULL)
        return 0;
    uint64_t n = ((uint64_t)c->n + RECORD_MOST_VALUES - 1) / RECORD_MOST_VALUES;
    return c->count * (n > 0 ? n : 1);
}
