/* tile.c - the life of a tile, and how foreign points arrive. */
#include "core/tiles/tile.h"

#include <stdlib.h>
#include <string.h>

#include "core/arrays/workers.h"
#include "core/edit/update.h"
#include "core/memory/memory.h"

void dt_tile_free(struct dt_tile *tile)
{
    if (tile == NULL)
        return;
    dt_pairs_clear(&tile->sent);
    free(tile->postponed.v);
    dt_array_free(tile->id);
    dt_free(tile->t);
    free(tile);
}

void dt_tile_counts(const struct dt_tile *tile, struct dt_tile_counts *out)
{
    struct dt_summary sum;
    dt_summary(tile->t, &sum);
    *out = (struct dt_tile_counts){tile->own, tile->points - tile->own, tile->coincident,
                                   sum.triangles, tile->postponed.n};
}

/* ---- own points ---- */

static bool is_ascending(const uint64_t *id, size_t n)
{
    size_t i = 1;
    while (i < n && id[i - 1] < id[i])
        i++;
    return i >= n;
}

static enum dt_status reserve_ids(struct dt_tile *tile, size_t n)
{
    size_t room = dt_array_room(tile->room, n, DT_MAX_POINTS);
    if (n <= tile->room)
        return DT_OK;
    if (n > DT_MAX_POINTS)
        return DT_TOOBIG;
    if (!dt_array_resize(NULL, &tile->id, tile->points, room, sizeof *tile->id))
        return DT_NOMEM;
    tile->room = room;
    return DT_OK;
}

/* The own points of a new tile. */
struct points {
    struct dt_tile *tile;
    const struct dt_point *p;
    const uint64_t *id;
    size_t n;
};

static enum dt_status begin(void *ctx, const struct dt_options *opt)
{
    const struct points *in = ctx;
    struct dt_tile *tile = in->tile;
    struct dt_added added;
    enum dt_status s = is_ascending(in->id, in->n) ? reserve_ids(tile, in->n) : DT_RANGE;
    if (s == DT_OK)
        s = dt_add_many(tile->t, in->p, in->n, opt, &added);
    if (s != DT_OK)
        return s;
    if (in->n > 0) {
        memcpy(tile->id, in->id, in->n * sizeof *in->id);
        tile->box = dt_box_of(in->p, (uint32_t)in->n);
    }
    tile->own = tile->points = (uint32_t)in->n;
    tile->coincident = added.coincident;
    return dt_triangulate(tile->t, opt);
}

enum dt_status dt_tile_new(const struct dt_point *p, const uint64_t *id, size_t n,
                           struct dt_pages *pages, unsigned workers, struct dt_tile **out)
{
    struct dt_tile *tile = calloc(1, sizeof *tile);
    struct points in = {tile, p, id, n};
    enum dt_status s =
        tile == NULL ? DT_NOMEM : dt_call_build(&tile->t, pages, workers, begin, &in);
    *out = s == DT_OK ? tile : NULL;
    if (s != DT_OK)
        dt_tile_free(tile);
    return s;
}

/* ---- foreign points ---- */

/* Records of the mesh may be of other faces now, so every face is judged again if some were postponed. */
static void forget_postponed(struct dt_tile *tile)
{
    if (tile->postponed.n > 0)
        tile->judged = 0;
    tile->postponed.n = 0;
}

enum dt_status dt_tile_refresh(struct dt_tile *tile)
{
    if (!dt_is_live(tile->t))
        forget_postponed(tile);
    return dt_refresh(tile->t, NULL);
}

/* A batch of foreign points: their local ids follow those that exist. */
struct arrivals {
    struct dt_point *p; /* owns `room` */
    uint64_t *id;       /* owns `room` */
    size_t n;
};

/* A small batch walks along the border of the tile. */
static enum dt_status add_to_set(struct dt *t, const struct arrivals *a, struct dt_added *added)
{
    if (!dt_is_live(t) || dt_is_large_batch(t, a->n))
        return dt_add_many(t, a->p, a->n, NULL, added);
    if (!dt_coordinates_ok(&a->p->x, 2 * a->n))
        return DT_RANGE;
    struct dt_stop work = dt_stop_of(NULL);
    dt_views_edit_begin(t);
    return dt_update_add_walking(t, a->p, a->n, &work, added);
}

/* Adds the batch to the set, where it becomes local ids. */
static enum dt_status add(struct dt_tile *tile, const struct arrivals *a, struct dt_added *added)
{
    enum dt_status s = reserve_ids(tile, tile->points + a->n);
    if (s == DT_OK)
        s = add_to_set(tile->t, a, added);
    if (s == DT_OK)
        memcpy(tile->id + tile->points, a->id, a->n * sizeof *a->id);
    return s;
}

/* Takes points out of the batch, which was added, that the tile had already, or that are twice in the batch. DT_RANGE: two ids are
 * at one place. */
static enum dt_status drop_known(const struct dt_tile *tile, struct arrivals *a)
{
    size_t kept = 0;
    for (uint32_t i = 0; i < a->n; i++) {
        uint32_t local = tile->points + i, first;
        dt_representative(tile->t, local, &first);
        if (first != local && tile->id[first] != tile->id[local])
            return DT_RANGE;
        if (first != local)
            continue;
        a->p[kept] = a->p[i];
        a->id[kept++] = a->id[i];
    }
    a->n = kept;
    return DT_OK;
}

/* If points are not new, the batch is taken back, and what is new is added. */
static enum dt_status add_new(struct dt_tile *tile, struct arrivals *a)
{
    struct dt_added added;
    enum dt_status s = add(tile, a, &added);
    if (s != DT_OK)
        forget_postponed(tile); /* points may have been taken out again */
    if (s == DT_OK && added.coincident > 0) {
        uint32_t all = (uint32_t)a->n;
        forget_postponed(tile);
        s = drop_known(tile, a);
        dt_take_back(tile->t, all);
        if (s == DT_OK)
            s = a->n == 0 ? DT_OK : add(tile, a, &added);
    }
    if (s == DT_OK)
        tile->points += (uint32_t)a->n;
    return s;
}

/* Whether one of the points has an own id and another place. */
static bool contradicts(const struct dt_tile *tile, const struct dt_point *p, const uint64_t *id,
                        size_t n)
{
    for (size_t i = 0; i < n && tile->own > 0; i++) {
        uint32_t lo = 0, hi = tile->own;
        while (hi - lo > 1) {
            uint32_t mid = lo + (hi - lo) / 2;
            if (tile->id[mid] <= id[i])
                lo = mid;
            else
                hi = mid;
        }
        struct dt_point at;
        if (tile->id[lo] == id[i] &&
            (dt_get(tile->t, lo, &at) != DT_OK || at.x != p[i].x || at.y != p[i].y))
            return true;
    }
    return false;
}

static enum dt_status insert(struct dt_tile *tile, const struct dt_point *p, const uint64_t *id,
                             size_t n)
{
    struct arrivals a = {dt_array_new(n, sizeof *a.p), dt_array_new(n, sizeof *a.id), n};
    enum dt_status s = a.p == NULL || a.id == NULL ? DT_NOMEM : DT_OK;
    if (s == DT_OK && contradicts(tile, p, id, n))
        s = DT_RANGE;
    if (s == DT_OK) {
        memcpy(a.p, p, n * sizeof *p);
        memcpy(a.id, id, n * sizeof *id);
        s = add_new(tile, &a);
    }
    dt_array_free(a.p);
    dt_array_free(a.id);
    enum dt_status current = dt_tile_refresh(tile);
    return s == DT_OK ? current : s;
}

enum dt_status dt_tile_insert(struct dt_tile *tile, const struct dt_point *p, const uint64_t *id,
                              size_t n)
{
    if (n == 0)
        return DT_OK;
    fenv_t caller = dt_call_begin();
    enum dt_status s = insert(tile, p, id, n);
    dt_call_end(&caller);
    return s;
}
