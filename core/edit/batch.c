/* batch.c - see batch.h. Insertions free no record, so a triangle that was found some turns ago still exists,
 * near the point. */
#include "core/edit/batch.h"

#include "core/divide/order.h"
#include "core/memory/memory.h"
#include "core/query/prefetch.h"

enum { SORTED = 16 }; /* batches of at least this number of points are sorted */

/* Counts the points in the cells and puts them into b->order. */
static void sort(struct dt_batch *b, const struct dt_order *grid, uint32_t *key, uint32_t *next,
                 struct dt_stop *stop)
{
    uint32_t cells = 1u << grid->bits, place = 0;
    for (uint32_t c = 0; c < cells; c++)
        next[c] = 0;
    for (struct dt_piece at = dt_pieces(0, b->n); dt_next_piece(stop, &at);)
        dt_order_count(grid, b->q + at.a, at.b - at.a, key + at.a, next);
    for (uint32_t c = 0; c < cells; c++) {
        uint32_t n = next[c];
        next[c] = place;
        place += n;
    }
    for (struct dt_piece at = dt_pieces(0, b->n); dt_next_piece(stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            b->order[next[key[i]]++] = i;
}

enum dt_status dt_batch_begin(struct dt_batch *b, const struct dt *t, const struct dt_point *q,
                              uint32_t n, struct dt_stop *stop)
{
    b->q = q;
    b->order = NULL;
    b->n = n;
    if (n < SORTED || t->points.tol > 0 || !t->current)
        return DT_OK;
    struct dt_arena arena = {0};
    struct dt_order grid;
    dt_order_plan(&grid, dt_box_of(q, n), n, q, n);
    enum dt_status status = dt_order_tables(&grid, &arena);
    uint32_t *key = dt_arena_take(&arena, n, sizeof *key);
    uint32_t *next =
        status == DT_OK ? dt_arena_take(&arena, (size_t)1 << grid.bits, sizeof *next) : NULL;
    b->order = dt_array_new(n, sizeof *b->order);
    if (key != NULL && next != NULL && b->order != NULL) {
        sort(b, &grid, key, next, stop);
        status = dt_stop_status(stop);
    } else {
        status = DT_NOMEM;
    }
    if (status != DT_OK)
        dt_batch_end(b);
    dt_arena_clear(&arena);
    return status;
}

void dt_batch_end(struct dt_batch *b)
{
    dt_array_free(b->order);
    b->order = NULL;
}

/* Looks for the points from turn i on side by side. */
static void look_ahead(struct dt *t, struct dt_batch *b, uint32_t i)
{
    struct dt_place place[DT_AHEAD];
    uint32_t n = b->n - i < DT_AHEAD ? b->n - i : DT_AHEAD;
    for (uint32_t k = 0; k < n; k++)
        dt_fetch(&b->q[dt_batch_index(b, i + k)]);
    for (uint32_t k = 0; k < n; k++) {
        place[k].at = b->q[dt_batch_index(b, i + k)];
        dt_idmap_fetch(&t->points.value, t->points.next_id + dt_batch_index(b, i + k));
    }
    dt_walk_to_places(t, place, n, DT_PLACE_INSERT);
    for (uint32_t k = 0; k < n; k++) {
        b->near[k] = place[k].near;
        if (place[k].near != DT_NONE)
            dt_fetch_around(t, place[k].near);
    }
}

uint32_t dt_batch_turn(struct dt *t, struct dt_batch *b, uint32_t i)
{
    if (!t->current)
        dt_places_fetch(&t->points.places, t->points.xy, b->q + i, b->n - i);
    if (b->n == 1 || !t->current)
        return DT_NONE;
    if (i % DT_AHEAD == 0)
        look_ahead(t, b, i);
    return b->near[i % DT_AHEAD];
}
