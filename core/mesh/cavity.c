/* cavity.c - growing the scratch arrays; see cavity.h. */
#include "core/mesh/cavity.h"

#include "core/memory/memory.h"

void dt_cavity_clear(struct dt_cavity *c)
{
    dt_array_free(c->record);
    dt_array_free(c->rim);
    dt_array_free(c->stack);
    *c = (struct dt_cavity){0};
}

size_t dt_cavity_memory(const struct dt_cavity *c)
{
    return c->record_cap * sizeof *c->record + c->rim_cap * sizeof *c->rim +
           c->stack_cap * sizeof *c->stack;
}

/* Grows *array, which has room for *cap items, by half or more. */
static bool grow(void *array, uint32_t *cap, size_t size)
{
    void **p = array;
    size_t room = dt_array_room(*cap, (size_t)*cap + 64, UINT32_MAX);
    void *larger = dt_array_grow(*p, *cap, room, size);
    if (larger == NULL)
        return false;
    *p = larger;
    *cap = (uint32_t)room;
    return true;
}

bool dt_cavity_grow_records(struct dt_cavity *c)
{
    return grow(&c->record, &c->record_cap, sizeof *c->record);
}

bool dt_cavity_grow_rim(struct dt_cavity *c)
{
    return grow(&c->rim, &c->rim_cap, sizeof *c->rim);
}

bool dt_cavity_grow_stack(struct dt_cavity *c)
{
    return grow(&c->stack, &c->stack_cap, sizeof *c->stack);
}
