/* facets.c - see facets.h. */
#include "core/thinning/facets.h"

#include "core/exact/predicates.h"
#include "core/memory/memory.h"

#include <float.h>
#include <string.h>

void dt_facets_clear(struct dt_facets *f)
{
    dt_free(f->set);
    dt_array_free(f->xy);
    dt_array_free(f->z);
    dt_array_free(f->pool);
    dt_array_free(f->sample);
    dt_array_free(f->facet);
    dt_heap_clear(&f->heap);
    *f = (struct dt_facets){0};
}

static const struct dt_facet facet_empty = {.worst = DT_NONE};

/* ---- memory ---- */

static enum dt_status reserve_vertices(struct dt_facets *f, uint32_t n)
{
    if (n <= f->vertex_cap)
        return DT_OK;
    size_t cap = dt_array_room(f->vertex_cap, n, UINT32_MAX);
    if (!dt_array_resize(NULL, &f->xy, f->vertices, cap, sizeof *f->xy) ||
        !dt_array_resize(NULL, &f->z, f->vertices, cap, sizeof *f->z) ||
        !dt_array_resize(NULL, &f->sample, f->vertices, cap, sizeof *f->sample))
        return DT_NOMEM;
    f->vertex_cap = (uint32_t)cap;
    return DT_OK;
}

static enum dt_status reserve_facets(struct dt_facets *f, uint32_t cap)
{
    if (cap <= f->facet_cap)
        return DT_OK;
    if (!dt_array_resize(NULL, &f->facet, f->facet_cap, cap, sizeof *f->facet) ||
        dt_heap_reserve(&f->heap, DT_HEAP_FACTOR * (size_t)cap) != DT_OK)
        return DT_NOMEM;
    for (; f->facet_cap < cap; f->facet_cap++)
        f->facet[f->facet_cap] = facet_empty;
    return DT_OK;
}

enum dt_status dt_facets_reserve(struct dt_facets *f, uint32_t vertices)
{
    enum dt_status s = reserve_vertices(f, vertices);
    if (s == DT_OK)
        s = dt_mesh_make_room(&f->set->mesh, vertices - 1, 2);
    return s == DT_OK ? reserve_facets(f, f->set->mesh.tri_cap) : s;
}

size_t dt_facets_memory(uint32_t vertices)
{
    size_t of_vertex = sizeof(struct dt_point) + sizeof(double) + 2 * sizeof(uint32_t);
    size_t of_record =
        8 * sizeof(uint32_t) + sizeof(struct dt_facet) + DT_HEAP_FACTOR * sizeof(struct dt_heaped);
    return 3 *
           (dt_array_bytes(vertices, of_vertex) + dt_array_bytes(2 * (size_t)vertices, of_record)) /
           2;
}

/* ---- the pool ---- */

enum { HALF_FACTOR = 2 }; /* of the points: so each copy makes room for as many as there are */

size_t dt_facets_pool_memory(uint32_t n)
{
    return dt_array_bytes(2 * HALF_FACTOR * ((size_t)n + 1), sizeof(struct dt_rounded));
}

static void forget_gaps(struct dt_facets *f)
{
    for (int n = 0; n < DT_FACETS_GAPS; n++)
        f->gap[n] = DT_NONE;
}

enum dt_status dt_facets_pool(struct dt_facets *f, uint32_t n, struct dt_pages *pages)
{
    f->pool_room = HALF_FACTOR * ((size_t)n + 1);
    f->pool_limit = f->pool_room;
    forget_gaps(f);
    f->pool = dt_array_new_in(pages, 2 * f->pool_room, sizeof *f->pool);
    return f->pool == NULL ? DT_NOMEM : DT_OK;
}

/* Copies all lists into the other half, which gets room for n points more, at least. */
static void tidy_pool(struct dt_facets *f, size_t n)
{
    enum { LEAST = 1 << 15 };
    size_t to = f->pool_begin = f->pool_begin == 0 ? f->pool_room : 0;
    for (uint32_t i = 0; i < f->set->mesh.tri_end; i++) {
        struct dt_facet *facet = &f->facet[i];
        memcpy(f->pool + to, f->pool + facet->first, facet->n * sizeof *f->pool);
        facet->first = (uint32_t)to;
        to += facet->n;
    }
    f->pool_end = to;
    forget_gaps(f);
    const size_t more = n + LEAST + (to - f->pool_begin), end = f->pool_begin + f->pool_room;
    f->pool_limit = end - to < more ? end : to + more;
}

void dt_facets_make_room(struct dt_facets *f, size_t n)
{
    if (f->pool_end + n > f->pool_limit)
        tidy_pool(f, n);
}

uint32_t dt_facets_take(struct dt_facets *f, uint32_t n)
{
    uint32_t first = n < DT_FACETS_GAPS ? f->gap[n] : DT_NONE;
    if (first != DT_NONE) {
        f->gap[n] = f->pool[first].item;
    } else {
        first = (uint32_t)f->pool_end;
        f->pool_end += n;
    }
    return first;
}

static void leave_gap(struct dt_facets *f, const struct dt_facet *facet)
{
    if (facet->n == 0 || facet->n >= DT_FACETS_GAPS)
        return;
    f->pool[facet->first].item = f->gap[facet->n];
    f->gap[facet->n] = facet->first;
}

/* ---- facets ---- */

static struct dt_corner corner_of(const struct dt_facets *f, uint32_t half)
{
    uint32_t v = dt_origin(&f->set->mesh, half);
    return (struct dt_corner){f->xy[v], f->z[v]};
}

bool dt_is_facet(const struct dt_facets *f, uint32_t base)
{
    const struct dt_mesh *m = &f->set->mesh;
    if (!dt_is_ghost(m, base))
        return !dt_is_dead(m, base);
    return dt_mesh_is_line(m) &&
           dt_compare_xy(f->xy[dt_origin(m, base)], f->xy[dt_origin(m, base + 1)]) < 0;
}

struct dt_corners dt_facet_corners(const struct dt_facets *f, uint32_t base)
{
    struct dt_corner a = corner_of(f, base), b = corner_of(f, base + 1);
    if (dt_is_ghost(&f->set->mesh, base))
        return (struct dt_corners){a, b, b, true};
    struct dt_corner c = corner_of(f, base + 2);
    if (dt_compare_xy(a.at, b.at) < 0)
        return dt_compare_xy(a.at, c.at) < 0 ? (struct dt_corners){a, b, c, false}
                                             : (struct dt_corners){c, a, b, false};
    return dt_compare_xy(b.at, c.at) < 0 ? (struct dt_corners){b, c, a, false}
                                         : (struct dt_corners){c, a, b, false};
}

/* ---- the heap ---- */

/* Drops all entries that are not valid; so there are no more than facets. */
static void tidy_heap(struct dt_facets *f)
{
    size_t n = 0;
    for (size_t i = 0; i < f->heap.n; i++)
        if (dt_facets_hold(f, &f->heap.v[i]))
            f->heap.v[n++] = f->heap.v[i];
    dt_heap_pile(&f->heap, n);
}

static void forget(struct dt_facets *f, struct dt_facet *facet)
{
    f->items -= facet->n;
    f->settled -= facet->heaped ? 0 : facet->n;
    facet->heaped = false;
}

/* The facet, which has no entry of the heap yet, counts as it is now. */
static void note(struct dt_facets *f, uint32_t number)
{
    struct dt_facet *facet = &f->facet[number];
    const bool exceeds = facet->off > f->bound;
    f->items += facet->n;
    f->settled += exceeds ? 0 : facet->n;
    if (!exceeds)
        return;
    if (f->heap.n == f->heap.cap)
        tidy_heap(f);
    facet->heaped = true;
    dt_heap_push(&f->heap, f->samples->v, (struct dt_heaped){facet->off, number, facet->worst});
}

/* ---- worst points ---- */

bool dt_worst_is_less(const struct dt_sample *s, const struct dt_worst *w, uint32_t i)
{
    return w->point == DT_NONE || dt_compare_xy(s[i].at, s[w->point].at) < 0;
}

/* The ranges of all parts are looked at before any of their points. */
void dt_worst_add_block(struct dt_worst *w, const struct dt_samples *s, uint32_t item,
                        const struct dt_plane *p)
{
    uint32_t part = 0;
    dt_worst_raise(w, w->off);
    if (dt_block_off_range(dt_item_block(s, item), p).most < w->least)
        return;
    const uint32_t n = dt_item_parts(s, item, &part), end = part + n;
    if (dt_item_level(part) == 0) {
        for (; part < end; part++)
            dt_worst_add(w, s->v, part, dt_plane_off(p, &s->v[part]));
        return;
    }
    for (uint32_t i = part; i < end; i++)
        dt_worst_raise(w, dt_block_off_range(dt_item_block(s, i), p).least);
    for (; part < end; part++)
        dt_worst_add_block(w, s, part, p);
}

/* How far q is off as far as it counts: more than the bound if and only if it is. */
static double decide(const struct dt_corners *c, const struct dt_plane *p,
                     const struct dt_sample *q, double bound)
{
    double off = isinf(p->doubt) ? dt_plane_nearest_off(c, q) : dt_plane_off(p, q);
    if (!dt_plane_doubts(p, off, bound))
        return off;
    if (dt_plane_exceeds(c, q, bound))
        return off > bound ? fmin(off, DBL_MAX) : nextafter(bound, HUGE_VAL);
    return off > bound ? bound : off;
}

/* All points of a list, from which the worst one is chosen. */
struct choice {
    const struct dt_samples *s;
    struct dt_corners c;
    const struct dt_plane *p;
    double bound;
    double least; /* the worst point is off by at least that */
    struct dt_worst worst;
    uint32_t visited;     /* points, */
    struct dt_stop *stop; /* which end the choice early */
};

typedef void visit_point(struct choice *d, const struct dt_sample *q, uint32_t point);

static void raise_least(struct choice *d, const struct dt_sample *q, uint32_t point)
{
    d->least = fmax(d->least, dt_plane_off_range(&d->c, q).least);
}

/* The largest result of `decide` that doubles allow. */
static double most_off(const struct choice *d, const struct dt_sample *q)
{
    const bool rounded = !isinf(d->p->doubt);
    const double most = rounded ? dt_plane_off(d->p, q) : dt_plane_off_range(&d->c, q).most;
    const bool may_exceed = rounded ? dt_plane_doubts(d->p, most, d->bound) : most >= d->bound;
    return may_exceed ? fmax(most, nextafter(d->bound, HUGE_VAL)) : most;
}

/* Decides about a point unless it is off by less than another one, or at most as far as the worst one so far, and its place is not
 * less. */
static void decide_point(struct choice *d, const struct dt_sample *q, uint32_t point)
{
    const double most = most_off(d, q);
    if (!(most < fmin(fmax(d->least, d->worst.off), DBL_MAX)) &&
        (most != d->worst.off || dt_worst_is_less(d->s->v, &d->worst, point)))
        dt_worst_add(&d->worst, d->s->v, point, decide(&d->c, d->p, q, d->bound));
}

/* Visits the points of the item, except those of blocks whose points are all off by less than the worst one. That is at least within the
 * doubt of the bound. */
static void visit_item(struct choice *d, uint32_t item, visit_point *visit)
{
    enum { POLLED = 64 }; /* an exact decision takes some microseconds */
    const double least = d->bound - 2 * d->p->doubt;
    uint32_t part = 0, n = 0;
    if (dt_item_level(item) == 0) {
        if (++d->visited % POLLED != 0 || !dt_stopped(d->stop))
            visit(d, &d->s->v[item], item);
    } else if (!(dt_block_off_range(dt_item_block(d->s, item), d->p).most < least)) {
        n = dt_item_parts(d->s, item, &part);
    }
    for (uint32_t end = part + n; part < end && dt_stop_status(d->stop) == DT_OK; part++)
        visit_item(d, part, visit);
}

static void visit_list(struct choice *d, const struct dt_facets *f, const struct dt_facet *facet,
                       visit_point *visit)
{
    for (uint32_t k = 0; k < facet->n && dt_stop_status(d->stop) == DT_OK; k++)
        visit_item(d, f->pool[facet->first + k].item, visit);
}

static enum dt_status decide_list(const struct dt_facets *f, uint32_t base,
                                  const struct dt_plane *p, struct dt_facet *facet,
                                  struct dt_stop *stop)
{
    struct choice d = {.s = f->samples,
                       .c = dt_facet_corners(f, base),
                       .p = p,
                       .bound = f->bound,
                       .worst = dt_worst_none,
                       .stop = stop};
    if (isinf(p->doubt))
        visit_list(&d, f, facet, raise_least);
    visit_list(&d, f, facet, decide_point);
    facet->worst = d.worst.point;
    facet->off = d.worst.off;
    return dt_stop_status(stop);
}

enum dt_status dt_facet_set(struct dt_facets *f, uint32_t base, const struct dt_plane *p,
                            struct dt_facet facet, struct dt_stop *stop)
{
    enum dt_status status = DT_OK;
    if (facet.n > 0 && dt_plane_doubts(p, facet.off, f->bound))
        status = decide_list(f, base, p, &facet, stop);
    if (status != DT_OK)
        return status;
    forget(f, &f->facet[base / 8]);
    f->facet[base / 8] = facet;
    note(f, base / 8);
    return DT_OK;
}

void dt_facet_empty(struct dt_facets *f, uint32_t base)
{
    forget(f, &f->facet[base / 8]);
    leave_gap(f, &f->facet[base / 8]);
    f->facet[base / 8] = facet_empty;
}
