/* shelling.c - Delaunay triangulation by circular shelling over a uniform grid.
 *
 * Source: Fang & Piegl, "Delaunay Triangulation Using a Uniform Grid", IEEE CG&A 13(3), 1993,
 * fig. 19. Deviations: signs are exact and ties have a rule, so the result is the one canonical
 * triangulation; no edge is searched twice; the result is a mesh with ghosts.
 *
 *     put the points into a grid (grid.c)
 *     the first edge joins a point near the middle to its nearest neighbour
 *     while there is an edge on the front that something can be done for (front.c)
 *         find its apex (apex.c)
 *         add their triangle to the disc, if it touches the disc properly
 *         take a point that this encloses out of the grid
 *     what remains in the grid is the convex hull
 *
 * Why it is right.
 * 1. The first edge is Delaunay: the disc whose diameter it is holds no other point, because such a point would be
 *    nearer.
 * 2. If an edge is Delaunay, its triangle with its apex is Delaunay, and the other two edges of that triangle are, too.
 * 3. The apex depends only on the directed edge: ties follow the rule of heights on a paraboloid that are perturbed one
 *    by one. So all triangles belong to one triangulation, in any order.
 *
 * Why it always terminates.
 * 1. A triangle is added only if it shares one edge or two edges with the disc. So the triangulated part stays a disc,
 *    with a front that passes each point once. Otherwise the edge waits until the front next to it changes.
 * 2. Every partial shelling of a triangulated disc extends to a whole one [Danaraj & Klee, "Which spheres are
 *    shellable?", Annals of Discrete Mathematics 2, 1978]. So as long as triangles are left, one of them touches the
 *    disc properly, and not all edges can wait for one another around caves. The paper does not prove this. */
#include "core/shelling/shelling.h"

#include "core/divide/divide.h"
#include "core/exact/predicates.h"
#include "core/mesh/hull.h"
#include "core/shelling/apex.h"
#include <assert.h>

/* The limit of its total cost, in steps (grid.h): a constant, and an amount for each point of the set. Evenly
 * spread points take 600 each, Gaussian ones 700, lattices 2500, and 300 points nearly on a line 85,000.
 * So the cost of a point on a line grows with the number of points. */
#define STEPS (1u << 25)
#define STEPS_A_POINT 8192u
#define TURN_STEPS 64u  /* for an edge of the front, besides its search */
#define CLOSE_STEPS 16u /* for a vertex of the hull */

/* ---- the mesh ---- */

/* Adds a record with corners a, b, c (DT_NONE for a ghost); returns its first half edge. */
static uint32_t add_triangle(struct dt_mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t h = 8 * m->tri_end++;
    dt_set_corners(m, h, a, b, c);
    return h;
}

/* ---- what an observer sees ---- */

static void observe(const struct dt_shell *s, enum dt_event_kind kind, uint32_t a, uint32_t b,
                    uint32_t c)
{
    const struct dt_observer *o = s->observer;
    if (o != NULL)
        o->see(o->ctx, &(struct dt_event){.kind = kind, .a = a, .b = b, .c = c});
}

static void observe_touch(const struct dt_shell *s, enum dt_touch touch, uint32_t a, uint32_t b,
                          uint32_t c)
{
    static const enum dt_event_kind kind[] = {[DT_NEW_POINT] = DT_EVENT_POINT,
                                              [DT_RIGHT_TOUCH] = DT_EVENT_RIGHT,
                                              [DT_LEFT_TOUCH] = DT_EVENT_LEFT,
                                              [DT_NO_TOUCH] = DT_EVENT_CAVE,
                                              [DT_BOUNDARY] = DT_EVENT_BORDER};
    observe(s, kind[touch], a, b, c);
}

/* Cells and the cells of crowded ones. */
static void observe_cells(const struct dt_observer *o, const struct dt_cells *c)
{
    struct dt_event e = {.kind = DT_EVENT_GRID, .p = c->lo, .size = c->side};
    e.a = c->upright ? c->lines : c->length;
    e.b = c->upright ? c->length : c->lines;
    o->see(o->ctx, &e);
    for (uint32_t i = 0; i < c->subs; i++)
        observe_cells(o, &c->sub[i]);
}

/* ---- the loop ---- */

/* Takes an enclosed point out of the grid; h leaves it. */
static void enclose(struct dt_shell *s, uint32_t place, uint32_t h)
{
    s->mesh->leaving[place] = h;
    dt_grid_remove(&s->grid, place);
    observe(s, DT_EVENT_REMOVE, place, DT_NONE, DT_NONE);
}

/* Looks at the current edge, whose apex is known: one turn of the paper's loop. */
static void step(struct dt_shell *s)
{
    struct dt_front *f = &s->front;
    struct dt_front_node *node = f->node;
    struct dt_mesh *m = s->mesh;
    uint32_t a = f->current, b = node[a].next, c = node[a].apex, h;
    enum dt_touch touch = dt_front_touch(f, a);
    observe_touch(s, touch, a, b, c);
    switch (touch) {
    case DT_NEW_POINT:
        h = add_triangle(m, a, b, c);
        dt_link(m, h, node[a].outer);
        dt_front_new_point(f, a, h);
        break;
    case DT_RIGHT_TOUCH:
        h = add_triangle(m, a, b, c);
        dt_link(m, h, node[a].outer);
        dt_link(m, h + 1, node[b].outer);
        dt_front_right_touch(f, a, h);
        enclose(s, b, h + 1);
        break;
    case DT_LEFT_TOUCH:
        h = add_triangle(m, a, b, c);
        dt_link(m, h, node[a].outer);
        dt_link(m, h + 2, node[c].outer);
        dt_front_left_touch(f, a, h);
        enclose(s, a, h);
        break;
    case DT_BOUNDARY:
        h = add_triangle(m, a, b, DT_NONE);
        dt_link(m, h, node[a].outer);
        node[a].outer = h;
        m->ghosts++;
        dt_front_sleep(f, a);
        break;
    case DT_NO_TOUCH:
        dt_front_sleep(f, a);
        break;
    }
}

/* Searches the apex of the current edge, if that has not been done yet. False: it must stop. */
static bool search(struct dt_shell *s)
{
    uint32_t a = s->front.current;
    struct dt_front_node *node = &s->front.node[a];
    if (node->apex == DT_UNSEARCHED)
        node->apex = dt_apex(&s->grid, a, node->next);
    return !dt_grid_spend(&s->stop, TURN_STEPS);
}

/* The first triangle, on either side of the first edge. False if all points are on one line, or if it has
 * to stop. */
static bool open_front(struct dt_shell *s)
{
    uint32_t a = dt_grid_middle(&s->grid), b = dt_grid_nearest(&s->grid, a);
    if (dt_stop_status(&s->stop) != DT_OK)
        return false;
    observe(s, DT_EVENT_START, a, b, DT_NONE);
    uint32_t c = dt_apex(&s->grid, a, b);
    if (c == DT_NONE) {
        uint32_t swap = a;
        a = b;
        b = swap;
        c = dt_apex(&s->grid, a, b);
    }
    if (c == DT_NONE || dt_stop_status(&s->stop) != DT_OK)
        return false;
    dt_front_open(&s->front, a, b, c, add_triangle(s->mesh, a, b, c));
    observe(s, DT_EVENT_FIRST, a, b, c);
    return true;
}

static void report(const struct dt_options *opt, uint32_t done, uint32_t all)
{
    if (opt != NULL && opt->progress != NULL)
        atomic_store_explicit(opt->progress, (unsigned)((uint64_t)done * 100 / all),
                              memory_order_relaxed);
}

enum dt_status dt_shell_grow(struct dt_shell *s, const struct dt_point *in, uint32_t n,
                             struct dt_point *p, uint32_t *from, struct dt_mesh *m,
                             const struct dt_options *opt, bool *line)
{
    report(opt, 0, 1);
    s->mesh = m;
    s->stop = dt_stop_of(opt);
    s->stop.left = s->observer == NULL ? STEPS + (uint64_t)STEPS_A_POINT * n : UINT64_MAX;
    s->grid.stop = &s->stop;
    enum dt_status status = dt_grid_build(&s->grid, in, n, p, from);
    if (status == DT_OK)
        status = dt_front_init(&s->front, n, &s->stop);
    if (status != DT_OK)
        return status;
    s->grid.observer = s->observer;
    if (s->observer != NULL)
        observe_cells(s->observer, &s->grid.top);
    *line = !open_front(s);
    for (uint32_t turn = 0; s->front.current != DT_NONE && search(s); turn++) {
        if (turn % 16 == 0)
            report(opt, m->tri_end, 2 * n - 2);
        step(s);
    }
    status = dt_stop_status(&s->stop);
    assert(status != DT_OK || *line || m->tri_end == 2 * n - 2); /* Euler; the front is not stuck */
    return status;
}

void dt_shell_clear(struct dt_shell *s)
{
    dt_grid_clear(&s->grid);
    dt_front_clear(&s->front);
}

void dt_shell_close(struct dt_shell *s)
{
    const struct dt_front_node *node = s->front.node;
    struct dt_mesh *m = s->mesh;
    uint32_t first = 0;
    while (dt_grid_removed(&s->grid, first))
        first++;
    uint32_t v = first;
    do {
        uint32_t h = node[v].outer, next = node[v].next;
        observe(s, DT_EVENT_HULL, v, DT_NONE, DT_NONE);
        dt_link(m, h + 1, node[next].outer + 2);
        m->leaving[next] = h + 1;
        m->hull = h;
        v = next;
    } while (v != first && !dt_grid_spend(&s->stop, CLOSE_STEPS));
}

/* There is nothing to shell: the other engine joins the points. */
static enum dt_status triangulate_line(struct dt_shell *s, const struct dt_point *in, uint32_t n,
                                       struct dt_point *p, uint32_t *from,
                                       const struct dt_options *opt)
{
    struct dt_mesh *m = s->mesh;
    enum dt_status status = dt_divide(in, NULL, n, p, from, m, opt);
    if (status != DT_OK || s->observer == NULL)
        return status;
    uint32_t g = dt_hull_first(m, from, false), other = dt_hull_first(m, from, true);
    if (dt_compare_xy(p[dt_hull_vertex(m, other)], p[dt_hull_vertex(m, g)]) < 0)
        g = other;
    for (uint32_t i = 0; i < n; i++, g = dt_hull_step(m, g, false))
        observe(s, DT_EVENT_HULL, dt_hull_vertex(m, g), DT_NONE, DT_NONE);
    return DT_OK;
}

/* ---- all together ---- */

/* Fills p and the mesh. */
static enum dt_status triangulate(struct dt_shell *s, const struct dt_point *in, uint32_t n,
                                  struct dt_point *p, uint32_t *from, const struct dt_options *opt)
{
    bool line;
    enum dt_status status = dt_shell_grow(s, in, n, p, from, s->mesh, opt, &line);
    if (status == DT_OK && !line)
        dt_shell_close(s);
    dt_shell_clear(s);
    if (status == DT_OK && line)
        return triangulate_line(s, in, n, p, from, opt);
    for (struct dt_piece at = dt_pieces(0, n); status == DT_OK && dt_next_piece(&s->stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++) /* they were removed from the grid */
            p[i] = in[from[i]];
    return status == DT_OK ? dt_stop_status(&s->stop) : status;
}

enum dt_status dt_shelling_observed(const struct dt_point *in, uint32_t n, struct dt_point *p,
                                    uint32_t *from, struct dt_mesh *m, const struct dt_options *opt,
                                    const struct dt_observer *observer)
{
    struct dt_shell s = {.mesh = m, .observer = observer};
    enum dt_status status = dt_mesh_reserve(m, n, n < 2 ? 0 : 2 * n);
    m->tri_end = m->dead = m->ghosts = 0;
    m->free_list = DT_NONE;
    m->vertices = n;
    m->hull = DT_NONE;
    if (n == 1 && status == DT_OK) {
        p[0] = in[0];
        from[0] = 0;
        m->leaving[0] = DT_NONE;
        observe(&s, DT_EVENT_HULL, 0, DT_NONE, DT_NONE);
    }
    if (n >= 2 && status == DT_OK)
        status = triangulate(&s, in, n, p, from, opt);
    if (status != DT_OK)
        dt_mesh_clear(m);
    return status;
}

enum dt_status dt_shelling(const struct dt_point *in, uint32_t n, struct dt_point *p,
                           uint32_t *from, struct dt_mesh *m, const struct dt_options *opt)
{
    return dt_shelling_observed(in, n, p, from, m, opt, NULL);
}
