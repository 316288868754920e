/* trace.c - dt_trace: the paper's engine, run on a copy of a set's points before an observer.
 *
 * The engine reports places in its grid; here they become ids. A place has a point of the copy, this
 * point has a vertex of the set, and the vertex has an id. */
#include "core/delaunay.h"

#include "core/memory/memory.h"
#include "core/set/set.h"
#include "core/shelling/shelling.h"

struct trace {
    const struct dt_points *points;
    const struct dt_observer *observer;
    struct dt_point *in, *p; /* own; the copy, and what the engine makes of it */
    uint32_t *vertex, *from; /* own; of a point in the copy; by place, its index in the copy */
};

static uint32_t id_of(const struct trace *t, uint32_t place)
{
    return place == DT_NONE ? DT_NONE : t->points->id[t->vertex[t->from[place]]];
}

static void translate(void *ctx, const struct dt_event *e)
{
    const struct trace *t = ctx;
    struct dt_event seen = *e;
    if (e->kind != DT_EVENT_GRID) {
        seen.a = id_of(t, e->a);
        seen.b = id_of(t, e->b);
        seen.c = id_of(t, e->c);
    }
    t->observer->see(t->observer->ctx, &seen);
}

/* Copies the vertices in use; returns their number. */
static uint32_t copy_vertices(struct trace *t)
{
    uint32_t n = 0;
    for (uint32_t v = 0; v < t->points->end; v++) {
        if (t->points->id[v] == DT_NONE)
            continue;
        t->in[n] = t->points->xy[v];
        t->vertex[n++] = v;
    }
    return n;
}

enum dt_status dt_trace(const struct dt *t, const struct dt_options *opt,
                        const struct dt_observer *observer)
{
    uint32_t n = dt_points_vertices(&t->points);
    struct trace r = {.points = &t->points,
                      .observer = observer,
                      .in = dt_array_new(n, sizeof *r.in),
                      .p = dt_array_new(n, sizeof *r.p),
                      .vertex = dt_array_new(n, sizeof *r.vertex),
                      .from = dt_array_new(n, sizeof *r.from)};
    struct dt_mesh mesh = {0};
    enum dt_status status = DT_NOMEM;
    if (r.in != NULL && r.p != NULL && r.vertex != NULL && r.from != NULL)
        status = dt_shelling_observed(r.in, copy_vertices(&r), r.p, r.from, &mesh, opt,
                                      &(struct dt_observer){translate, &r});
    dt_mesh_clear(&mesh);
    dt_array_free(r.in);
    dt_array_free(r.p);
    dt_array_free(r.vertex);
    dt_array_free(r.from);
    return status;
}
