/* check_test.c - dt_check accepts correct sets, and detects every kind of fault. */
#include <stdlib.h>
#include <string.h>

#include "core/edit/remove.h"
#include "core/mesh/hull.h"
#include "core/set/set.h"
#include "tests/core/sets.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

/*      3-------2
 *      |   4   |      The diagonal of a square is a tie, and 5 lies on the middle of a hull edge;
 *      0---5---1      6 coincides with 4. */
static const struct dt_point points[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2},
                                         {2, 0}, {2, 2}, {1, 3}, {3, 3}};

static struct dt *example(void)
{
    return set_of(points, 9);
}

/* Frees the set, which must have this fault. */
static void expect_fault(struct dt *t, const char *want)
{
    const char *fault = "none";
    CHECK(dt_check(t, NULL, &fault) == DT_CORRUPT);
    CHECK_STR(fault, want);
    CHECK(dt_check(t, NULL, NULL) == DT_CORRUPT);
    dt_free(t);
}

static void accept(const struct pair *pair)
{
    const char *fault = "none";
    CHECK_MSG(dt_check(pair->t, NULL, &fault) == DT_OK, "%s", fault);
}

TEST(check_accepts_every_family)
{
    for_each_pair(accept);
}

TEST_TIMEOUT(check_accepts_every_family_of_thousands, 60)
{
    struct dt_point *p = malloc(5000 * sizeof *p);
    for (const struct family *f = families; f->name != NULL; f++) {
        family_points(f, p, 5000, test_random());
        struct pair pair = {.t = set_of(p, 5000)};
        accept(&pair);
        dt_free(pair.t);
    }
    free(p);
}

TEST(check_stops_when_it_is_cancelled)
{
    struct dt *t = example();
    atomic_bool cancel = true;
    atomic_uint progress = 0;
    struct dt_options opt = {.cancel = &cancel, .progress = &progress};
    CHECK(dt_check(t, &opt, NULL) == DT_CANCELLED);
    cancel = false;
    CHECK(dt_check(t, &opt, NULL) == DT_OK && progress >= 90 && progress <= 100);
    dt_free(t);
}

/* Some half edge with a real triangle on either side. */
static uint32_t inner_edge(const struct dt *t, uint32_t from_id, uint32_t to_id)
{
    for (uint32_t h = 0; h < 8 * t->mesh.tri_end; h = (h & 7) == 2 ? h + 6 : h + 1)
        if (dt_origin(&t->mesh, h) == dt_points_vertex(&t->points, from_id) &&
            dt_dest(&t->mesh, h) == dt_points_vertex(&t->points, to_id))
            return h;
    return DT_NONE;
}

/* Replaces the edge of h by the other diagonal of its two triangles:
 *
 *         c                     c
 *       /   \                 / | \
 *      a --- b   h: a -> b   a  |  b
 *       \   /                 \ | /
 *         d                     d              */
static void flip(struct dt_mesh *m, uint32_t h)
{
    uint32_t w = dt_twin(m, h), a = dt_origin(m, h), b = dt_dest(m, h), c = dt_apex_of(m, h),
             d = dt_apex_of(m, w);
    uint32_t bc = dt_twin(m, dt_next(h)), ca = dt_twin(m, dt_prev(h));
    uint32_t ad = dt_twin(m, dt_next(w)), db = dt_twin(m, dt_prev(w));
    h = dt_base(h);
    w = dt_base(w);
    dt_set_corners(m, h, c, a, d);
    dt_set_corners(m, w, d, b, c);
    dt_link(m, h, ca);
    dt_link(m, h + 1, ad);
    dt_link(m, h + 2, w + 2);
    dt_link(m, w, db);
    dt_link(m, w + 1, bc);
    m->leaving[c] = dt_is_ghost(m, m->leaving[c]) ? m->leaving[c] : h;
    m->leaving[a] = dt_is_ghost(m, m->leaving[a]) ? m->leaving[a] : h + 1;
    m->leaving[d] = dt_is_ghost(m, m->leaving[d]) ? m->leaving[d] : w;
    m->leaving[b] = dt_is_ghost(m, m->leaving[b]) ? m->leaving[b] : w + 1;
}

TEST(check_sees_an_edge_that_is_not_delaunay)
{
    const struct dt_point p[] = {{0, 0}, {2, -1}, {4, 0}, {2, 1}};
    struct dt *t = set_of(p, 4);
    flip(&t->mesh, inner_edge(t, 1, 3));
    expect_fault(t, "an edge is not Delaunay");
}

TEST(check_sees_a_tie_broken_the_other_way)
{
    for (uint32_t from = 0; from < 2; from++) {
        struct dt *t = set_of(points, 4);
        uint32_t h = inner_edge(t, from, from + 2);
        if (h == DT_NONE) { /* the canonical diagonal is the other one */
            dt_free(t);
            continue;
        }
        flip(&t->mesh, h);
        expect_fault(t, "an edge is not Delaunay");
    }
}

TEST(check_sees_a_triangle_turned_over)
{
    struct dt *t = example();
    const char *fault = "none";
    t->points.xy[dt_points_vertex(&t->points, 4)].x = 30;
    CHECK(dt_check(t, NULL, &fault) == DT_CORRUPT);
    /* In whichever order the records are: an edge of that triangle may be met first. */
    if (strcmp(fault, "an edge is not Delaunay") != 0)
        CHECK_STR(fault, "a triangle is not counterclockwise");
    dt_free(t);
}

TEST(check_sees_a_dent_in_the_hull)
{
    struct dt *t = example();
    t->points.xy[dt_points_vertex(&t->points, 5)].y = 0.5;
    expect_fault(t, "the hull is not convex");
}

TEST(check_sees_points_out_of_order_on_a_line)
{
    const struct dt_point p[] = {{0, 0}, {1, 1}, {2, 2}, {3, 3}};
    struct dt *t = set_of(p, 4);
    uint32_t v = dt_points_vertex(&t->points, 1);
    t->points.xy[v] = (struct dt_point){5, 5};
    expect_fault(t, "the hull runs back on itself");
    t = set_of(p, 4);
    t->points.xy[v].y = 1.5;
    expect_fault(t, "the hull is not convex");
}

TEST(check_sees_wrong_counts)
{
    struct dt *t = example();
    t->mesh.ghosts++;
    expect_fault(t, "the counts of triangles are wrong");
    t = example();
    t->mesh.dead++;
    expect_fault(t, "the counts of triangles are wrong");
    t = example();
    t->mesh.vertices--;
    expect_fault(t, "not every point is in the triangulation");
    t = example();
    t->points.aliases.count++;
    expect_fault(t, "the counts of points are wrong");
}

/* A ninth point that the triangulation does not know. */
TEST(check_sees_a_point_that_was_forgotten)
{
    struct dt *t = example();
    struct dt_added added;
    t->current = false;
    CHECK(dt_add(t, &(struct dt_point){2, 1}, 1, &added) == DT_OK);
    t->current = true;
    expect_fault(t, "not every point is in the triangulation");
}

TEST(check_sees_a_broken_list_of_free_triangles)
{
    struct dt *t = example();
    uint32_t end = t->mesh.tri_end;
    CHECK(dt_mesh_reserve(&t->mesh, 0, end + 2) == DT_OK);
    t->mesh.tri_end += 2;
    t->mesh.dead = 2;
    for (uint32_t i = 0; i < 2; i++)
        dt_set_corners(&t->mesh, 8 * (end + i), i == 0 ? 8 * (end + 1) : DT_NONE, 0, DT_DEAD);
    t->mesh.free_list = 8 * end;
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    t->mesh.half[8 * (end + 1)] = 8 * end; /* a cycle */
    const char *fault = NULL;
    CHECK(dt_check(t, NULL, &fault) == DT_CORRUPT);
    CHECK_STR(fault, "the list of free triangles is broken");
    t->mesh.free_list = 8 * (end + 1);
    t->mesh.half[8 * (end + 1)] = DT_NONE; /* one is missing */
    expect_fault(t, "the list of free triangles is broken");
}

TEST(check_sees_an_unsettled_hull)
{
    struct dt *t = example();
    uint32_t v = dt_points_vertex(&t->points, 0);
    t->mesh.leaving[v] = dt_turn_ccw(&t->mesh, t->mesh.leaving[v]);
    expect_fault(t, "a hull point does not lead to its half edge to infinity");
    t = example();
    t->mesh.hull = dt_twin(&t->mesh, t->mesh.hull);
    expect_fault(t, "the hull does not begin at a ghost");
}

/* Point 4 is cut out of the triangulation, then joined to points 0 and 1 by a triangle and its
 * back. All counts are right, but 0 and 1 have two rings each. */
TEST(check_sees_a_second_ring_around_a_point)
{
    struct dt *t = example();
    struct dt_mesh *m = &t->mesh;
    struct dt_cavity scratch = {0};
    uint32_t a = dt_points_vertex(&t->points, 0), b = dt_points_vertex(&t->points, 1);
    uint32_t c = dt_points_vertex(&t->points, 4);
    CHECK(dt_remove(m, t->points.xy, c, &scratch) == DT_OK && m->dead == 2);
    uint32_t front = m->free_list, back = m->half[front];
    m->free_list = DT_NONE;
    m->dead = 0;
    m->vertices++;
    m->leaving[c] = front + 2;
    dt_set_corners(m, front, a, b, c);
    dt_set_corners(m, back, b, a, c);
    dt_link(m, front, back);
    dt_link(m, front + 1, back + 2);
    dt_link(m, front + 2, back + 1);
    dt_cavity_clear(&scratch);
    expect_fault(t, "the triangles around a point are in several rings");
}

TEST(check_sees_ids_and_aliases_that_lead_astray)
{
    struct dt *t = example();
    uint32_t u = dt_points_vertex(&t->points, 7), v = dt_points_vertex(&t->points, 8);
    t->points.id[u] = 8;
    t->points.id[v] = 7;
    expect_fault(t, "an id leads to the point of another one");
    t = example();
    t->points.aliases.alias[0].xy.x = 3;
    expect_fault(t, "an alias lies elsewhere than its representative");
}

TEST(check_sees_a_grid_that_leads_nowhere)
{
    struct dt *t = example();
    t->hints.cell[0] = 8 * t->mesh.tri_end;
    expect_fault(t, "a cell of the grid leads nowhere");
    t = example();
    t->hints.cell[0] = 4; /* the grid itself */
    expect_fault(t, "a cell of the grid leads nowhere");
}

/* An octagon around its centre, its corners then moved onto a square that is passed twice. Every triangle still turns
 * left, and the hull turns left everywhere. */
TEST(check_sees_a_hull_that_winds_twice)
{
    static const struct dt_point octagon[] = {{4, 0},   {3, 3},  {0, 4},  {-3, 3}, {-4, 0},
                                              {-3, -3}, {0, -4}, {3, -3}, {0, 0}};
    static const struct dt_point square[] = {{4, 0}, {0, 4}, {-4, 0}, {0, -4}};
    struct dt *t = set_of(octagon, 9);
    for (uint32_t i = 0; i < 8; i++)
        t->points.xy[dt_points_vertex(&t->points, i)] = square[i % 4];
    expect_fault(t, "the hull winds around several times");
}

/* Whether the word at i of the mesh may be any half edge that leaves the same point. */
static bool is_free_choice(const struct dt *t, uint32_t v, uint32_t h)
{
    return h >> 3 < t->mesh.tri_end && (h & 7) < 3 && dt_origin(&t->mesh, h) == v &&
           !dt_on_hull(&t->mesh, v);
}

/* Every word of the mesh, replaced by many others: always detected, and nothing crashes or
 * hangs. */
TEST_TIMEOUT(check_sees_every_wrong_word_of_the_mesh, 60)
{
    struct dt *t = example();
    uint32_t words = 8 * t->mesh.tri_end;
    for (uint32_t i = 0; i < words; i++) {
        if ((i & 3) == 3)
            continue; /* unused */
        uint32_t old = t->mesh.half[i];
        for (uint32_t k = 0; k < words + 4; k++) {
            t->mesh.half[i] = k < words ? k : DT_NONE - (k - words);
            if (t->mesh.half[i] != old)
                CHECK_MSG(dt_check(t, NULL, NULL) == DT_CORRUPT, "half[%u] = %u", i,
                          t->mesh.half[i]);
        }
        t->mesh.half[i] = old;
    }
    for (uint32_t v = 0; v < t->points.end; v++) {
        uint32_t old = t->mesh.leaving[v];
        for (uint32_t h = 0; h < words + 8; h++) {
            t->mesh.leaving[v] = old;
            bool fine = h == old || is_free_choice(t, v, h);
            t->mesh.leaving[v] = h;
            CHECK_MSG(dt_check(t, NULL, NULL) == (fine ? DT_OK : DT_CORRUPT), "leaving[%u] = %u", v,
                      h);
        }
        t->mesh.leaving[v] = old;
    }
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
}
