/* constrain_order.c - makes many constraints edges, about in the order of memory. */
#include <string.h>

#include "core/edit/constrain.h"
#include "core/memory/memory.h"

enum { BUCKETS = 4096 };

/* A row and the vertices of its ends. */
struct way {
    uint32_t a, b, row;
};

/* Lists the live rows from `from` on. Returns how many. */
static size_t list_ways(const struct dt *t, uint32_t from, struct way *way)
{
    const struct dt_declared *d = &t->constraints->declared;
    const struct dt_points *p = &t->points;
    size_t n = 0;
    for (uint32_t i = from; i < d->end; i++) {
        if (i + DT_AHEAD < d->end && dt_declared_is_live(d, i + DT_AHEAD)) {
            dt_idmap_fetch(&p->value, d->row[i + DT_AHEAD].end[0]);
            dt_idmap_fetch(&p->value, d->row[i + DT_AHEAD].end[1]);
        }
        const uint32_t *end = d->row[i].end;
        if (dt_declared_is_live(d, i))
            way[n++] = (struct way){dt_points_vertex(p, end[0]), dt_points_vertex(p, end[1]), i};
    }
    return n;
}

/* Distributes them by a, that is, by places in the plane, among vertices below `end`. */
static void distribute(const struct way *way, size_t n, uint32_t end, struct way *out)
{
    uint32_t first[BUCKETS + 1], shift = 0;
    while (end >> shift >= BUCKETS)
        shift++;
    memset(first, 0, sizeof first);
    for (size_t i = 0; i < n; i++)
        first[(way[i].a >> shift) + 1]++;
    for (uint32_t k = 1; k <= BUCKETS; k++)
        first[k] += first[k - 1];
    for (size_t i = 0; i < n; i++)
        out[first[way[i].a >> shift]++] = way[i];
}

/* Fetches the data that way[i] and later ways will read, some steps before. */
static void fetch_ahead(const struct dt *t, const struct way *way, size_t i, size_t n)
{
    enum { STEP = 8 };
    const struct dt_mesh *m = &t->mesh;
    if (i + 2 * STEP < n) {
        dt_fetch(&m->leaving[way[i + 2 * STEP].a]);
        dt_fetch(&m->leaving[way[i + 2 * STEP].b]);
    }
    if (i + STEP < n) {
        dt_fetch(&m->half[m->leaving[way[i + STEP].a]]);
        dt_fetch(&m->half[m->leaving[way[i + STEP].b]]);
    }
}

static enum dt_status constrain_ways(struct dt *t, const struct way *way, size_t n, uint32_t *done,
                                     size_t *made, struct dt_stop *stop)
{
    enum dt_status status = DT_OK;
    for (*made = 0; *made < n && status == DT_OK; *made += status == DT_OK) {
        fetch_ahead(t, way, *made, n);
        status = dt_constrain_row(t, way[*made].row, way[*made].a, way[*made].b, stop);
        if (done != NULL)
            done[*made] = way[*made].row;
    }
    return status;
}

enum dt_status dt_constrain_in_order(struct dt *t, uint32_t from, uint32_t *done, size_t *made,
                                     struct dt_stop *stop)
{
    size_t n = t->constraints->declared.end - from;
    struct dt_pages *pages = t->points.pages;
    struct way *listed = dt_array_new_in(pages, n + 1, sizeof *listed);
    struct way *way = dt_array_new_in(pages, n + 1, sizeof *way);
    enum dt_status status = listed == NULL || way == NULL ? DT_NOMEM : DT_OK;
    *made = 0;
    if (status == DT_OK) {
        n = list_ways(t, from, listed);
        distribute(listed, n, t->points.end, way);
        status = constrain_ways(t, way, n, done, made, stop);
    }
    dt_array_free(listed);
    dt_array_free(way);
    return status;
}
