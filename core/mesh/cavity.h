/* cavity.h - a hole in the mesh: the triangles in it, and the rim of half edges around it.
 *
 * Both edits of a live mesh replace the triangles of a disc by other triangles with the same rim.
 * The closed surface (ghosts included) makes hull and interior alike: a disc of k triangles without
 * inner vertex has k + 2 rim edges. */
#pragma once

#include "core/control/stop.h"
#include "core/exact/predicates.h"
#include "core/mesh/mesh.h"
#include "core/points/changes.h"

struct dt_enforcer;

struct dt_rim {
    uint32_t origin; /* where the rim edge starts, counterclockwise around the hole; DT_NONE at
                        infinity */
    uint32_t beyond; /* the half edge on the other side of it */
};

/* An edge of the hole that the search for it is going to cross. */
struct dt_crossing {
    struct dt_lifted end; /* its end counterclockwise around the hole, as the new vertex sees it */
    double cross;         /* of its ends */
    uint32_t h;           /* its half edge in the hole */
};

/* Scratch memory that successive edits reuse; it grows to what the largest one needed. Start with
 * {0}. */
struct dt_cavity {
    uint32_t *record;          /* owns `room`: the base half edges of the triangles in the hole */
    struct dt_rim *rim;        /* owns `room` */
    struct dt_crossing *stack; /* owns `room` */
    uint32_t records, rims, stacked;
    uint32_t room;
    bool open;                    /* infinity is on the rim */
    struct dt_stop *work;         /* borrows: the work left to the edit; NULL: no limit */
    struct dt_enforcer *enforcer; /* borrows; of edits of a mesh with fixed edges */
    uint32_t split; /* an edge that an insertion may cross although it is fixed; DT_NONE: none */
    const struct dt_changes *changes; /* borrows; told of the stars that change; NULL: not needed */
};

void dt_cavity_clear(struct dt_cavity *c);
size_t dt_cavity_memory(const struct dt_cavity *c);

/* Empties the hole; keeps its memory. */
static inline void dt_cavity_begin(struct dt_cavity *c)
{
    c->records = c->rims = c->stacked = 0;
    c->open = false;
}

bool dt_cavity_grow(struct dt_cavity *c); /* false: out of memory */

/* Adds a triangle; false: out of memory. Afterwards three arrays have room for 2 more entries than there are triangles: the
 * rim, the stack, and the list of the triangles that will fill the hole. */
static inline bool dt_cavity_add(struct dt_cavity *c, uint32_t base)
{
    if (c->records + 3 > c->room) {
        struct dt_cavity larger = *c; /* *c itself may stay in registers */
        bool grown = dt_cavity_grow(&larger);
        *c = larger;
        if (!grown)
            return false;
    }
    c->record[c->records++] = base;
    return true;
}

static inline void dt_cavity_add_rim(struct dt_cavity *c, uint32_t origin, uint32_t beyond)
{
    c->rim[c->rims++] = (struct dt_rim){origin, beyond};
    c->open |= origin == DT_NONE;
}

/* Other triangles have replaced those in the hole of a mesh that has fixed edges: the edges of the rim are fixed as before. */
void dt_keep_rim_fixed(struct dt_mesh *m, const struct dt_cavity *c);

/* Reports the stars of the vertices on the rim, which are going to change. */
static inline void dt_cavity_report(const struct dt_cavity *c)
{
    for (uint32_t i = 0; c->changes != NULL && i < c->rims; i++)
        if (c->rim[i].origin != DT_NONE)
            dt_changes_star(c->changes, c->rim[i].origin);
}
