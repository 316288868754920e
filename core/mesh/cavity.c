/* cavity.c - see cavity.h. */
#include "core/mesh/cavity.h"

#include "core/memory/memory.h"
#include "core/mesh/fixed.h"

void dt_cavity_clear(struct dt_cavity *c)
{
    dt_array_free(c->record);
    dt_array_free(c->rim);
    dt_array_free(c->stack);
    *c = (struct dt_cavity){0};
}

size_t dt_cavity_memory(const struct dt_cavity *c)
{
    return c->room * (sizeof *c->record + sizeof *c->rim + sizeof *c->stack);
}

bool dt_cavity_grow(struct dt_cavity *c)
{
    size_t room = dt_array_room(c->room, (size_t)c->room + 64, UINT32_MAX);
    if (!dt_array_resize(NULL, &c->record, c->room, room, sizeof *c->record) ||
        !dt_array_resize(NULL, &c->rim, c->room, room, sizeof *c->rim) ||
        !dt_array_resize(NULL, &c->stack, c->room, room, sizeof *c->stack))
        return false;
    c->room = (uint32_t)room;
    return true;
}

void dt_keep_rim_fixed(struct dt_mesh *m, const struct dt_cavity *c)
{
    for (uint32_t i = 0; i < c->rims; i++)
        dt_fixed_mark(m, dt_twin(m, c->rim[i].beyond), dt_is_fixed(m, c->rim[i].beyond));
}
