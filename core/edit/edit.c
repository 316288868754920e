/* edit.c - adds, deletes and moves points: checks the arguments, and chooses whether the triangulation changes with
 * the points (update.h) or is rebuilt later. */
#include "core/delaunay.h"

#include <math.h>
#include <string.h>

#include "core/control/parallel.h"
#include "core/control/stop.h"
#include "core/edit/arrivals.h"
#include "core/edit/constrain.h"
#include "core/edit/update.h"
#include "core/exact/bounds.h"
#include "core/exact/lanes.h"
#include "core/hints/hints.h"
#include "core/memory/memory.h"
#include "core/memory/sort.h"

bool dt_coordinate_ok(double v)
{
    double size = fabs(v);
    return size == 0 || (size >= DT_COORDINATE_LEAST && size <= DT_COORDINATE_MOST);
}

/* Two at a time: |v|, moved into the range, differs from |v|, and that is not 0. A NaN is moved to the range's end. */
bool dt_coordinates_ok(const double *v, size_t n)
{
    const dt_lanes least = dt_lanes_both(DT_COORDINATE_LEAST);
    const dt_lanes most = dt_lanes_both(DT_COORDINATE_MOST);
    dt_lanes_holds wrong = {0, 0};
    size_t i = 0;
    for (; i + 2 <= n; i += 2) {
        dt_lanes size = dt_lanes_abs(dt_lanes_load(v + i));
        dt_lanes moved = dt_lanes_most(dt_lanes_least(size, most), least);
        wrong |= ((dt_lanes_holds)moved ^ (dt_lanes_holds)size) & (size != dt_lanes_both(0));
    }
    return (wrong[0] | wrong[1]) == 0 && (i == n || dt_coordinate_ok(v[i]));
}

static bool point_ok(struct dt_point p)
{
    return dt_coordinate_ok(p.x) && dt_coordinate_ok(p.y);
}

enum dt_status dt_add(struct dt *t, const struct dt_point *p, size_t n, struct dt_added *out)
{
    return dt_add_many(t, p, n, NULL, out);
}

/* Points whose coordinates are checked, a piece of DT_POLL points after the other. */
struct check {
    const struct dt_point *p;
    size_t n;
    unsigned slices; /* slice i has every piece whose number is i modulo their number */
    struct dt_stop stop;
};

static void check_slice(void *arg, unsigned i)
{
    struct check *c = arg;
    for (size_t at = (size_t)i * DT_POLL; at < c->n; at += (size_t)c->slices * DT_POLL) {
        size_t piece = c->n - at < DT_POLL ? c->n - at : DT_POLL;
        if (!dt_coordinates_ok(&c->p[at].x, 2 * piece))
            dt_stop_because(&c->stop, DT_RANGE);
        if (piece == DT_POLL && dt_stopped(&c->stop))
            return;
    }
}

/* DT_RANGE: one of the points is invalid. */
static enum dt_status check_points(const struct dt_point *p, size_t n, const struct dt_options *opt)
{
    if (n == 1)
        return point_ok(*p) ? DT_OK : DT_RANGE;
    struct check c = {.p = p, .n = n, .stop = dt_stop_of(opt)};
    const struct dt_pool *pool = opt == NULL ? NULL : opt->pool;
    c.slices = n > DT_MAX_POINTS ? 1 : dt_threads_for(pool, (uint32_t)n);
    dt_run(pool, c.slices, check_slice, &c);
    return dt_stop_status(&c.stop);
}

enum dt_status dt_add_many(struct dt *t, const struct dt_point *p, size_t n,
                           const struct dt_options *opt, struct dt_added *out)
{
    dt_views_edit_begin(t);
    return dt_update_add_many(t, p, n, opt, out);
}

/* Leaves the mesh of a live set to a rebuild if n edits are many; returns whether it was live. */
static bool set_mesh_aside(struct dt *t, size_t n)
{
    bool live = t->current;
    t->current = live && !dt_is_large_batch(t, n);
    return live && !t->current;
}

enum dt_status dt_update_add_many(struct dt *t, const struct dt_point *p, size_t n,
                                  const struct dt_options *opt, struct dt_added *out)
{
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status status = check_points(p, n, opt);
    if (status != DT_OK)
        return status;
    bool aside = set_mesh_aside(t, n);
    if (!t->current && dt_arrivals_suit(&t->points, n))
        status = dt_arrivals_add(&t->points, p, n, opt, out);
    else
        status = dt_update_add(t, p, n, &work, out);
    if (aside && status != DT_OK)
        t->current = true;
    return status;
}

static bool are_aliases(const struct dt_points *p, const uint32_t *ids, size_t n)
{
    size_t i = 0;
    while (i < n && dt_points_is_alias(p, ids[i]))
        i++;
    return i == n;
}

/* Deletes ascending distinct live ids. */
static enum dt_status delete_sorted(struct dt *t, uint32_t *ids, size_t n,
                                    const struct dt_options *opt)
{
    struct dt_stop work = dt_stop_of(opt);
    dt_views_edit_begin(t);
    enum dt_status status = dt_fields_take_ready(&t->fields, ids, n, &work);
    if (status != DT_OK)
        return status;
    bool constrained = dt_is_constrained(t) && t->triangulated;
    bool aside = !constrained && !are_aliases(&t->points, ids, n) && set_mesh_aside(t, n);
    if (constrained)
        status = dt_constrained_delete(t, ids, n, opt);
    else
        status = dt_update_delete(t, ids, n, &work, opt != NULL && opt->disposable);
    if (status == DT_OK)
        dt_fields_take(&t->fields, ids, n);
    else if (aside)
        t->current = true;
    return status;
}

enum dt_status dt_delete(struct dt *t, const uint32_t *ids, size_t n, uint32_t *deleted,
                         uint32_t *missing)
{
    return dt_delete_many(t, ids, n, NULL, deleted, missing);
}

enum dt_status dt_delete_many(struct dt *t, const uint32_t *ids, size_t n,
                              const struct dt_options *opt, uint32_t *deleted, uint32_t *missing)
{
    struct dt_stop stop = dt_stop_of(opt);
    for (size_t i = 0; i < n; i++) {
        uint32_t v = dt_points_vertex(&t->points, ids[i]);
        if (v == DT_NONE) {
            *missing = ids[i];
            return DT_NOPOINT;
        }
        if (dt_is_end(t, ids[i])) {
            *missing = ids[i];
            return DT_CONSTRAINED;
        }
        if (n == 1 && dt_is_live(t))
            dt_update_fetch(t, v);
        if (i % DT_POLL == DT_POLL - 1 && dt_stopped(&stop))
            return dt_stop_status(&stop);
    }
    uint32_t one = DT_NONE;
    uint32_t *sorted = n == 1 ? &one : dt_array_new_in(t->points.pages, n, sizeof *sorted);
    if (sorted == NULL)
        return DT_NOMEM;
    if (n > 0)
        memcpy(sorted, ids, n * sizeof *sorted);
    size_t distinct = dt_sort_unique(sorted, n, t->points.pages, &stop);
    enum dt_status status = dt_stop_status(&stop);
    if (status == DT_OK)
        status = delete_sorted(t, sorted, distinct, opt);
    if (sorted != &one)
        dt_array_free(sorted);
    if (status == DT_OK)
        *deleted = (uint32_t)distinct;
    return status;
}

enum dt_status dt_move(struct dt *t, uint32_t id, struct dt_point to)
{
    return dt_move_to(t, id, to, NULL);
}

enum dt_status dt_move_to(struct dt *t, uint32_t id, struct dt_point to,
                          const struct dt_options *opt)
{
    struct dt_stop work = dt_stop_of(opt);
    dt_hint_fetch_cells(&t->hints, to);
    if (dt_points_vertex(&t->points, id) == DT_NONE)
        return DT_NOPOINT;
    if (!point_ok(to))
        return DT_RANGE;
    enum dt_status status = dt_work(&work, 1);
    if (status != DT_OK)
        return status;
    dt_views_edit_begin(t);
    if (dt_is_constrained(t) && t->triangulated)
        return dt_constrained_move(t, id, to, opt);
    return dt_update_move(t, id, to, &work);
}
