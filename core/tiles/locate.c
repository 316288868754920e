/* locate.c - which triangle of a tile contains a place. Walks go side by side (core/query/ahead.h). A place on an edge or at a point is in
 * several triangles, and other tiles may output some of them; the first row among those of all tiles is the answer. */
#include "core/tiles/tile.h"

#include <stdlib.h>
#include <string.h>

#include "core/arrays/arrays.h"
#include "core/arrays/workers.h"
#include "core/query/ahead.h"
#include "core/query/locate.h"

struct row {
    uint64_t id[3];
};

static const struct row none = {{UINT64_MAX, UINT64_MAX, UINT64_MAX}};

static bool precedes(const struct row *a, const struct row *b)
{
    unsigned k = 0;
    while (k < 2 && a->id[k] == b->id[k])
        k++;
    return a->id[k] < b->id[k];
}

/* The row of the triangle of half edge h, if the tile outputs it. */
static struct row row_of(const struct dt_tile *tile, uint32_t h)
{
    const struct dt_mesh *m = &tile->t->mesh;
    const uint32_t *corner = m->half + dt_base(h), *local = tile->t->points.id;
    uint64_t id[3];
    unsigned k = 0;
    if (dt_is_ghost(m, h))
        return none;
    for (unsigned i = 0; i < 3; i++) {
        id[i] = tile->id[local[corner[i]]];
        k = id[i] < id[k] ? i : k;
    }
    return dt_is_own(tile, local[corner[k]])
               ? (struct row){{id[k], id[(k + 1) % 3], id[(k + 2) % 3]}}
               : none;
}

static struct row first_round(const struct dt_tile *tile, uint32_t h)
{
    struct row least = none;
    uint32_t first = h;
    do {
        struct row row = row_of(tile, h);
        least = precedes(&row, &least) ? row : least;
        h = dt_turn_ccw(&tile->t->mesh, h);
    } while (h != first);
    return least;
}

static struct row find(const struct dt_tile *tile, const struct dt_place *place)
{
    uint32_t h;
    struct row row, other;
    switch (dt_find(tile->t, place, &h)) {
    case DT_ON_VERTEX:
        return first_round(tile, h);
    case DT_ON_EDGE:
        row = row_of(tile, h);
        other = row_of(tile, dt_twin(&tile->t->mesh, h));
        return precedes(&other, &row) ? other : row;
    case DT_INSIDE:
        return row_of(tile, h);
    case DT_OUTSIDE:
        return none;
    }
    return none;
}

/* Places that predicates cannot take are outside of everything. */
static void locate_some(const struct dt_tile *tile, const struct dt_point *q, size_t n,
                        uint64_t *row)
{
    struct dt_place place[DT_AHEAD];
    bool ok[DT_AHEAD];
    for (size_t i = 0; i < n; i++) {
        place[i] = (struct dt_place){q[i], DT_NONE};
        ok[i] = dt_place_ok(&place[i].at);
        place[i].at = ok[i] ? place[i].at : (struct dt_point){0, 0};
    }
    dt_walk_to_places(tile->t, place, (uint32_t)n, DT_PLACE_INSERT);
    for (size_t i = 0; i < n; i++) {
        struct row r = ok[i] ? find(tile, &place[i]) : none;
        memcpy(row + 3 * i, &r, sizeof r);
    }
}

enum dt_status dt_tile_locate(struct dt_tile *tile, const struct dt_point *q, size_t n,
                              uint64_t *row)
{
    fenv_t caller = dt_call_begin();
    enum dt_status s = dt_tile_refresh(tile);
    if (s == DT_OK)
        s = dt_prepare(tile->t, NULL);
    bool any = tile->t->mesh.vertices >= 2;
    for (size_t i = 0, some; s == DT_OK && i < n; i += some) {
        some = n - i < DT_AHEAD ? n - i : DT_AHEAD;
        if (any)
            locate_some(tile, q + i, some, row + 3 * i);
        for (size_t k = 0; !any && k < some; k++)
            memcpy(row + 3 * (i + k), &none, sizeof none);
    }
    dt_call_end(&caller);
    return s;
}
