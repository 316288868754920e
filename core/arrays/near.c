/* near.c - the points near many places, aliases included. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/arrays/arrays.h"
#include "core/arrays/workers.h"
#include "core/memory/sort.h"
#include "core/query/nearest.h"
#include "core/query/prefetch.h"

/* Appends the aliases of a representative. */
static enum dt_status append_heirs(const struct dt_arrays *a, uint32_t id, struct dt_ids *out)
{
    enum dt_status s = DT_OK;
    if (a->heirs == NULL)
        return s;
    for (uint32_t i = a->first_heir[id]; i < a->first_heir[id + 1] && s == DT_OK; i++)
        s = dt_ids_append(out, a->heirs[i]);
    return s;
}

/* ---- the nearest ---- */

struct nearest {
    const struct dt_arrays *a;
    const struct dt_point *q;
    uint32_t k;
    uint32_t *id;
    double *distance;
};

/* The answer to question i, from the nearest representatives. */
static enum dt_status write_nearest(const struct nearest *n, size_t i, const struct dt_ids *found,
                                    struct dt_ids *all)
{
    uint32_t *id = n->id + i * n->k;
    double *distance = n->distance + i * n->k;
    enum dt_status s = DT_OK;
    all->n = 0;
    for (size_t j = 0; j < found->n && all->n < n->k && s == DT_OK; j++) {
        s = dt_ids_append(all, found->v[j]);
        if (s == DT_OK)
            s = append_heirs(n->a, found->v[j], all);
    }
    for (uint32_t j = 0; j < n->k; j++) {
        bool is_there = j < all->n;
        struct dt_point p = n->q[i];
        if (is_there)
            p = dt_points_xy(&n->a->t->points, all->v[j]);
        id[j] = is_there ? all->v[j] : DT_NONE;
        distance[j] = is_there ? hypot(p.x - n->q[i].x, p.y - n->q[i].y) : HUGE_VAL;
    }
    return s;
}

static enum dt_status nearest_piece(void *ctx, size_t from, size_t n)
{
    const struct nearest *all = ctx;
    struct dt_place place[DT_AHEAD];
    struct dt_stop work = dt_stop_of(NULL);
    struct dt_ids found = {0}, with_heirs = {0};
    enum dt_status s = DT_OK;
    for (size_t end = from + n, many; s == DT_OK && from < end; from += many) {
        many = end - from < DT_AHEAD ? end - from : DT_AHEAD;
        for (size_t i = 0; i < many; i++)
            place[i].at = all->q[from + i];
        dt_walk_to_places(all->a->t, place, many, DT_PLACE_READ);
        for (size_t i = 0; i < many && s == DT_OK; i++) {
            found.n = 0;
            s = dt_nearest_within_work(all->a->t, &place[i], all->k, &work, &found);
            if (s == DT_OK)
                s = write_nearest(all, from + i, &found, &with_heirs);
        }
    }
    free(found.v);
    free(with_heirs.v);
    return s;
}

enum dt_status dt_arrays_nearest(const struct dt_arrays *a, const struct dt_point *q, size_t n,
                                 uint32_t k, unsigned workers, uint32_t *id, double *distance)
{
    struct nearest all = {a, q, k, id, distance};
    fenv_t caller = dt_call_begin();
    enum dt_status s = DT_OK;
    if (n > 0 && !dt_coordinates_ok(&q->x, 2 * n))
        s = DT_RANGE;
    if (s == DT_OK)
        s = dt_answer_all(&(struct dt_pieces){nearest_piece, &all}, n, workers);
    dt_call_end(&caller);
    return s;
}

/* ---- within a distance ---- */

struct within {
    const struct dt_arrays *a;
    const struct dt_point *q;
    const double *r;
    struct dt_ids *found; /* owns; the answer to each question */
};

static enum dt_status append_all(const struct dt_arrays *a, struct dt_ids *out)
{
    uint32_t n = dt_next_id(a->t);
    enum dt_status s = dt_ids_reserve(out, n);
    for (uint32_t id = 0; id < n && s == DT_OK; id++)
        out->v[out->n++] = id;
    return s;
}

static enum dt_status append_within(const struct dt_arrays *a, struct dt_point q, double r,
                                    struct dt_ids *out)
{
    enum dt_status s = dt_within_disc(a->t, q, r, NULL, out);
    size_t representatives = out->n;
    for (size_t j = 0; j < representatives && s == DT_OK; j++)
        s = append_heirs(a, out->v[j], out);
    if (out->n > representatives)
        dt_sort_ids(out->v, out->n, NULL, NULL);
    return s;
}

static enum dt_status within_piece(void *ctx, size_t from, size_t n)
{
    const struct within *w = ctx;
    enum dt_status s = DT_OK;
    for (size_t i = from; i < from + n && s == DT_OK; i++) {
        struct dt_ids *out = &w->found[i];
        if (w->r[i] == HUGE_VAL)
            s = append_all(w->a, out);
        else if (w->r[i] >= 0 && dt_coordinate_ok(w->r[i]))
            s = append_within(w->a, w->q[i], w->r[i], out);
        else
            s = DT_RANGE;
    }
    return s;
}

/* Joins the answers to one array. */
static enum dt_status join(const struct dt_ids *found, size_t n, struct dt_ids *out, size_t *end)
{
    size_t total = 0;
    for (size_t i = 0; i < n; i++)
        end[i] = total += found[i].n;
    enum dt_status s = dt_ids_reserve(out, total);
    for (size_t i = 0; i < n && s == DT_OK; i++) {
        if (found[i].n > 0)
            memcpy(out->v + out->n, found[i].v, found[i].n * sizeof *out->v);
        out->n += found[i].n;
    }
    return s;
}

static enum dt_status within(const struct dt_arrays *a, const struct dt_point *q, const double *r,
                             size_t n, unsigned workers, struct dt_ids *out, size_t *end)
{
    struct within w = {a, q, r, calloc(n > 0 ? n : 1, sizeof *w.found)};
    if (w.found == NULL)
        return DT_NOMEM;
    enum dt_status s = dt_answer_all(&(struct dt_pieces){within_piece, &w}, n, workers);
    if (s == DT_OK)
        s = join(w.found, n, out, end);
    for (size_t i = 0; i < n; i++)
        free(w.found[i].v);
    free(w.found);
    return s;
}

enum dt_status dt_arrays_within(const struct dt_arrays *a, const struct dt_point *q,
                                const double *r, size_t n, unsigned workers, struct dt_ids *out,
                                size_t *end)
{
    fenv_t caller = dt_call_begin();
    enum dt_status s = DT_OK;
    if (n > 0 && !dt_coordinates_ok(&q->x, 2 * n))
        s = DT_RANGE;
    if (s == DT_OK)
        s = within(a, q, r, n, workers, out, end);
    dt_call_end(&caller);
    return s;
}
