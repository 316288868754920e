/* cavity.h - a hole in the mesh: the triangles in it, and the rim of half edges around it.
 *
 * Both edits of a live mesh replace the triangles of a disc by other triangles with the same rim.
 * The closed surface (ghosts included) makes hull and interior alike: a disc of k triangles without
 * inner vertex has k + 2 rim edges. */
#ifndef DT_CAVITY_H
#define DT_CAVITY_H

#include "core/control/work.h"
#include "core/mesh/mesh.h"
#include "core/points/changes.h"

struct dt_rim {
    uint32_t origin; /* where the rim edge starts, counterclockwise around the hole; DT_NONE at
                        infinity */
    uint32_t beyond; /* the half edge on the other side of it */
};

/* Scratch memory that successive edits reuse; it grows to what the largest one needed. Start with
 * {0}. */
struct dt_cavity {
    uint32_t *record;   /* owns: the base half edges of the triangles in the hole */
    struct dt_rim *rim; /* owns */
    uint32_t *stack;    /* owns: half edges to be crossed */
    uint32_t records, rims, stacked;
    uint32_t record_cap, rim_cap, stack_cap;
    struct dt_work *work; /* borrows: the work left to the edit; NULL: no limit */
    const struct dt_changes
        *changes; /* borrows; notified of the stars that change; NULL: not needed */
};

void dt_cavity_clear(struct dt_cavity *c);
size_t dt_cavity_memory(const struct dt_cavity *c);

/* Empties the hole; keeps its memory. */
static inline void dt_cavity_begin(struct dt_cavity *c)
{
    c->records = c->rims = c->stacked = 0;
}

/* Append; false: out of memory. */
bool dt_cavity_grow_records(struct dt_cavity *c);
bool dt_cavity_grow_rim(struct dt_cavity *c);
bool dt_cavity_grow_stack(struct dt_cavity *c);

static inline bool dt_cavity_add(struct dt_cavity *c, uint32_t base)
{
    if (c->records == c->record_cap && !dt_cavity_grow_records(c))
        return false;
    c->record[c->records++] = base;
    return true;
}

static inline bool dt_cavity_add_rim(struct dt_cavity *c, uint32_t origin, uint32_t beyond)
{
    if (c->rims == c->rim_cap && !dt_cavity_grow_rim(c))
        return false;
    c->rim[c->rims++] = (struct dt_rim){origin, beyond};
    return true;
}

/* Reports the stars of the vertices on the rim, which are going to change. */
static inline void dt_cavity_report(const struct dt_cavity *c)
{
    for (uint32_t i = 0; c->changes != NULL && i < c->rims; i++)
        if (c->rim[i].origin != DT_NONE)
            dt_changes_star(c->changes, c->rim[i].origin);
}

static inline bool dt_cavity_push(struct dt_cavity *c, uint32_t half)
{
    if (c->stacked == c->stack_cap && !dt_cavity_grow_stack(c))
        return false;
    c->stack[c->stacked++] = half;
    return true;
}

#endif
