/* thin.c - the greedy loop: the worst point of all becomes a vertex, until there is none that is too far off. */
#include "core/memory/memory.h"
#include "core/memory/sort.h"
#include "core/thinning/initial_points.h"
#include "core/thinning/share.h"

#include <math.h>
#include <string.h>

struct thin {
    const struct dt_thinning *in;
    const struct dt_options *opt;
    struct dt_stop stop;
    struct dt_samples samples;
    struct dt_facets facets;
    struct dt_share share;
    size_t fixed_memory; /* reserved beside the facets */
};

/* ---- memory ---- */

static enum dt_status reserve(struct thin *t, uint32_t vertices)
{
    const struct dt_thinning *in = t->in;
    return in->reserve == NULL ? DT_OK
                               : in->reserve(in->ctx, t->fixed_memory + dt_facets_memory(vertices));
}

/* What the samples, the points that stay and their constraints take. */
static size_t fixed_memory(const struct dt_thinning *in)
{
    enum { OF_POINT = 16 + 8 * 4 + 16, OF_CONSTRAINT = 256 };
    return dt_samples_memory(in->n) + dt_facets_pool_memory(in->n) + (size_t)OF_POINT * in->n +
           OF_CONSTRAINT * in->constraints;
}

/* Room for one more vertex. */
static enum dt_status make_room(struct thin *t)
{
    struct dt_facets *f = &t->facets;
    if (f->vertices < f->vertex_cap && f->set->mesh.tri_end + 2 <= f->facet_cap &&
        f->facet_cap >= f->set->mesh.tri_cap)
        return DT_OK;
    enum dt_status status = reserve(t, f->vertices + f->vertices / 2 + 64);
    return status == DT_OK ? dt_facets_reserve(f, f->vertices + 1) : status;
}

/* ---- the beginning ---- */

/* The facets get the points of the set that was made, whose vertices have other numbers than its ids. */
static enum dt_status take_first(struct thin *t, const uint32_t *sample)
{
    struct dt_facets *f = &t->facets;
    const struct dt_points *p = &f->set->points;
    enum dt_status status = reserve(t, p->end + 64);
    if (status == DT_OK && p->end > 0)
        status = dt_facets_reserve(f, p->end);
    if (status != DT_OK || p->end == 0)
        return status;
    memcpy(f->xy, p->xy, p->end * sizeof *f->xy);
    for (uint32_t v = 0; v < p->end; v++) {
        f->sample[v] = sample[p->id[v]];
        f->z[v] = t->samples.v[f->sample[v]].z;
    }
    f->vertices = p->end;
    return DT_OK;
}

static enum dt_status share_first(struct thin *t)
{
    const struct dt_facets *f = &t->facets;
    bool *kept = dt_array_new(t->samples.n, sizeof *kept);
    if (kept == NULL)
        return DT_NOMEM;
    if (t->samples.n > 0)
        memset(kept, 0, t->samples.n * sizeof *kept);
    for (uint32_t v = 0; v < f->vertices; v++)
        kept[f->sample[v]] = true;
    enum dt_status status = dt_facets_pool(&t->facets, t->samples.n, t->in->pages);
    if (status == DT_OK)
        status = dt_share_all(&t->facets, kept, t->in->pages, &t->stop);
    dt_array_free(kept);
    return status;
}

static enum dt_status begin(struct thin *t, struct dt_thinned *out)
{
    uint32_t *sample = NULL;
    struct dt_facets *f = &t->facets;
    t->fixed_memory = fixed_memory(t->in);
    enum dt_status status = reserve(t, 64);
    if (status == DT_OK)
        status = dt_samples_init(&t->samples, t->in, &t->stop);
    f->samples = &t->samples;
    f->bound = t->in->error;
    dt_heap_pile(&f->heap, 0);
    if (status == DT_OK)
        status = dt_initial_points(&t->samples, t->in, t->opt, &f->set, &sample);
    if (status == DT_OK)
        status = take_first(t, sample);
    dt_array_free(sample);
    out->least = f->vertices;
    if (status == DT_OK && out->least > t->in->most)
        status = DT_TOOBIG;
    return status == DT_OK ? share_first(t) : status;
}

/* ---- the loop ---- */

static void report(const struct thin *t)
{
    if (t->opt != NULL && t->opt->progress != NULL && t->samples.n > 0)
        atomic_store(
            t->opt->progress,
            (unsigned)((uint64_t)(t->facets.settled + t->facets.vertices) * 100 / t->samples.n));
}

static enum dt_status refine(struct thin *t)
{
    struct dt_facets *f = &t->facets;
    enum dt_status status = DT_OK;
    for (uint32_t worst;
         status == DT_OK && f->vertices < t->in->most && (worst = dt_facets_worst(f)) != DT_NONE;) {
        status = make_room(t);
        if (status == DT_OK)
            status = dt_share_insert(f, &t->share, worst, &t->stop);
        if (f->vertices % 1024 == 0)
            report(t);
    }
    return status;
}

/* ---- the end ---- */

static double largest_error(const struct dt_facets *f)
{
    double off = 0;
    for (uint32_t i = 0; i < f->facet_cap; i++)
        off = fmax(off, f->facet[i].off);
    return off;
}

static enum dt_status finish(struct thin *t, struct dt_thinned *out)
{
    struct dt_facets *f = &t->facets;
    struct dt_stop stop = dt_stop_of(t->opt);
    out->kept = dt_array_new(f->vertices, sizeof *out->kept);
    if (out->kept == NULL)
        return DT_NOMEM;
    for (uint32_t v = 0; v < f->vertices; v++)
        out->kept[v] = (uint32_t)t->samples.v[f->sample[v]].index;
    dt_sort_ids(out->kept, f->vertices, NULL, &stop);
    out->n = f->vertices;
    out->error = largest_error(f);
    return dt_stop_status(&stop);
}

enum dt_status dt_thin(const struct dt_thinning *in, const struct dt_options *opt,
                       struct dt_thinned *out)
{
    struct thin t = {.in = in, .opt = opt, .stop = dt_stop_of(opt)};
    *out = (struct dt_thinned){0};
    enum dt_status status = begin(&t, out);
    if (status == DT_OK)
        status = refine(&t);
    if (status == DT_OK)
        status = finish(&t, out);
    if (status != DT_OK) {
        dt_array_free(out->kept);
        out->kept = NULL;
    }
    dt_share_clear(&t.share);
    dt_facets_clear(&t.facets);
    dt_samples_clear(&t.samples);
    return status;
}
