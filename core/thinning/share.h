/* share.h - which triangle of the surface has which points, from its beginning and after each new vertex. */
#pragma once

#include "core/thinning/coarse.h"
#include "core/thinning/facets.h"

/* A triangle of the star of a new vertex, or one of two parts of an edge: from an edge of the star to the next one. */
struct dt_sector {
    struct dt_point to;  /* the other end of the edge where it begins */
    struct dt_point way; /* the same as seen from the new vertex */
    bool on_left;        /* a point on that edge belongs to it, not to the sector before */
    uint32_t base;       /* of its record */
    struct dt_plane plane;
    struct dt_worst worst;
    uint32_t first, n; /* its list: where it begins, items, */
    uint32_t blocks;   /* of which the first ones are blocks */
};

/* A block, and the sector that has it. */
struct dt_shared {
    uint32_t item, sector;
};

/* Scratch. Start with {0}. */
struct dt_share {
    struct dt_sector *sector; /* owns cap */
    uint32_t sectors, cap;
    struct dt_coarse coarse; /* the first sectors again */
    /* sectors before it begin less than a half turn after the first one; open stars: all */
    uint32_t half;
    bool on_line; /* the sectors are two parts of an edge */
    struct dt_rounded
        *point;   /* owns point_cap, as the next two: those of facets that are replaced */
    uint32_t *of; /* their sectors; DT_NONE: none */
    float *off;   /* about how far they are off; 0 if that has been looked at */
    size_t points, point_cap;
    struct dt_shared *block; /* owns block_cap: blocks of these facets; then those in one sector */
    size_t blocks, block_cap;
};

void dt_share_clear(struct dt_share *h);

/* All points that are not kept and have a value get into the lists of facets; f has a pool for them. pages may be NULL. */
enum dt_status dt_share_all(struct dt_facets *f, const bool *kept, struct dt_pages *pages,
                            struct dt_stop *stop);

/* The worst point of the facet with that number becomes a vertex, for which there is room, and the points around it change
 * their facets. After a failure the facets can only be freed. */
enum dt_status dt_share_insert(struct dt_facets *f, struct dt_share *h, uint32_t facet,
                               struct dt_stop *stop);
