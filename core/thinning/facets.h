/* facets.h - the triangles of the surface, each with a list of the points in it. A heap has the triangles with a point that is
 * off by more than the bound, the worst one first. Entries of the heap whose facet has changed are dropped
 * when they come first, or when there is no room.
 *
 * Every point with a value that is not kept is in one list. A point on an edge belongs to the triangle on the left of
 * the edge, directed from its lesser end to the other. A point on an edge of the hull belongs to the one triangle there. So which
 * triangle has a point depends on the triangulation alone, not on its history.
 *
 * While all points that are kept are on one line there are ghosts only (mesh.h): the one whose corners ascend is the facet of
 * the points between them.
 *
 * A list has blocks all of whose points belong to it, and then points. Lists lie in a pool. A list that is replaced leaves a gap for
 * the next list of that length, which is likely to be in the caches still. A full pool is copied without gaps, and is full again when about
 * half of it are gaps. */
#pragma once

#include "core/set/set.h"
#include "core/thinning/heap.h"
#include "core/thinning/plane.h"

/* By the number of a record of the mesh. */
struct dt_facet {
    double off;      /* of the worst point, 0 without points; more than the bound: the point is */
    uint32_t first;  /* where its list begins in the pool */
    uint32_t n;      /* items of the list, */
    uint32_t blocks; /* of which the first ones are blocks */
    uint32_t worst;  /* point; DT_NONE: there are none */
    bool heaped;     /* an entry of the heap is about it as it is */
};

enum { DT_HEAP_FACTOR = 2, DT_FACETS_GAPS = 64 };

struct dt_facets {
    struct dt_samples *samples; /* borrows */
    double bound;
    struct dt *set; /* owns; the points that were there first; its mesh has all that are kept */
    struct dt_point *xy; /* owns vertex_cap, as the next two: by vertex of the mesh */
    double *z;
    uint32_t *sample;
    uint32_t vertices, vertex_cap;
    struct dt_facet *facet; /* owns facet_cap: of all records for which the mesh has room */
    uint32_t facet_cap;
    struct dt_heap heap;     /* has room for DT_HEAP_FACTOR facet_cap */
    uint32_t items, settled; /* of all lists, and of those of facets that are not in the heap */
    struct dt_rounded *pool; /* owns two halves of pool_room */
    size_t pool_room, pool_begin, pool_end; /* of the half that is in use, the part that is, */
    size_t pool_limit;                      /* and where it is full */
    uint32_t gap
        [DT_FACETS_GAPS]; /* by length: the first of the gaps, whose first item is the next one; DT_NONE */
};

void dt_facets_clear(struct dt_facets *f);

/* Makes room for the vertices, and for a facet for each record of the mesh. DT_NOMEM. */
enum dt_status dt_facets_reserve(struct dt_facets *f, uint32_t vertices);

/* The bytes for that many vertices, with the mesh, and those of the pool for n points. */
size_t dt_facets_memory(uint32_t vertices);
size_t dt_facets_pool_memory(uint32_t n);

/* Makes the pool, for n points in all, from pages, which may be NULL. DT_NOMEM. */
enum dt_status dt_facets_pool(struct dt_facets *f, uint32_t n, struct dt_pages *pages);

/* Makes room for lists of n items in all; lists may move. With those that are there they have no more points than the pool is
 * for. Cost: constant, amortised over the points. */
void dt_facets_make_room(struct dt_facets *f, size_t n);

/* Returns where a list of n items can be; there is room. */
uint32_t dt_facets_take(struct dt_facets *f, uint32_t n);

/* The corners of a record that is a facet. */
struct dt_corners dt_facet_corners(const struct dt_facets *f, uint32_t base);

/* Whether the record with that base is a facet: a triangle, or of points on a line a ghost with ascending corners. */
bool dt_is_facet(const struct dt_facets *f, uint32_t base);

/* The record becomes a facet whose list is in the pool, and whose worst point is off that far from the plane; what is in
 * doubt is decided. DT_CANCELLED: nothing has changed. */
enum dt_status dt_facet_set(struct dt_facets *f, uint32_t base, const struct dt_plane *p,
                            struct dt_facet facet, struct dt_stop *stop);

/* Whether the facet is still as it was when it got the entry. */
static inline bool dt_facets_hold(const struct dt_facets *f, const struct dt_heaped *h)
{
    const struct dt_facet *facet = &f->facet[h->facet];
    return facet->heaped && facet->worst == h->worst && facet->off == h->off;
}

/* The facet with the worst point of all; DT_NONE: no point is off by more than the bound. Cost: O(log n), amortised over the
 * facets that were set; fetches what the insertions of the next worst points will read. */
uint32_t dt_facets_worst(struct dt_facets *f);

/* The record is no facet any more. Its list leaves a gap. */
void dt_facet_empty(struct dt_facets *f, uint32_t base);

/* The worst of several points, by how far they are off and their places. Start with dt_worst_none. */
struct dt_worst {
    double off;
    uint32_t point;
    double least; /* some point, which need not have been added, is off by at least that */
};

static const struct dt_worst dt_worst_none = {0, DT_NONE, 0};

bool dt_worst_is_less(const struct dt_sample *s, const struct dt_worst *w, uint32_t i);

static inline void dt_worst_add(struct dt_worst *w, const struct dt_sample *s, uint32_t i,
                                double off)
{
    if (off > w->off || (off == w->off && dt_worst_is_less(s, w, i))) {
        w->off = off;
        w->point = i;
    }
}

/* Bounds of how far the worst point of a block is off, as dt_plane_off rounds it. */
static inline struct dt_off_range dt_block_off_range(const struct dt_bunch *b,
                                                     const struct dt_plane *p)
{
    const double z = p->z + (p->dx * (b->at.x - p->at.x) + p->dy * (b->at.y - p->at.y));
    const double above = b->most - z, below = z - b->least, off = above > below ? above : below;
    const double rise = fabs(p->dx) * b->width + fabs(p->dy) * b->height + 2 * p->doubt;
    return (struct dt_off_range){off - rise, off + rise};
}

static inline void dt_worst_raise(struct dt_worst *w, double least)
{
    w->least = least > w->least ? least : w->least;
}

/* Adds all points of a block, how far they are off the plane. Cost: constant if they cannot count. */
void dt_worst_add_block(struct dt_worst *w, const struct dt_samples *s, uint32_t item,
                        const struct dt_plane *p);
