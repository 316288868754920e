/* restore.c - a set from a list of its points, as it was when the list was made. */
#include "core/control/stop.h"
#include "core/edit/arrivals.h"
#include "core/set/set.h"

static enum dt_status enter_representatives(struct dt_points *p, const uint32_t *ids,
                                            const struct dt_point *xy,
                                            const uint32_t *representatives, size_t n,
                                            uint32_t next_id, struct dt_stop *stop)
{
    for (size_t i = 0; i < n && (i % DT_POLL_MISSES != 0 || !dt_stopped(stop)); i++) {
        if (ids[i] >= next_id || (i > 0 && ids[i] <= ids[i - 1]))
            return DT_CORRUPT;
        if (!dt_coordinate_ok(xy[i].x) || !dt_coordinate_ok(xy[i].y))
            return DT_RANGE;
        if (dt_idmap_reserve(&p->value, ids[i], 1) != DT_OK)
            return DT_NOMEM;
        if (representatives[i] == ids[i])
            dt_points_enter(p, ids[i], (struct dt_point){xy[i].x + 0.0, xy[i].y + 0.0});
    }
    return dt_stop_status(stop);
}

/* Whether an alias of id at q can have the representative of vertex v. */
static bool may_join(const struct dt_points *p, uint32_t id, struct dt_point q, uint32_t v)
{
    return p->tol > 0 || (id > p->id[v] && p->xy[v].x == q.x && p->xy[v].y == q.y);
}

static enum dt_status join_aliases(struct dt_points *p, const uint32_t *ids,
                                   const struct dt_point *xy, const uint32_t *representatives,
                                   size_t n, struct dt_stop *stop)
{
    for (size_t i = 0; i < n && (i % DT_POLL_MISSES != 0 || !dt_stopped(stop)); i++) {
        if (representatives[i] == ids[i])
            continue;
        uint32_t v = dt_points_vertex(p, representatives[i]);
        if (v == DT_NONE || dt_points_is_alias(p, representatives[i]) ||
            !may_join(p, ids[i], xy[i], v))
            return DT_CORRUPT;
        if (dt_points_join(p, ids[i], (struct dt_point){xy[i].x + 0.0, xy[i].y + 0.0}, v) != DT_OK)
            return DT_NOMEM;
    }
    return dt_stop_status(stop);
}

enum dt_status dt_restore(struct dt *t, const uint32_t *ids, const struct dt_point *p,
                          const uint32_t *representatives, size_t n, uint32_t next_id,
                          const struct dt_options *opt)
{
    struct dt_stop stop = dt_stop_of(opt);
    if (t->points.next_id != 0)
        return DT_CORRUPT;
    enum dt_status status = dt_points_reserve(&t->points, n, NULL);
    if (status == DT_OK)
        status = enter_representatives(&t->points, ids, p, representatives, n, next_id, &stop);
    if (status == DT_OK)
        status = dt_arrivals_sort(&t->points, opt);
    if (status == DT_OK)
        status = join_aliases(&t->points, ids, p, representatives, n, &stop);
    if (status == DT_OK)
        t->points.next_id = next_id;
    else
        dt_points_clear(&t->points);
    return status;
}

uint32_t dt_next_id(const struct dt *t)
{
    return t->points.next_id;
}
