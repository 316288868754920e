/* within_disc.c - the points in a closed disc: from a vertex nearest to its centre on, along edges
 * (nearest.h); where the disc turns out to hold a large share of the set, a scan of all vertices. */
#include "core/control/work.h"
#include "core/query/nearest.h"
#include "core/query/query.h"
#include "core/query/visited.h"
#include "core/set/reader.h"

static bool in_disc(const struct dt *t, uint32_t v, struct dt_point centre, double r)
{
    return dt_compare_radius(t->points.xy[v], centre, r) <= 0;
}

static enum dt_status scan_disc(const struct dt *t, struct dt_point centre, double r,
                                struct dt_work *work, struct dt_ids *out)
{
    enum dt_status st = DT_OK;
    for (uint32_t v = 0; v < t->points.end && st == DT_OK; v++) {
        if (t->points.id[v] != DT_NONE && in_disc(t, v, centre, r))
            st = dt_ids_append(out, v);
        if (st == DT_OK && (v & DT_WORK_MASK) == 0)
            st = dt_work(work, DT_WORK_BLOCK);
    }
    return st;
}

/* Appends all vertices within r of the centre that can be reached from the one at out->v[n], until
 * a scan pays. */
static enum dt_status flood_disc(const struct dt *t, struct dt_point centre, double r,
                                 struct dt_visited *seen, size_t n, struct dt_work *work,
                                 struct dt_ids *out)
{
    const struct dt_mesh *m = &t->mesh;
    for (size_t i = n; i < out->n && m->vertices > 1 && !dt_scan_pays(t, out->n - n); i++) {
        uint32_t first = m->leaving[out->v[i]], h = first;
        if (i + 1 < out->n)
            dt_fetch(&m->half[m->leaving[out->v[i + 1]]]);
        do {
            uint32_t w = dt_dest(m, h);
            dt_fetch_beyond_star(m, h);
            bool fresh = false;
            enum dt_status st = dt_work(work, 1);
            if (st == DT_OK && w != DT_NONE && in_disc(t, w, centre, r))
                st = dt_visited_add(seen, w, &fresh);
            if (st == DT_OK && fresh) {
                dt_fetch(&m->leaving[w]);
                st = dt_ids_append(out, w);
            }
            if (st != DT_OK)
                return st;
            h = dt_turn_ccw(m, h);
        } while (h != first);
    }
    return DT_OK;
}

enum dt_status dt_within_disc(const struct dt *t, struct dt_point centre, double r,
                              const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_work work = dt_work_of(opt);
    enum dt_status st = dt_readable(t);
    if (st != DT_OK || t->mesh.vertices == 0)
        return st;
    bool tie;
    uint32_t v = DT_NONE;
    st = dt_nearest_vertex(t, &(struct dt_place){centre, DT_NONE}, &work, &v, &tie);
    if (st != DT_OK || !in_disc(t, v, centre, r))
        return st;
    struct dt_visited seen;
    bool fresh;
    size_t n = out->n;
    dt_visited_init(&seen);
    st = dt_visited_add(&seen, v, &fresh);
    if (st == DT_OK)
        st = dt_ids_append(out, v);
    if (st == DT_OK)
        st = flood_disc(t, centre, r, &seen, n, &work, out);
    dt_visited_clear(&seen);
    if (st == DT_OK && dt_scan_pays(t, out->n - n)) {
        out->n = n;
        st = scan_disc(t, centre, r, &work, out);
    }
    if (st == DT_OK)
        dt_vertices_to_ids(t, out, n);
    else
        out->n = n;
    return st;
}
