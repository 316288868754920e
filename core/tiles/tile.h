/* tile.h - the definition of struct dt_tile; for the files of this room only. */
#pragma once

#include "core/delaunay_tiles.h"
#include "core/set/set.h"
#include "core/tiles/pairs.h"

struct dt_tile {
    struct dt *t; /* owns; its ids are the local ids: own points first, then foreign ones */
    uint64_t *id; /* owns `room`: global ids, by local id */
    size_t room;
    uint32_t own;        /* how many own points */
    uint32_t points;     /* own and foreign points */
    uint32_t coincident; /* own points that are aliases of others */
    uint32_t judged;     /* faces without a corner from this local id on have been judged */
    bool opened;         /* dt_tile_open has been called */
    /* owns; half edges of triangles: the first ones of faces that outgoing.c has postponed */
    struct dt_ids postponed;
    struct dt_box box; /* of the own points, if any */
    struct dt_pairs sent;
};

/* Brings the triangulation up to date. If that rebuilds it, every face is judged again if some were postponed. */
enum dt_status dt_tile_refresh(struct dt_tile *tile);

static inline bool dt_is_own(const struct dt_tile *tile, uint32_t local)
{
    return local < tile->own;
}
