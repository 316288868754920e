/* check.c - proves a triangulation.
 *
 * These few tests are sufficient:
 *
 * 1. Every half edge has its twin, and each vertex and infinity has one single ring of half edges. So the
 *    records are closed surfaces.
 * 2. Every real triangle turns counterclockwise. So a closed surface without ghosts is impossible: its signed
 *    areas would add up to 0. All ghosts are in one ring, so there is one surface.
 * 3. There are 2n - 2 triangles on n vertices and infinity. By Euler's formula the surface is a sphere.
 * 4. The hull turns left everywhere and has one leftmost and one rightmost corner: it is a convex polygon,
 *    passed once. A disc of counterclockwise triangles within a simple polygon cannot overlap itself. So this
 *    is a triangulation of the hull with all points as vertices.
 * 5. A triangulation that is locally Delaunay everywhere is Delaunay [Delaunay 1934; Lawson 1977]. With ties
 *    broken there is just one. */
#include "core/exact/predicates.h"
#include "core/mesh/fixed.h"
#include "core/mesh/hull.h"
#include "core/set/set.h"

#include <stdlib.h>

/* A check under way; fault is NULL while none was found. */
struct check {
    const struct dt *t;
    const struct dt_mesh *m;
    const struct dt_point *xy;
    const struct dt_options *opt;
    const char *fault;
    uint32_t live, ghosts; /* records counted */
    bool cancelled;
};

static void expect(struct check *c, bool holds, const char *fault)
{
    if (!holds && c->fault == NULL)
        c->fault = fault;
}

/* Whether the loop, which is at i of n, should continue. done and share: the per cent before and in
 * this loop. */
static bool go_on(struct check *c, uint32_t i, uint32_t n, uint32_t done, uint32_t share)
{
    if (i % 8192 == 0 && c->opt != NULL) {
        if (c->opt->cancel != NULL && atomic_load(c->opt->cancel))
            c->cancelled = true;
        if (c->opt->progress != NULL)
            atomic_store(c->opt->progress, done + (uint32_t)((uint64_t)share * i / (n + 1)));
    }
    return c->fault == NULL && !c->cancelled;
}

static bool is_vertex(const struct check *c, uint32_t v)
{
    return v < c->t->points.end && c->t->points.id[v] != DT_NONE;
}

static bool is_live_half(const struct check *c, uint32_t h)
{
    return h >> 3 < c->m->tri_end && (h & 7) < 3 && !dt_is_dead(c->m, h);
}

/* The record at h: corners that exist and differ, infinity only in corner 2. */
static void check_corners(struct check *c, uint32_t h)
{
    const uint32_t *v = c->m->half + h;
    bool ghost = v[2] == DT_NONE;
    expect(c, is_vertex(c, v[0]) && is_vertex(c, v[1]) && (ghost || is_vertex(c, v[2])),
           "a triangle has a corner that is not a point");
    expect(c, v[0] != v[1] && v[1] != v[2] && v[2] != v[0], "a triangle has the same corner twice");
    c->live++;
    c->ghosts += ghost;
}

static void check_twins(struct check *c, uint32_t h)
{
    for (uint32_t k = h; k < h + 3; k++) {
        uint32_t w = dt_twin(c->m, k);
        bool live = is_live_half(c, w);
        expect(c, live, "a half edge has no twin");
        expect(c, live && dt_twin(c->m, w) == k, "the twin of a twin is another half edge");
        expect(c,
               live && dt_origin(c->m, w) == dt_dest(c->m, k) &&
                   dt_dest(c->m, w) == dt_origin(c->m, k),
               "a half edge and its twin join different points");
    }
}

static void check_records(struct check *c)
{
    const struct dt_mesh *m = c->m;
    uint32_t dead = 0, listed = 0;
    for (uint32_t i = 0; i < m->tri_end && go_on(c, i, m->tri_end, 0, 20); i++) {
        if (dt_is_dead(m, 8 * i))
            dead++;
        else
            check_corners(c, 8 * i);
    }
    for (uint32_t i = 0; i < m->tri_end && go_on(c, i, m->tri_end, 20, 20); i++)
        if (!dt_is_dead(m, 8 * i))
            check_twins(c, 8 * i);
    expect(c, dead == m->dead && c->ghosts == m->ghosts, "the counts of triangles are wrong");
    uint32_t at = m->free_list;
    for (; at != DT_NONE && listed < dead && at < 8 * m->tri_end && dt_is_dead(m, at);
         at = m->half[at])
        listed++;
    expect(c, listed == dead && (dead == 0 || at == DT_NONE),
           "the list of free triangles is broken");
    uint32_t n = m->vertices;
    expect(c, n == dt_points_vertices(&c->t->points), "not every point is in the triangulation");
    expect(c, c->live == (n < 2 ? 0 : 2 * n - 2), "Euler's formula does not hold");
}

/* Returns how many half edges leave v, all in one ring; 0 if the ring does not begin as it should. */
static uint32_t ring_length(const struct check *c, uint32_t v)
{
    uint32_t first = c->m->leaving[v], h = first, n = 0;
    if (!is_live_half(c, first) || dt_origin(c->m, first) != v)
        return 0;
    do {
        n++;
        h = dt_turn_ccw(c->m, h);
    } while (h != first);
    return n;
}

/* The half edges that leave points are in as many rings as there are points. */
static void check_rings(struct check *c)
{
    uint64_t sum = 0;
    uint32_t end = c->t->points.end;
    if (c->m->vertices < 2)
        return;
    for (uint32_t v = 0; v < end && go_on(c, v, end, 40, 20); v++) {
        if (c->t->points.id[v] == DT_NONE)
            continue;
        uint32_t n = ring_length(c, v);
        expect(c, n > 0, "a point leads to a half edge that does not leave it");
        sum += n;
    }
    expect(c, sum == 3 * (uint64_t)c->live - c->ghosts,
           "the triangles around a point are in several rings");
}

/* At the hull vertex of ghost g: the mesh is settled there, and the turn is convex. */
static void check_hull_vertex(struct check *c, uint32_t g, bool line, uint32_t *turns)
{
    const struct dt_mesh *m = c->m;
    uint32_t v = dt_hull_vertex(m, g), before = dt_hull_step(m, g, true);
    struct dt_point p = c->xy[dt_hull_vertex(m, before)], q = c->xy[v],
                    r = c->xy[dt_hull_successor(m, g)];
    uint32_t h = m->leaving[v];
    int turn = dt_orient2d(p, q, r), comes = dt_compare_xy(p, q), goes = dt_compare_xy(q, r);
    expect(c, line ? dt_is_ghost(m, h) && dt_dest(m, h) == DT_NONE : h == g + 1,
           "a hull point does not lead to its half edge to infinity");
    expect(c, line ? turn == 0 : turn >= 0, "the hull is not convex");
    bool back = line && dt_hull_turns(m, before);
    expect(c, turn != 0 || (comes == goes) == !back, "the hull runs back on itself");
    *turns += comes != goes;
}

static void check_hull(struct check *c)
{
    const struct dt_mesh *m = c->m;
    uint32_t g = m->hull, n = 0, turns = 0;
    bool line = m->vertices > 1 && c->ghosts == 2 * m->vertices - 2;
    if (m->vertices < 2)
        return;
    expect(c, is_live_half(c, g) && dt_is_ghost(m, g) && g == dt_base(g),
           "the hull does not begin at a ghost");
    if (c->fault != NULL)
        return;
    do {
        expect(c, line || !dt_is_ghost(m, dt_twin(m, g)), "a ghost has no triangle behind it");
        check_hull_vertex(c, g, line, &turns);
        g = dt_hull_step(m, g, false);
        n++;
    } while (g != m->hull && go_on(c, n, c->ghosts, 60, 0));
    expect(c, n == c->ghosts, "the hull is in several parts");
    expect(c, turns == 2, "the hull winds around several times");
}

/* The triangle at h turns left, and each edge is locally Delaunay, seen from its lower half
 * edge. */
static void check_delaunay(struct check *c, uint32_t h)
{
    const struct dt_mesh *m = c->m;
    const uint32_t *v = m->half + h;
    struct dt_point a = c->xy[v[0]], b = c->xy[v[1]], d = c->xy[v[2]];
    expect(c, dt_orient2d(a, b, d) > 0, "a triangle is not counterclockwise");
    for (uint32_t k = h; k < h + 3; k++) {
        uint32_t w = dt_twin(m, k);
        if (k < w && !dt_is_ghost(m, w) && !dt_is_fixed(m, k))
            expect(c, dt_incircle_perturbed(a, b, d, c->xy[dt_apex_of(m, w)]) < 0,
                   "an edge is not Delaunay");
    }
}

static void check_geometry(struct check *c)
{
    check_hull(c);
    for (uint32_t i = 0; i < c->m->tri_end && go_on(c, i, c->m->tri_end, 60, 30); i++)
        if (!dt_is_dead(c->m, 8 * i) && !dt_is_ghost(c->m, 8 * i))
            check_delaunay(c, 8 * i);
}

/* The number of constraints that cover edges, one for each edge. Every edge is as fixed as its twin. */
static uint64_t count_covers(struct check *c)
{
    uint64_t covers = 0;
    for (uint32_t i = 0; i < c->m->tri_end && go_on(c, i, c->m->tri_end, 90, 0); i++)
        for (uint32_t h = 8 * i; h < 8 * i + 3 && !dt_is_dead(c->m, 8 * i); h++) {
            uint32_t w = dt_twin(c->m, h);
            expect(c, dt_is_fixed(c->m, h) == dt_is_fixed(c->m, w),
                   "an edge is constrained on one side only");
            covers += h < w ? dt_fixed_count(c->m, h) : 0;
        }
    return covers;
}

/* Returns how many edges the constraint between v and w covers. */
static uint32_t chain_length(struct check *c, uint32_t v, uint32_t w)
{
    uint32_t n = 0, near = c->m->leaving[v];
    while (v != w) {
        uint32_t h = dt_chain_next(c->m, c->xy, near, c->xy[w]);
        if (h == DT_NONE) {
            expect(c, false, "a constraint is not a chain of edges");
            return n;
        }
        near = dt_twin(c->m, h);
        v = dt_origin(c->m, near);
        n++;
    }
    return n;
}

/* Edges are fixed if and as often as constraints cover them: none is covered less often than constraints say, and the
 * sums are equal. */
static void check_constraints(struct check *c)
{
    if (!dt_is_constrained(c->t)) {
        expect(c, c->m->fixed == NULL, "edges are constrained without constraints");
        return;
    }
    const struct dt_declared *d = &c->t->constraints->declared;
    const struct dt_points *p = &c->t->points;
    uint64_t covers = count_covers(c);
    for (uint32_t i = 0; i < d->end && go_on(c, i, d->end, 90, 0); i++) {
        if (!dt_declared_is_live(d, i))
            continue;
        uint32_t v = dt_points_vertex(p, d->row[i].end[0]);
        uint32_t w = dt_points_vertex(p, d->row[i].end[1]);
        expect(c, v != DT_NONE && w != DT_NONE, "a constraint has lost an end");
        if (c->fault == NULL)
            covers -= chain_length(c, v, w);
    }
    expect(c, c->cancelled || covers == 0, "the counts of constraints on edges are wrong");
}

static void check_regions(struct check *c)
{
    const struct dt_constraints *k = c->t->constraints;
    if (dt_is_constrained(c->t) && k->regions.current)
        expect(c, dt_regions_hold(&k->regions, c->m, &c->t->points, &k->declared),
               "regions are not what borders enclose");
}

/* Ids, aliases and vertices refer to one another. */
static void check_ids(struct check *c)
{
    const struct dt_points *p = &c->t->points;
    uint32_t aliases = 0, vertices = 0, i = 0;
    for (uint32_t id = 0;
         (id = dt_points_next_live(p, id)) != DT_NONE && go_on(c, i, p->next_id, 90, 9);
         id++, i++) {
        uint32_t v = dt_points_vertex(p, id);
        expect(c, is_vertex(c, v), "an id leads to no point");
        if (c->fault != NULL)
            return;
        bool alias = dt_points_is_alias(p, id);
        aliases += alias;
        vertices += !alias;
        expect(c, (p->id[v] == id) != alias, "an id leads to the point of another one");
        expect(c, !alias || p->tol > 0 || dt_compare_xy(dt_points_xy(p, id), p->xy[v]) == 0,
               "an alias lies elsewhere than its representative");
    }
    expect(c, c->cancelled || (aliases == p->aliases.count && vertices == dt_points_vertices(p)),
           "the counts of points are wrong");
}

/* Every cell of the grid, if there is one yet, leads to a half edge or to a finer grid. */
static void check_hints(struct check *c)
{
    const struct dt_hints *g = &c->t->hints;
    for (uint32_t k = 0; k < g->grids && c->fault == NULL && !c->cancelled; k++) {
        uint64_t end = g->grid[k].first + (uint64_t)g->grid[k].nx * g->grid[k].ny;
        expect(c, g->grid[k].nx > 0 && g->grid[k].ny > 0 && end <= g->cells,
               "a grid is not where its cells are");
        for (uint64_t i = g->grid[k].first; i < end && go_on(c, (uint32_t)i, g->cells, 99, 1);
             i++) {
            uint32_t h = g->cell[i];
            bool grid = (h & 4) != 0;
            expect(c, grid ? h >> 3 > k && h >> 3 < g->grids : h >> 3 < c->m->tri_end,
                   "a cell of the grid leads nowhere");
        }
    }
}

enum dt_status dt_check(const struct dt *t, const struct dt_options *opt, const char **fault)
{
    enum dt_status s = dt_readable(t);
    if (s != DT_OK)
        return s;
    struct check c = {.t = t, .m = &t->mesh, .xy = t->points.xy, .opt = opt};
    void (*const step[])(struct check *) = {check_records, check_rings, check_geometry,
                                            check_ids,     check_hints, check_constraints,
                                            check_regions};
    for (size_t i = 0; i < sizeof step / sizeof *step && c.fault == NULL && !c.cancelled; i++)
        step[i](&c);
    if (c.cancelled)
        return DT_CANCELLED;
    if (c.fault != NULL && fault != NULL)
        *fault = c.fault;
    return c.fault == NULL ? DT_OK : DT_CORRUPT;
}
