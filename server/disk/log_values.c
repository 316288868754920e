/* log_values.c - the columns of values that are appended to a log (log.h). */
#include "server/disk/log.h"

#include "core/delaunay.h"

#include <stdlib.h>

struct log_values *log_values_new(size_t columns)
{
    struct log_values *v = calloc(1, sizeof *v + columns * sizeof v->field[0]);
    if (v != NULL)
        v->columns = columns;
    return v;
}

void log_values_free(struct log_values *v)
{
    if (v != NULL)
        dt_pages_release(v->v);
    free(v);
}

uint64_t log_values_records(const struct log_values *v)
{
    if (v == NULL)
        return 0;
    uint64_t n = ((uint64_t)v->n + RECORD_MOST_VALUES - 1) / RECORD_MOST_VALUES;
    return v->columns * (n > 0 ? n : 1);
}
