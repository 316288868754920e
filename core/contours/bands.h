/* bands.h - what bands.c reads from the surface, and bands_join.c joins to rings. */
#pragma once

#include "core/contours/reading.h"
#include "core/control/stop.h"

/* The line of a level in a triangle, as in contour.c. An edge whose ends are equal is a vertex: its value is the level,
 * so the line goes through it. */
struct dt_band_crossing {
    uint32_t level; /* its number */
    struct dt_edge in, out;
    uint32_t above, below; /* pieces, of bands */
    struct dt_point from, to;
};

/* A part of an edge of the surface's border, from a to b with the surface on its left. */
struct dt_band_border {
    uint32_t class;
    uint32_t a, b;
    uint32_t start, end; /* levels; DT_NONE: a, b itself */
    struct dt_point from;
};

/* The end of a side of a band at a vertex. Sides around a vertex have an order by `toward`: the direction of an
 * edge of the mesh, and with `beside` of a line in the triangle that follows the edge counterclockwise. */
struct dt_band_end {
    uint32_t vertex, class, side;
    bool begins, beside;
    struct dt_point at, toward;
};

/* A piece that has the whole edge on its boundary; both corners are marked. */
struct dt_band_tie {
    struct dt_edge edge;
    uint32_t piece;
};

enum dt_band_stage { DT_BANDS_VALUES, DT_BANDS_BORDER, DT_BANDS_TRIANGLES, DT_BANDS_READ };

struct dt_bands {
    struct dt_reading read; /* owns */
    enum dt_band_stage stage;
    uint32_t record; /* of the border: the next one of the mesh, or the next id of the stars */

    /* All own `*_cap`. The border is read before the first crossing. */
    struct dt_band_border *border;
    struct dt_band_crossing *crossing;
    struct dt_band_end *end;
    struct dt_band_tie *tie;
    size_t borders, border_cap, crossings, crossing_cap, most, ends, end_cap, ties, tie_cap;
    uint32_t *parent; /* of pieces, in a forest: ids of points that are not marked, then others */
    size_t pieces, piece_cap;

    /* Of the end, all owned: */
    uint32_t *next; /* side of a side */
    uint32_t *knot; /* of a side: 1 + the number of the knot where it begins, 0: none */
    size_t knots;
    uint32_t *slot, *tie_slot;
    size_t slots, tie_slots;
    uint32_t *walk, *at; /* sides; where in the walk a knot is */
    struct dt_point *place;
    size_t places;
    struct dt_band_loop *loop;
    size_t loops;
    struct dt_band_ring *ring;
    size_t rings;
};

/* A ring of places, before it is known to be an outer one or a hole. */
struct dt_band_loop {
    uint32_t class, piece;
    struct dt_point *p;
    size_t n;
    bool hole;
    double area; /* signed; only of one that belongs to several loops */
};

/* Sides are numbered: first the sides of the border, then two for each crossing. The first of the two belongs to the band above
 * the line and has its direction; the second belongs to the band below. */
static inline uint32_t dt_band_side(const struct dt_bands *b, size_t crossing, bool below)
{
    return (uint32_t)(b->borders + 2 * crossing + below);
}

/* Whether points of this class are between two levels. */
static inline bool dt_is_band(const struct dt_bands *b, uint32_t class)
{
    return class > 0 && class < b->read.levels;
}

static inline uint32_t dt_piece_find(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static inline void dt_piece_unite(uint32_t *parent, uint32_t i, uint32_t k)
{
    i = dt_piece_find(parent, i);
    k = dt_piece_find(parent, k);
    if (i < k)
        parent[k] = i;
    else
        parent[i] = k;
}

/* Joins what has been read: b->loop, whose pieces are roots. */
enum dt_status dt_bands_join(struct dt_bands *b, struct dt_stop *stop);

/* The bytes that both take at most. */
size_t dt_bands_join_memory(const struct dt_bands *b);

/* Sorts the loops into b->ring (bands_sort.c). */
enum dt_status dt_bands_sort(struct dt_bands *b, struct dt_stop *stop);
