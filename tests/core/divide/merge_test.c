/* merge_test.c - cancelling a merge. */
#include "core/divide/part.h"
#include "tests/test.h"

#include <stdlib.h>
#include <string.h>

/* n points of a parabola, one merge each, and a point below that is joined to all of them. */
struct arch {
    uint32_t n;
    struct dt_point *p;
    uint32_t *from;
    struct dt_mesh mesh;
};

static struct dt_part arch_begin(struct arch *a, uint32_t n)
{
    *a = (struct arch){
        .n = n, .p = malloc((n + 1) * sizeof *a->p), .from = malloc((n + 1) * sizeof *a->from)};
    CHECK(a->p != NULL && a->from != NULL && dt_mesh_reserve(&a->mesh, n + 1, 2 * n + 2) == DT_OK);
    memset(a->mesh.half, 0, (size_t)16 * (n + 1) * sizeof *a->mesh.half);
    for (uint32_t i = 0; i <= n; i++) {
        double x = i;
        a->p[i] = i < n ? (struct dt_point){x, x * x} : (struct dt_point){n, -4.0 * n * n};
        a->from[i] = i;
    }
    struct dt_merging w = dt_merging_of(a->p, &a->mesh, NULL);
    struct dt_part all = dt_block(&w, 0, 1);
    for (uint32_t i = 1; i < n; i++) {
        struct dt_part one = dt_block(&w, i, 1);
        all = dt_merge_parts(&w, &all, &one, 0, i);
    }
    return all;
}

static struct dt_part merge_last(struct arch *a, const struct dt_part *all, struct dt_stop *stop)
{
    struct dt_merging w = dt_merging_of(a->p, &a->mesh, stop);
    struct dt_part one = dt_block(&w, a->n, 1);
    return dt_merge_parts(&w, all, &one, 0, a->n);
}

static void arch_free(struct arch *a)
{
    free(a->p);
    free(a->from);
    dt_mesh_clear(&a->mesh);
}

/* Whether a merge of n points with one point is cancelled; if not, it must be complete. */
static bool is_given_up(uint32_t n)
{
    struct arch a, b;
    struct dt_part part = arch_begin(&a, n), same = arch_begin(&b, n);
    struct dt_stop stop = {0};
    dt_stop_because(&stop, DT_CANCELLED);
    part = merge_last(&a, &part, &stop);
    same = merge_last(&b, &same, NULL);
    CHECK(same.n == n + 1);
    if (part.n != 0)
        CHECK(part.n == n + 1 &&
              memcmp(a.mesh.half, b.mesh.half, (size_t)16 * (n + 1) * sizeof *a.mesh.half) == 0);
    arch_free(&a);
    arch_free(&b);
    return part.n == 0;
}

TEST(a_merge_with_one_point_that_is_to_stop_is_complete_or_returns_no_points)
{
    CHECK(!is_given_up(100));
    CHECK(!is_given_up(3000));
    CHECK(is_given_up(40000));
}
