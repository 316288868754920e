/* constraints.c - see constraints.h. */
#include "core/constraints/constraints.h"

#include <stdlib.h>

struct dt_constraints *dt_constraints_new(struct dt_pages *pages)
{
    struct dt_constraints *c = calloc(1, sizeof *c);
    if (c != NULL)
        c->declared.pages = c->declared.first.keeper = pages;
    return c;
}

void dt_constraints_free(struct dt_constraints *c)
{
    if (c == NULL)
        return;
    dt_declared_clear(&c->declared);
    dt_enforcer_clear(&c->enforcer);
    dt_history_clear(&c->history);
    dt_regions_clear(&c->regions);
    free(c);
}

size_t dt_constraints_memory(const struct dt_constraints *c)
{
    return c == NULL
               ? 0
               : sizeof *c + dt_declared_memory(&c->declared) + dt_enforcer_memory(&c->enforcer) +
                     dt_regions_memory(&c->regions) + dt_history_memory(&c->history);
}

enum dt_status dt_constraints_copy(const struct dt_constraints *c, struct dt_constraints **copy)
{
    struct dt_constraints *to = c == NULL ? NULL : calloc(1, sizeof *to);
    if (c != NULL && (to == NULL || dt_declared_copy(&c->declared, &to->declared) != DT_OK)) {
        free(to);
        return DT_NOMEM;
    }
    *copy = to;
    return DT_OK;
}
