/* alpha.c - the boundary of the regularised alpha shape, the triangles whose circumradius is at most r [Edelsbrunner,
 * Kirkpatrick & Seidel, "On the shape of a set of points in the plane", 1983].
 *
 * A triangle is in or out by an exact sign. Around a point, the triangles that are in form fans:
 *
 *             b           in: v a x, v x b. The boundary comes from a and goes on to b, with the shape on its
 *         out | in        left. Each fan that is not the whole star gives such a turn; all of them together are
 *        ---- v --- x     the boundary.
 *         out | in
 *             a
 *
 * So stars are read one by one, at one moment, and only turns are kept. Then each turn finds the next one by its edge.
 * Fans may touch in a point. Then the boundary passes the point several times, and is cut at it into simple loops. These
 * loops do not depend on the start of the walk, because a boundary does not cross itself. */
#include "core/control/stop.h"
#include "core/delaunay_surface.h"
#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/set/set.h"
#include "core/set/view_rows.h"
#include "core/set/view_stars.h"

#include <stdlib.h>
#include <string.h>

/* The boundary comes from `from` to `at` and goes on to `to`. */
struct turn {
    uint32_t at, from, to;
    uint32_t first;        /* turn at the same point, once they are sorted */
    struct dt_point place; /* of `at` */
};

struct neighbour {
    struct dt_point at;
    bool in; /* the triangle of it and the next one */
};

struct loop {
    const uint32_t *id; /* borrows n, from the least on */
    uint32_t n;
    bool hole;
};

struct dt_alpha {
    const struct dt_view *view; /* borrows; NULL: now */
    double radius;
    uint32_t id, end;  /* the next point, and the end of the ids */
    struct turn *turn; /* owns `turn_cap` */
    size_t turns, turn_cap;
    uint32_t *loop_id; /* owns: the ids of one loop after the other, as many as there are turns */
    size_t loop_ids;
    struct loop *loop; /* owns */
    size_t loops;
    struct neighbour *ring; /* owns ring_cap */
    uint32_t ring_cap;
    struct dt_neighbours around; /* owns: a ring that is longer than usual */
};

void dt_alpha_free(struct dt_alpha *a)
{
    if (a == NULL)
        return;
    free(a->turn);
    free(a->loop_id);
    free(a->loop);
    free(a->ring);
    free(a->around.ring.v);
    free(a);
}

enum dt_status dt_alpha_begin(const struct dt *t, const struct dt_view *v, double radius,
                              struct dt_alpha **out)
{
    enum dt_status s = dt_view_readable_delaunay(t, v);
    *out = NULL;
    if (s != DT_OK)
        return s;
    struct dt_alpha *a = calloc(1, sizeof *a);
    if (a == NULL)
        return DT_NOMEM;
    a->view = v;
    a->radius = radius;
    a->end = v == NULL ? DT_NONE : dt_view_next_id(v);
    *out = a;
    return DT_OK;
}

/* ---- turns ---- */

static bool reserve_ring(struct dt_alpha *a, uint32_t degree)
{
    if (degree <= a->ring_cap)
        return true;
    uint32_t cap = degree < 64 ? 64 : degree + degree / 2;
    free(a->ring);
    a->ring = malloc(cap * sizeof *a->ring);
    a->ring_cap = a->ring != NULL ? cap : 0;
    return a->ring != NULL;
}

/* The turns at a point with this ring: of each fan from its first edge, ccw, to its last one. */
static enum dt_status put_turns(struct dt_alpha *a, uint32_t at, struct dt_point q,
                                const uint32_t *ring, uint32_t n)
{
    enum dt_status s = DT_OK;
    for (uint32_t i = 0; i < n && s == DT_OK; i++) {
        if (!a->ring[i].in || a->ring[i == 0 ? n - 1 : i - 1].in)
            continue;
        uint32_t k = i;
        while (a->ring[k].in)
            k = k + 1 < n ? k + 1 : 0;
        s = dt_items_append(&a->turn, &a->turns, &a->turn_cap,
                            &(struct turn){at, ring[k], ring[i], 0, q}, sizeof *a->turn);
    }
    return s;
}

static enum dt_status take_star(struct dt_alpha *a, const struct dt *t, const struct dt_view *v,
                                const struct dt_stars *s, uint32_t i)
{
    uint32_t n = s->degree[i], id = s->id[i];
    const uint32_t *ring = s->ring[i];
    bool on_hull = s->on_hull[i];
    if (n == DT_NONE) {
        if (dt_neighbours_read(t, v, id, &a->around) != DT_OK)
            return DT_NOMEM;
        n = (uint32_t)a->around.ring.n;
        ring = a->around.ring.v;
        on_hull = a->around.on_hull;
    }
    if (!reserve_ring(a, n))
        return DT_NOMEM;
    struct dt_point q = dt_view_place(t, v, id);
    for (uint32_t k = 0; k < n; k++)
        a->ring[k].at = dt_view_place(t, v, ring[k]);
    for (uint32_t k = 0; k < n; k++) {
        uint32_t next = k + 1 < n ? k + 1 : 0;
        a->ring[k].in = !(on_hull && next == 0) &&
                        dt_compare_circumradius(q, a->ring[k].at, a->ring[next].at, a->radius) <= 0;
    }
    return put_turns(a, id, q, ring, n);
}

enum dt_status dt_alpha_read(const struct dt *t, struct dt_alpha *a, uint32_t points, bool *done)
{
    const struct dt_view *v = dt_view_if_changed(t, a->view);
    struct dt_stars stars;
    enum dt_status s = dt_view_readable(t, a->view, true);
    bool line = a->view != NULL ? a->view->line : dt_mesh_is_line(&t->mesh);
    *done = line;
    for (uint32_t n = 0; s == DT_OK && !*done && n < points; n += stars.n) {
        dt_stars_read(t, v, a->id, a->end, DT_STARS, &stars);
        *done = stars.n == 0;
        for (uint32_t i = 0; i < stars.n && s == DT_OK; i++) {
            s = take_star(a, t, v, &stars, i);
            a->id = stars.id[i] + 1;
        }
    }
    return s;
}

size_t dt_alpha_memory(const struct dt_alpha *a, uint32_t points)
{
    /* Turns that grow by half, with the copy that growing makes; paths, loops and rows of `points` points. */
    size_t most = a->turns + 3 * (size_t)points;
    return most * (3 * sizeof(struct turn) + 8 * sizeof(uint32_t) + sizeof(struct loop)) +
           a->ring_cap * sizeof *a->ring;
}

/* ---- loops ---- */

static int compare_turns(const void *p, const void *q)
{
    const struct turn *a = p, *b = q;
    if (a->at != b->at)
        return a->at < b->at ? -1 : 1;
    return (a->from > b->from) - (a->from < b->from);
}

/* The turn that follows a turn. Turns are sorted, and the one that follows exists. */
static size_t next_turn(const struct dt_alpha *a, size_t i)
{
    const struct turn key = {.at = a->turn[i].to, .from = a->turn[i].at};
    const struct turn *found = bsearch(&key, a->turn, a->turns, sizeof key, compare_turns);
    return (size_t)(found - a->turn);
}

/* A walk along the boundary: the points since it began that are in no loop yet, each by its first turn. All own a word or
 * a byte for each turn. */
struct path {
    uint32_t *point;
    uint32_t *on; /* where in `point` a point is; DT_NONE: nowhere */
    bool *taken;  /* turns */
    uint32_t n;
};

static void path_clear(struct path *p)
{
    free(p->point);
    free(p->on);
    free(p->taken);
}

static bool path_init(struct path *p, struct dt_alpha *a)
{
    size_t n = a->turns + 1;
    *p = (struct path){malloc(n * sizeof *p->point), malloc(n * sizeof *p->on),
                       calloc(n, sizeof *p->taken), 0};
    if (p->point == NULL || p->on == NULL || p->taken == NULL)
        return false;
    memset(p->on, 0xff, n * sizeof *p->on);
    for (uint32_t i = 0; i < a->turns; i++)
        a->turn[i].first = i > 0 && a->turn[i].at == a->turn[i - 1].at ? a->turn[i - 1].first : i;
    return true;
}

/* Whether the loop goes round clockwise: by the corner at its least point, which turns as the whole does. */
static bool is_hole(const struct dt_alpha *a, const uint32_t *point, uint32_t n)
{
    uint32_t least = 0;
    for (uint32_t i = 1; i < n; i++)
        if (dt_compare_xy(a->turn[point[i]].place, a->turn[point[least]].place) < 0)
            least = i;
    return dt_orient2d(a->turn[point[least == 0 ? n - 1 : least - 1]].place,
                       a->turn[point[least]].place,
                       a->turn[point[least + 1 < n ? least + 1 : 0]].place) < 0;
}

/* Takes the points of the path from `from` on as a loop, and off the path all but the first of them. */
static void take_loop(struct dt_alpha *a, struct path *p, uint32_t from)
{
    uint32_t *point = p->point + from, n = p->n - from, least = 0;
    uint32_t *id = a->loop_id + a->loop_ids;
    a->loop[a->loops++] = (struct loop){id, n, is_hole(a, point, n)};
    a->loop_ids += n;
    for (uint32_t i = 1; i < n; i++)
        if (point[i] < point[least]) /* turns are in the order of their points' ids */
            least = i;
    for (uint32_t i = 0; i < n; i++)
        id[i] = a->turn[point[least + i < n ? least + i : least + i - n]].at;
    for (uint32_t i = 1; i < n; i++)
        p->on[point[i]] = DT_NONE;
    p->n = from + 1;
}

/* Walks from a turn on until it comes back. */
static enum dt_status walk(struct dt_alpha *a, struct path *p, size_t start, struct dt_stop *work)
{
    enum dt_status s = DT_OK;
    size_t i = start;
    p->n = 0;
    do {
        uint32_t point = a->turn[i].first;
        p->taken[i] = true;
        if (p->on[point] != DT_NONE) {
            take_loop(a, p, p->on[point]);
        } else {
            p->on[point] = p->n;
            p->point[p->n++] = point;
        }
        i = next_turn(a, i);
        s = dt_work(work, 1);
    } while (s == DT_OK && i != start);
    if (s == DT_OK)
        take_loop(a, p, 0);
    p->on[p->point[0]] = DT_NONE;
    return s;
}

static int compare_loops(const void *p, const void *q)
{
    const struct loop *a = p, *b = q;
    for (uint32_t i = 0; i < a->n && i < b->n; i++)
        if (a->id[i] != b->id[i])
            return a->id[i] < b->id[i] ? -1 : 1;
    return (a->n > b->n) - (a->n < b->n);
}

/* Appends the loops, in order, to *out. */
static enum dt_status put_loops(struct dt_alpha *a, struct dt_ids *out)
{
    if (dt_ids_reserve(out, a->loop_ids + 2 * a->loops) != DT_OK)
        return DT_NOMEM;
    qsort(a->loop, a->loops, sizeof *a->loop, compare_loops);
    for (const struct loop *k = a->loop; k < a->loop + a->loops; k++) {
        out->v[out->n++] = k->hole;
        out->v[out->n++] = k->n;
        memcpy(out->v + out->n, k->id, k->n * sizeof *k->id);
        out->n += k->n;
    }
    return DT_OK;
}

enum dt_status dt_alpha_end(struct dt_alpha *a, const struct dt_options *opt, struct dt_ids *out,
                            size_t *loops)
{
    struct dt_stop work = dt_stop_of(opt);
    struct path p;
    enum dt_status s = DT_OK;
    if (a->turns > 0)
        qsort(a->turn, a->turns, sizeof *a->turn, compare_turns);
    a->loop_id = malloc((a->turns + 1) * sizeof *a->loop_id);
    a->loop = malloc((a->turns / 3 + 1) * sizeof *a->loop); /* each has three edges or more */
    if (!path_init(&p, a) || a->loop_id == NULL || a->loop == NULL)
        s = DT_NOMEM;
    for (size_t i = 0; i < a->turns && s == DT_OK; i++)
        if (!p.taken[i])
            s = walk(a, &p, i, &work);
    path_clear(&p);
    if (s == DT_OK)
        s = put_loops(a, out);
    *loops = a->loops;
    return s;
}
