/* reader.c - growing arrays of ids. */
#include "core/set/reader.h"

#include <stdlib.h>

enum dt_status dt_ids_reserve(struct dt_ids *ids, size_t more)
{
    if (more <= ids->cap - ids->n)
        return DT_OK;
    size_t want = ids->n + more;
    want = want < 2 * ids->cap ? 2 * ids->cap : want;
    want = want < 16 ? 16 : want;
    uint32_t *v = realloc(ids->v, want * sizeof *v);
    if (v == NULL)
        return DT_NOMEM;
    ids->v = v;
    ids->cap = want;
    return DT_OK;
}
