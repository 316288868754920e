/* refiner.c - see refiner.h.
 *
 * Two lists say what is to be done: edges that a vertex encroaches upon, which come first, and triangles. Both are found
 * when a triangle comes to be, by `examine`. */
#include "core/refining/refiner.h"

#include <stdlib.h>

#include "core/edit/insert.h"
#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"
#include "core/refining/way.h"

enum { STEP_POINTS = 16 }; /* that a step adds at most */
#define SHELL_NEAR 0x1p-10 /* two distances from a vertex are those of one shell: relative */

void dt_refiner_clear(struct dt_refiner *r)
{
    dt_free(r->t);
    free(r->halved);
    free(r->edge);
    dt_queue_clear(&r->queue);
    free(r->encroached.v);
    dt_suspects_clear(&r->suspects);
    free(r->changed.v);
}

static const struct dt_point *places(const struct dt_refiner *r)
{
    return r->t->points.xy;
}

static bool is_inside(const struct dt_refiner *r, uint32_t h)
{
    return !dt_is_ghost(&r->t->mesh, h) && dt_encloses(&r->in, dt_face(&r->t->mesh, h));
}

/* ---- shells ---- */

static double squared(struct dt_point a, struct dt_point b)
{
    return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
}

/* The edge of the beginning that vertex v divides; a == DT_NONE: none. */
static struct dt_part edge_of(const struct dt_refiner *r, uint32_t v)
{
    return v < r->given ? (struct dt_part){DT_NONE, DT_NONE, DT_NONE} : r->edge[v - r->given];
}

/* Whether p and q are on two edges of the beginning that meet at a vertex, and on one shell around it. */
static bool are_on_shell(const struct dt_refiner *r, uint32_t p, uint32_t q)
{
    struct dt_part e = edge_of(r, p), f = edge_of(r, q);
    if (e.a == DT_NONE || f.a == DT_NONE || (e.a == f.a && e.b == f.b))
        return false;
    bool meets_a = e.a == f.a || e.a == f.b, meets_b = e.b == f.a || e.b == f.b;
    if (!meets_a && !meets_b)
        return false;
    const struct dt_point *xy = places(r);
    struct dt_point centre = xy[meets_a ? e.a : e.b];
    double one = squared(centre, xy[p]), other = squared(centre, xy[q]);
    return fabs(one - other) <= SHELL_NEAR * one;
}

/* ---- what is to be done ---- */

static enum dt_status divide_later(struct dt_refiner *r, uint32_t h, uint32_t a, uint32_t b)
{
    return dt_items_append(&r->encroached.v, &r->encroached.n, &r->encroached.cap,
                           &(struct dt_part){h, a, b}, sizeof *r->encroached.v);
}

/* The level of a triangle. First come those with a small angle, or with a long edge and a much shorter one: the shorter the shortest
 * edge, the higher. So points advance in rows from short edges. Then the larger ones. (At 6 to 7 the fewest points are added.) */
static uint32_t level_of(const struct dt_shape *s, unsigned breaks)
{
    const double thin = 6.5; /* 32 degrees, of a triangle with two equal sides */
    bool rows = (breaks & DT_LONG) != 0 && s->qr + s->rp > thin * s->pq;
    bool first = rows || (breaks & DT_SHARP) != 0;
    int exponent;
    double part = frexp(first ? s->pq : s->qr + s->rp, &exponent);
    int rank = 2 * exponent + (part >= 0.75);
    int level = first ? 3072 - rank : 1024 + rank;
    level = first && level < 2048 ? 2048 : level;
    return level < 0 ? 0 : level >= DT_LEVELS ? DT_LEVELS - 1 : (uint32_t)level;
}

/* Limits that the triangle breaks and a point could mend. */
static unsigned can_mend(const struct dt_refiner *r, uint32_t h, const struct dt_shape *s,
                         unsigned breaks)
{
    const struct dt_mesh *m = &r->t->mesh;
    uint32_t p = h + (uint32_t)s->first, q = dt_next(p);
    if ((breaks & DT_SHARP) != 0 && are_on_shell(r, dt_origin(m, p), dt_origin(m, q)))
        breaks &= ~(unsigned)DT_SHARP;
    if ((breaks & DT_LONG) != 0) { /* fixed edges are divided themselves, or kept */
        bool one = false;
        for (uint32_t k = h; k < h + 3; k++)
            one |= !dt_is_fixed(m, k) &&
                   dt_is_long(&r->wanted, places(r)[dt_origin(m, k)], places(r)[dt_dest(m, k)]);
        breaks &= one ? ~0u : ~(unsigned)DT_LONG;
    }
    return breaks;
}

static enum dt_status examine_edge(struct dt_refiner *r, uint32_t h)
{
    const struct dt_mesh *m = &r->t->mesh;
    const struct dt_point *xy = places(r);
    uint32_t a = dt_origin(m, h), b = dt_dest(m, h);
    bool divides =
        dt_encroaches(xy[a], xy[b], xy[dt_apex_of(m, h)]) || dt_is_long(&r->wanted, xy[a], xy[b]);
    return divides ? divide_later(r, h, a, b) : DT_OK;
}

/* Lists the triangle with base half edge h and its fixed edges if something is to be done there. */
static enum dt_status examine(struct dt_refiner *r, uint32_t h)
{
    const struct dt_mesh *m = &r->t->mesh;
    const struct dt_point *xy = places(r);
    enum dt_status status = DT_OK;
    if (!is_inside(r, h))
        return DT_OK;
    for (uint32_t k = h; !r->keep && dt_has_fixed(m, h) && k < h + 3 && status == DT_OK; k++)
        if (dt_is_fixed(m, k))
            status = examine_edge(r, k);
    struct dt_waiting w = {.h = h};
    for (uint32_t k = 0; k < 3; k++)
        w.corner[k] = m->half[h + k];
    struct dt_shape s;
    dt_shape_of(xy[w.corner[0]], xy[w.corner[1]], xy[w.corner[2]], &s);
    unsigned breaks = dt_shape_breaks(&r->wanted, &s);
    if (breaks != 0)
        breaks = can_mend(r, h, &s, breaks);
    if (breaks == 0 || status != DT_OK)
        return status;
    status = dt_queue_reserve(&r->queue, 1);
    if (status == DT_OK)
        dt_queue_push(&r->queue, level_of(&s, breaks), &w);
    return status;
}

static enum dt_status examine_all(struct dt_refiner *r)
{
    const struct dt_mesh *m = &r->t->mesh;
    enum dt_status status = DT_OK;
    for (uint32_t h = 0; h < 8 * m->tri_end && status == DT_OK; h += 8) {
        if ((h & 0xfff) == 0)
            status = dt_work(r->work, 512);
        if (status == DT_OK && !dt_is_dead(m, h))
            status = examine(r, h);
    }
    return status;
}

/* The triangles that have just been made. */
static enum dt_status examine_star(struct dt_refiner *r)
{
    const struct dt_cavity *c = &r->t->scratch;
    enum dt_status status = DT_OK;
    for (uint32_t i = 0; i < c->records && status == DT_OK; i++)
        status = examine(r, c->record[i]);
    return status;
}

/* ---- a new vertex ---- */

/* A place that dt_coordinate_ok accepts. */
static bool round_place(struct dt_point *q)
{
    const double tiny = 0x1p-142;
    q->x = fabs(q->x) < tiny ? 0 : q->x;
    q->y = fabs(q->y) < tiny ? 0 : q->y;
    return dt_coordinate_ok(q->x) && dt_coordinate_ok(q->y);
}

static enum dt_status make_room(struct dt_refiner *r)
{
    size_t n = r->t->points.end - r->given;
    enum dt_status status = dt_points_reserve(&r->t->points, 1, NULL);
    return status != DT_OK ? status
                           : dt_items_reserve(&r->edge, n + 1, &r->edge_cap, sizeof *r->edge);
}

static uint32_t enter(struct dt_refiner *r, struct dt_point q, struct dt_part edge)
{
    uint32_t v = dt_points_enter(&r->t->points, r->t->points.next_id, q);
    dt_points_arrived(&r->t->points, 1);
    r->edge[v - r->given] = edge;
    return v;
}

static bool is_full(const struct dt_refiner *r)
{
    return r->t->points.end - r->given >= r->most;
}

/* With a tolerance, new points keep their distance. */
static bool is_free_place(const struct dt_refiner *r, struct dt_point q)
{
    return r->t->points.tol == 0 || dt_points_find(&r->t->points, q, DT_NONE) == DT_NONE;
}

/* ---- dividing an edge ---- */

/* Whether a fixed edge leaves the origin of h at less than 60 degrees from it, on a side that is inside. */
static bool is_acute(const struct dt_refiner *r, uint32_t h)
{
    const struct dt_mesh *m = &r->t->mesh;
    const struct dt_point *xy = places(r);
    struct dt_point o = xy[dt_origin(m, h)], p = xy[dt_dest(m, h)];
    double ux = p.x - o.x, uy = p.y - o.y, u = ux * ux + uy * uy;
    for (int ccw = 0; ccw < 2; ccw++)
        for (uint32_t k = h;;) {
            if (!is_inside(r, ccw ? k : dt_twin(m, k)))
                break;
            k = ccw ? dt_turn_ccw(m, k) : dt_turn_cw(m, k);
            struct dt_point q = xy[dt_dest(m, k)];
            double vx = q.x - o.x, vy = q.y - o.y, dot = ux * vx + uy * vy;
            if (k == h || dot <= 0 || 4 * dot * dot < u * (vx * vx + vy * vy))
                break;
            if (dt_is_fixed(m, k))
                return true;
        }
    return false;
}

/* Where the edge is divided, as a part of its length from the origin of h. */
static double dividing_part(const struct dt_refiner *r, uint32_t h)
{
    const struct dt_mesh *m = &r->t->mesh;
    uint32_t a = dt_origin(m, h), b = dt_dest(m, h);
    bool at_a = a < r->given && is_acute(r, h), at_b = b < r->given && is_acute(r, dt_twin(m, h));
    if (at_a == at_b)
        return 0.5;
    double length = sqrt(squared(places(r)[a], places(r)[b]));
    int exponent;
    (void)frexp(length / 1.5, &exponent);
    double shell = ldexp(0.5, exponent) / length; /* from 1/3 to 2/3 */
    return at_a ? shell : 1 - shell;
}

/* Whether q, beside the edge of h or on it, is in the triangle of h and on no other edge of it; of a ghost: whether the edge is
 * the only one of the hull that q sees. */
static bool holds(const struct dt_refiner *r, uint32_t h, struct dt_point q)
{
    const struct dt_mesh *m = &r->t->mesh;
    const struct dt_point *xy = places(r);
    struct dt_point a = xy[dt_origin(m, h)], b = xy[dt_dest(m, h)];
    if (dt_is_ghost(m, h)) {
        uint32_t next = dt_next(dt_twin(m, dt_next(h))), prev = dt_prev(dt_twin(m, dt_prev(h)));
        /* the hull edges at both ends, of ghosts beside this one, have q on their inner side */
        return dt_orient2d(xy[dt_origin(m, next)], xy[dt_dest(m, next)], q) < 0 &&
               dt_orient2d(xy[dt_origin(m, prev)], xy[dt_dest(m, prev)], q) < 0;
    }
    struct dt_point c = xy[dt_apex_of(m, h)];
    return dt_orient2d(b, c, q) > 0 && dt_orient2d(c, a, q) > 0;
}

static bool is_strictly_between(struct dt_point a, struct dt_point b, struct dt_point q)
{
    return dt_compare_xy(a, q) == dt_compare_xy(q, b);
}

/* The half edge of the edge of h on whose side q is, if the edge can be divided there; DT_NONE. */
static uint32_t side_of(const struct dt_refiner *r, uint32_t h, struct dt_point q)
{
    const struct dt_mesh *m = &r->t->mesh;
    struct dt_point a = places(r)[dt_origin(m, h)], b = places(r)[dt_dest(m, h)];
    if (!is_strictly_between(a, b, q) && dt_compare_xy(a, q) != 0 && dt_compare_xy(b, q) != 0)
        return DT_NONE;
    int side = dt_orient2d(a, b, q);
    if (side == 0)
        return is_strictly_between(a, b, q) ? h : DT_NONE;
    uint32_t g = side > 0 ? h : dt_twin(m, h);
    return holds(r, g, q) ? g : DT_NONE;
}

/* Sets *at to a part of the length of the edge of h. If lengths are limited, long edges must be divided, so the next double in each
 * direction is tried, too: rounding moves some places on a straight outline across the next edge. Returns the half edge on whose side
 * *at is; DT_NONE: no such place is on the edge. */
static uint32_t place_on(const struct dt_refiner *r, uint32_t h, double part, struct dt_point *at)
{
    enum { TRIES = 5 };
    static const double dx[TRIES] = {0, 1, -1, 0, 0}, dy[TRIES] = {0, 0, 0, 1, -1};
    const struct dt_mesh *m = &r->t->mesh;
    struct dt_point p = places(r)[dt_origin(m, h)], q = places(r)[dt_dest(m, h)];
    const struct dt_point middle = {p.x + part * (q.x - p.x), p.y + part * (q.y - p.y)};
    const int tries = r->wanted.length < HUGE_VAL ? TRIES : 1;
    uint32_t side = DT_NONE;
    for (int k = 0; k < tries && side == DT_NONE; k++) {
        at->x = dx[k] == 0 ? middle.x : nextafter(middle.x, dx[k] * HUGE_VAL);
        at->y = dy[k] == 0 ? middle.y : nextafter(middle.y, dy[k] * HUGE_VAL);
        if (round_place(at) && is_free_place(r, *at))
            side = side_of(r, h, *at);
    }
    return side;
}

static enum dt_status note_halved(struct dt_refiner *r, uint32_t a, uint32_t b, uint32_t middle)
{
    enum dt_status status =
        dt_items_reserve(&r->halved, r->n_halved + 1, &r->halved_cap, sizeof *r->halved);
    if (status == DT_OK)
        r->halved[r->n_halved++] = (struct dt_halved){a < b ? a : b, a < b ? b : a, middle};
    return status;
}

static void note_star(void *ctx, uint32_t v)
{
    struct dt_refiner *r = ctx;
    if (dt_ids_append(&r->changed, v) != DT_OK)
        r->suspects.lost = true;
}

/* The new vertex does not lie exactly on the edge that it divides, so the triangles around may not be Delaunay. */
static enum dt_status mend_star(struct dt_refiner *r)
{
    struct dt_mesh *m = &r->t->mesh;
    const struct dt_cavity *c = &r->t->scratch;
    const struct dt_changes changes = {.star = note_star, .ctx = r};
    enum dt_status status = DT_OK;
    r->changed.n = 0;
    for (uint32_t i = 0; i < c->records; i++)
        for (uint32_t k = 0; k < 3; k++)
            dt_suspect(&r->suspects, c->record[i] + k);
    if (r->suspects.lost)
        return DT_NOMEM;
    dt_mend(m, places(r), &r->suspects, &changes);
    for (size_t i = 0; i < r->changed.n && status == DT_OK; i++) {
        uint32_t first = m->leaving[r->changed.v[i]], h = first;
        do
            status = examine(r, dt_base(h));
        while ((h = dt_turn_ccw(m, h)) != first && status == DT_OK);
    }
    return status;
}

/* Divides the edge of h; *done: it could be. */
static enum dt_status divide(struct dt_refiner *r, uint32_t h, bool *done)
{
    struct dt_mesh *m = &r->t->mesh;
    uint32_t a = dt_origin(m, h), b = dt_dest(m, h);
    struct dt_point p = places(r)[a], q = places(r)[b];
    struct dt_point at;
    *done = false;
    if (r->keep || is_full(r))
        return DT_OK;
    uint32_t side = place_on(r, h, dividing_part(r, h), &at);
    if (side == DT_NONE)
        return DT_OK;
    bool exact = dt_orient2d(p, q, at) == 0;
    struct dt_part edge = edge_of(r, a < r->given ? b : a);
    if (edge.a == DT_NONE)
        edge = (struct dt_part){DT_NONE, a, b};
    enum dt_status status = make_room(r);
    if (status != DT_OK)
        return status;
    uint32_t v = enter(r, at, edge);
    status = dt_insert(m, places(r), v, DT_ON_EDGE, side, &r->t->scratch);
    if (status == DT_OK)
        status = note_halved(r, a, b, v);
    *done = status == DT_OK;
    if (status == DT_OK)
        status = examine_star(r);
    return status == DT_OK && !exact ? mend_star(r) : status;
}

/* Whether the part is still a fixed edge. */
static bool is_there(const struct dt_refiner *r, const struct dt_part *p)
{
    const struct dt_mesh *m = &r->t->mesh;
    return !dt_is_dead(m, p->h) && dt_origin(m, p->h) == p->a && dt_dest(m, p->h) == p->b &&
           dt_is_fixed(m, p->h);
}

/* ---- a triangle ---- */

/* The greatest distance of the new point from the shortest edge, in lengths of that edge; 0: any distance. A triangle with edges that are
 * too long gets its point at most where both new sides over its shortest edge are almost as long as the limit. Beside edges that are kept
 * it gets the centre, which is less often behind them. (At 0.94 to 0.98 of the limit the fewest points are added.) */
static double reach_of(const struct dt_refiner *r, const struct dt_shape *s, unsigned breaks)
{
    const struct dt_wanted *w = &r->wanted;
    const double part = 0.96;
    double side = part * w->length;
    bool sharp = (breaks & DT_SHARP) != 0;
    if ((breaks & DT_LONG) == 0 || !(4 * side * side > s->pq) || (r->keep && !sharp))
        return sharp ? w->off : 0;
    double reach = sqrt(side * side / s->pq - 0.25);
    return w->off > 0 && w->off < reach ? w->off : reach;
}

/* The centre of its circle, or a point nearer to its shortest edge. */
static struct dt_point centre_of(const struct dt_refiner *r, const struct dt_shape *s,
                                 unsigned breaks)
{
    double dx = s->q.x - s->p.x, dy = s->q.y - s->p.y;
    double ex = s->r.x - s->p.x, ey = s->r.y - s->p.y, half = 0.5 / s->cross;
    double x = (ey * s->pq - dy * s->rp) * half, y = (dx * s->rp - ex * s->pq) * half;
    const double reach = reach_of(r, s, breaks);
    if (reach > 0) {
        double ox = 0.5 * dx - reach * dy, oy = 0.5 * dy + reach * dx;
        if (!(s->cross > 0) || ox * ox + oy * oy < x * x + y * y) {
            x = ox;
            y = oy;
        }
    }
    return (struct dt_point){s->p.x + x, s->p.y + y};
}

/* Divides the parts of the list from `from` on; *done: at least one could be. */
static enum dt_status divide_from(struct dt_refiner *r, size_t from, bool *done)
{
    enum dt_status status = DT_OK;
    size_t end = r->encroached.n;
    struct dt_part part[STEP_POINTS];
    size_t n = end - from < STEP_POINTS ? end - from : STEP_POINTS;
    for (size_t i = 0; i < n; i++)
        part[i] = r->encroached.v[from + i];
    r->encroached.n = from;
    *done = false;
    for (size_t i = 0; i < n && status == DT_OK; i++) {
        bool one = false;
        if (is_there(r, &part[i]))
            status = divide(r, part[i].h, &one);
        *done |= one;
    }
    return status;
}

/* Lists the fixed edges on the rim of the cavity that q encroaches upon. */
static enum dt_status list_encroached(struct dt_refiner *r, struct dt_point q)
{
    const struct dt_mesh *m = &r->t->mesh;
    const struct dt_cavity *c = &r->t->scratch;
    enum dt_status status = DT_OK;
    for (uint32_t i = 0; i < c->rims && status == DT_OK; i++) {
        uint32_t h = dt_twin(m, c->rim[i].beyond), a = dt_origin(m, h), b = dt_dest(m, h);
        if (dt_is_fixed(m, h) && dt_encroaches(places(r)[a], places(r)[b], q))
            status = divide_later(r, h, a, b);
    }
    return status;
}

/* Adds q, which is where `at` says; *again: edges have been divided instead. near: also in the circle of an edge. */
static enum dt_status add_free(struct dt_refiner *r, struct dt_point q, struct dt_way_end at,
                               bool near, bool *again)
{
    struct dt_mesh *m = &r->t->mesh;
    struct dt_cavity *c = &r->t->scratch;
    const struct dt_part none = {DT_NONE, DT_NONE, DT_NONE};
    size_t before = r->encroached.n;
    c->split = DT_NONE;
    enum dt_status status = make_room(r);
    if (status == DT_OK && dt_mesh_make_room(m, r->t->points.end, 2) != DT_OK)
        status = DT_NOMEM;
    if (status == DT_OK)
        status = dt_find_cavity(m, places(r), dt_base(at.half), q, c);
    if (status == DT_OK && !near)
        status = list_encroached(r, q);
    if (status != DT_OK)
        return status;
    if (r->encroached.n > before)
        return divide_from(r, before, again);
    dt_insert_found(m, enter(r, q, none), c);
    return examine_star(r);
}

static enum dt_status refine(struct dt_refiner *r, uint32_t h, bool *again)
{
    const struct dt_mesh *m = &r->t->mesh;
    const struct dt_point *xy = places(r);
    struct dt_shape s;
    dt_shape_of(xy[m->half[h]], xy[m->half[h + 1]], xy[m->half[h + 2]], &s);
    unsigned breaks = can_mend(r, h, &s, dt_shape_breaks(&r->wanted, &s));
    struct dt_point q = centre_of(r, &s, breaks);
    if (breaks == 0 || !round_place(&q) || !is_free_place(r, q))
        return DT_OK;
    struct dt_way_end at = dt_way(m, xy, h, q);
    bool on_fixed = at.where == DT_ON_EDGE && dt_is_fixed(m, at.half);
    if ((at.where == DT_OUTSIDE && at.half != DT_NONE) || on_fixed)
        return divide(r, at.half, again);
    if (at.where == DT_OUTSIDE || at.where == DT_ON_VERTEX)
        return DT_OK;
    /* Beside edges that are kept, large triangles are divided all the same; to do that for angles would have no end. */
    return add_free(r, q, at, r->keep && (breaks & (DT_LARGE | DT_LONG)) != 0, again);
}

static bool is_waiting(const struct dt_refiner *r, const struct dt_waiting *w)
{
    const uint32_t *corner = r->t->mesh.half + w->h;
    return corner[0] == w->corner[0] && corner[1] == w->corner[1] && corner[2] == w->corner[2];
}

/* The next edge, or else the next triangle; *any: there was one. */
static enum dt_status step(struct dt_refiner *r, bool *any)
{
    struct dt_part_list *l = &r->encroached;
    struct dt_waiting w;
    bool again = false;
    *any = true;
    if (l->taken == l->n)
        l->taken = l->n = 0;
    if (l->taken < l->n) {
        struct dt_part part = l->v[l->taken++];
        return is_there(r, &part) ? divide(r, part.h, &again) : DT_OK;
    }
    if (!dt_queue_pop(&r->queue, &w)) {
        *any = false;
        return DT_OK;
    }
    if (!is_waiting(r, &w))
        return DT_OK;
    enum dt_status status = refine(r, w.h, &again);
    return again && status == DT_OK && is_waiting(r, &w) ? examine(r, w.h) : status;
}

/* There is memory for the points of the next step. */
static enum dt_status prepare(struct dt_refiner *r)
{
    enum { FIRST = 4096, MORE = 4 };
    uint32_t n = r->t->points.end - r->given;
    if (r->granted >= r->most || n + STEP_POINTS <= r->granted)
        return DT_OK;
    uint64_t want = r->granted == 0 ? FIRST + (uint64_t)r->given : MORE * (uint64_t)r->granted;
    r->granted = want < r->most ? (uint32_t)want : r->most;
    return r->grant(r->ctx, r->granted);
}

enum dt_status dt_refiner_run(struct dt_refiner *r)
{
    bool any = true;
    enum dt_status status = prepare(r);
    if (status == DT_OK)
        status = examine_all(r);
    for (uint32_t i = 1; any && !is_full(r) && status == DT_OK; i++) {
        status = prepare(r);
        if (status == DT_OK)
            status = step(r, &any);
        if (status == DT_OK && (i & 63) == 0)
            status = dt_work(r->work, 64 * 16);
    }
    return status;
}
