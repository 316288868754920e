/* worst_facet.c - the facet with the worst point of all, and prefetches for those that are likely to follow.
 *
 * An insertion reads some sixty places in memory that are far from those of the last one. So the entries of the heap that come next are
 * fetched ahead, in three steps; each step reads only what the step before has fetched:
 *
 *     1. the facet, its record of the mesh, and its worst point;
 *     2. the corners and the list of the facet; the facets beside it and their records;
 *     3. the lists of these, their corners, and the records beyond.
 *
 * An entry makes a step while those before it are inserted. */
#include "core/memory/memory.h"
#include "core/thinning/facets.h"

static void fetch_facet(const struct dt_facets *f, uint32_t base)
{
    dt_fetch(&f->facet[base / 8]);
    dt_fetch(&f->set->mesh.half[base]);
}

static void fetch_first(const struct dt_facets *f, const struct dt_heaped *e)
{
    fetch_facet(f, 8 * e->facet);
    dt_fetch(&f->samples->v[e->worst]);
    dt_fetch(&f->samples->rounded[e->worst]);
}

static void fetch_vertex(const struct dt_facets *f, uint32_t v)
{
    dt_fetch(&f->xy[v]);
    dt_fetch(&f->z[v]);
    dt_fetch(&f->set->mesh.leaving[v]);
}

/* The beginning of the list. */
static void fetch_list(const struct dt_facets *f, uint32_t base)
{
    enum { LINES = 6, OF_LINE = 64 / sizeof(struct dt_rounded) };
    const struct dt_facet *facet = &f->facet[base / 8];
    for (uint32_t k = 0; k < facet->n && k < LINES * OF_LINE; k += OF_LINE)
        dt_fetch(&f->pool[facet->first + k]);
}

static void fetch_second(const struct dt_facets *f, const struct dt_heaped *e)
{
    const struct dt_mesh *m = &f->set->mesh;
    if (!dt_facets_hold(f, e))
        return;
    fetch_list(f, 8 * e->facet);
    for (uint32_t h = 8 * e->facet, end = h + 3; h < end; h++) {
        fetch_vertex(f, dt_origin(m, h));
        fetch_facet(f, dt_base(dt_twin(m, h)));
    }
}

static void fetch_third(const struct dt_facets *f, const struct dt_heaped *e)
{
    const struct dt_mesh *m = &f->set->mesh;
    if (!dt_facets_hold(f, e))
        return;
    for (uint32_t h = 8 * e->facet, end = h + 3; h < end; h++) {
        const uint32_t beyond = dt_twin(m, h);
        fetch_list(f, dt_base(beyond));
        fetch_vertex(f, dt_apex_of(m, beyond));
        fetch_facet(f, dt_base(dt_twin(m, dt_next(beyond))));
        fetch_facet(f, dt_base(dt_twin(m, dt_prev(beyond))));
    }
}

/* Drops the first entry, and fetches for those that follow. */
static void step(struct dt_facets *f)
{
    struct dt_heap *h = &f->heap;
    enum { SECOND = 4, THIRD = 1 };
    if (h->nexts > 0)
        dt_heap_drop(h);
    while (h->nexts < DT_HEAP_NEXT && dt_heap_advance(h, f->samples->v))
        fetch_first(f, &h->next[h->nexts - 1]);
    if (h->nexts > SECOND)
        fetch_second(f, &h->next[SECOND]);
    if (h->nexts > THIRD)
        fetch_third(f, &h->next[THIRD]);
}

uint32_t dt_facets_worst(struct dt_facets *f)
{
    const struct dt_heap *h = &f->heap;
    if (h->nexts == 0)
        step(f);
    while (h->nexts > 0 && !dt_facets_hold(f, &h->next[0]))
        step(f);
    return h->nexts > 0 ? h->next[0].facet : DT_NONE;
}
