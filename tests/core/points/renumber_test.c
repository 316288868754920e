/* renumber_test.c - many vertices get new numbers, and each id keeps its point. */
#include <stdlib.h>

#include "core/memory/memory.h"
#include "core/set/set.h"
#include "tests/core/threads.h"
#include "tests/test.h"

/* ids in a block of pages and beyond it, and enough for several threads */
enum { N = (1 << 19) + 999 };

/* A permutation of 0 .. N - 1. */
static uint32_t *shuffled(void)
{
    uint32_t *p = dt_array_new(N, sizeof *p);
    uint64_t random = test_random() | 1;
    CHECK(p != NULL);
    for (uint32_t i = 0; i < N; i++) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        uint32_t k = (uint32_t)((random >> 32) % (i + 1));
        p[i] = p[k];
        p[k] = i;
    }
    return p;
}

/* Renumbers p at random and checks that point i is at (i, 0). */
static void renumber_and_check(struct dt_points *p, const struct dt_pool *pool)
{
    uint32_t *id = shuffled();
    struct dt_point *xy = dt_array_new(N, sizeof *xy);
    CHECK(xy != NULL);
    for (uint32_t v = 0; v < N; v++)
        xy[v] = (struct dt_point){id[v], 0};
    struct dt_point *new_xy = xy, *old_xy = p->xy;
    uint32_t *new_id = id, *old_id = p->id;
    CHECK(dt_points_renumber(p, &xy, &id, N, &(struct dt_options){.pool = pool}) == DT_OK);
    CHECK(p->end == N && p->xy == new_xy && p->id == new_id && xy == old_xy && id == old_id);
    dt_array_free(xy);
    dt_array_free(id);
    for (uint32_t v = 0; v < N; v++)
        CHECK(p->xy[v].x == p->id[v] && dt_points_vertex(p, p->id[v]) == v);
}

TEST_TIMEOUT(ids_of_many_vertices_find_their_new_ones, 60)
{
    struct dt_added added;
    struct dt_pool pool = threads_pool(3);
    struct dt_point *q = malloc(N * sizeof *q);
    for (uint32_t i = 0; i < N; i++)
        q[i] = (struct dt_point){i, 0};
    struct dt *t = dt_new(0);
    CHECK(dt_add(t, q, N, &added) == DT_OK);
    renumber_and_check(&t->points, &pool);
    renumber_and_check(&t->points, NULL);
    dt_free(t);
    free(q);
}
