/* touched.c - see touched.h. */
#include "core/set/touched.h"

#include <stdlib.h>

enum { MOST = 16384 };

void dt_touched_clear(struct dt_touched *w)
{
    free(w->rows.key);
    free(w->values.key);
    *w = (struct dt_touched){.on = false};
}

void dt_touched_note(struct dt_touched_list *w, uint64_t key)
{
    if (w->all)
        return;
    if (w->n == w->cap) {
        size_t cap = w->cap == 0 ? 64 : 2 * w->cap;
        uint64_t *larger = w->n < MOST ? realloc(w->key, cap * sizeof *larger) : NULL;
        if (larger == NULL) {
            w->all = true;
            return;
        }
        w->key = larger;
        w->cap = cap;
    }
    w->key[w->n++] = key;
}
