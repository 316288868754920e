/* surface.c - see surface.h. */
#include "server/replies/surface.h"

#include "server/rows/answer_rows.h"

#include <stdlib.h>

enum { IDS_AT_ONCE = 1 << 20 }; /* ids; their pages are looked at */

void surface_clear(struct surface *q)
{
    dt_pages_release(q->places.p);
    dt_pages_release(q->places.kept);
    if (q->places.memory.bytes > 0)
        reservation_set(&q->places.memory, 0);
    free(q->level);
    q->places.p = NULL;
    q->places.kept = NULL;
    q->level = NULL;
}

void surface_answer_values(struct server *s, struct answer *a, const struct surface_moment *m,
                           struct surface *q)
{
    struct version *v = m->version;
    bool raster = q->kind == SURFACE_RASTER;
    size_t columns = raster ? q->raster.columns : 1,
           n = raster ? columns * q->raster.rows : q->places.n;
    struct rows rows = {.version = v,
                        .view = m->view,
                        .form = ROW_SURFACE,
                        .heavy = dt_next_id(v->dt) > IDS_AT_ONCE,
                        .surface = {.dt = v->dt,
                                    .field = q->fields,
                                    .fields = q->n_fields,
                                    .how = q->how,
                                    .max_edge = q->max_edge,
                                    .inside = q->inside,
                                    .beyond = q->beyond,
                                    .quantity = q->quantity,
                                    .place = q->places.p,
                                    .kept = q->places.kept,
                                    .raster = q->raster,
                                    .columns = columns,
                                    .binary = q->binary,
                                    .end = n}};
    size_t numbers =
        q->n_fields * dt_surface_numbers(&(struct dt_surface){.quantity = q->quantity});
    reply_ok(a->out, q->binary ? 0 : n / columns);
    if (q->binary)
        reply_key_u64(a->out, "rows", n / columns);
    if (raster)
        reply_key_u64(a->out, "columns", columns);
    if (q->n_fields > 1)
        reply_key_u64(a->out, "fields", q->n_fields);
    if (q->binary)
        reply_key_u64(a->out, "bytes", (uint64_t)n * numbers * sizeof(double));
    reply_end(a->out);
    answer_places(s, a, &rows, &q->places);
    q->places = (struct places){0};
}

void surface_answer(struct server *s, struct answer *a, struct version *v, struct surface *q)
{
    struct surface_moment now = {.version = v};
    surface_answer_values(s, a, &now, q);
}
