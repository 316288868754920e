/* hull_test.c - the mesh's storage and counts, and the hull as a cycle of ghosts. */
#include "core/mesh/hull.h"

#include <stdlib.h>

#include "core/set/set.h"
#include "tests/core/sets.h"
#include "tests/test.h"

static void check_counts(const struct pair *pair)
{
    struct dt_ids triangles = {0}, edges = {0}, hull = {0};
    brute_table(pair->b, DT_TRIANGLES, false, &triangles);
    brute_table(pair->b, DT_EDGES, false, &edges);
    brute_table(pair->b, DT_HULL, false, &hull);
    CHECK(dt_mesh_triangles(&pair->t->mesh) == triangles.n / 3);
    CHECK(dt_mesh_edges(&pair->t->mesh) == edges.n / 2);
    CHECK(dt_mesh_hull(&pair->t->mesh) == hull.n);
    CHECK(dt_mesh_is_line(&pair->t->mesh) == (pair->b->line != NULL));
    free(triangles.v);
    free(edges.v);
    free(hull.v);
}

TEST(counts_follow_from_euler_on_every_family)
{
    for_each_pair(check_counts);
}

static void check_settled(const struct pair *pair)
{
    const struct dt *t = pair->t;
    for (uint32_t v = 0; v < t->points.end; v++) {
        if (t->points.id[v] == DT_NONE)
            continue;
        bool on_hull = brute_on_hull(pair->b, t->points.id[v]);
        CHECK(dt_on_hull(&t->mesh, v) == on_hull);
        if (on_hull && t->mesh.vertices > 1)
            CHECK(dt_hull_vertex(&t->mesh, dt_hull_ghost(&t->mesh, v)) == v);
    }
}

TEST(hull_points_are_recognised_at_once)
{
    for_each_pair(check_settled);
}

TEST(hull_walks_back_the_way_it_came)
{
    const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}, {2, 0}};
    struct dt *t = set_of(p, 6);
    uint32_t g = t->mesh.hull, n = 0;
    do {
        uint32_t next = dt_hull_step(&t->mesh, g, false);
        CHECK(dt_hull_step(&t->mesh, next, true) == g);
        CHECK(dt_hull_vertex(&t->mesh, next) == dt_hull_successor(&t->mesh, g));
        g = next;
        n++;
    } while (g != t->mesh.hull);
    CHECK(n == 5);
    dt_free(t);
}

TEST(mesh_keeps_its_content_when_it_grows_and_when_memory_runs_out)
{
    const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}};
    struct dt *t = set_of(p, 3);
    uint32_t end = t->mesh.tri_end;
    test_fail_alloc(1);
    CHECK(dt_mesh_reserve(&t->mesh, 100000, 0) == DT_NOMEM);
    test_fail_alloc(1);
    CHECK(dt_mesh_reserve(&t->mesh, 0, 100000) == DT_NOMEM);
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    CHECK(dt_mesh_reserve(&t->mesh, 100000, 100000) == DT_OK);
    CHECK(t->mesh.vert_cap >= 100000 && t->mesh.tri_cap >= 100000 && t->mesh.tri_end == end);
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
}
