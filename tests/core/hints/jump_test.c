/* jump_test.c - searches that would be long begin at the best of a sample. */
#include "core/hints/jump.h"

#include <math.h>
#include <stdlib.h>

#include "core/exact/predicates.h"
#include "core/set/set.h"
#include "tests/core/sets.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { POINTS = 5000, PLACES = 200 };

/* Triangles passed from the one at t until q is in it or beyond the hull. */
static uint32_t steps_to(const struct dt *t, uint32_t h, struct dt_point q)
{
    const struct dt_point *xy = t->points.xy;
    for (uint32_t steps = 0;; steps++) {
        uint32_t k = 0;
        if (dt_is_ghost(&t->mesh, h))
            return steps;
        while (k < 3 &&
               dt_orient2d(xy[dt_origin(&t->mesh, h + k)], xy[dt_dest(&t->mesh, h + k)], q) >= 0)
            k++;
        if (k == 3)
            return steps;
        h = dt_base(dt_twin(&t->mesh, h + k));
    }
}

/* A set on whose triangles walks are long, and places all over it. */
struct field {
    struct dt *t;
    struct dt_point place[PLACES];
    uint32_t any; /* a triangle */
};

static struct field field_of(const char *family)
{
    struct field f;
    struct dt_point *p = malloc(POINTS * sizeof *p);
    family_points(family_find(family), p, POINTS, 1);
    f.t = set_of(p, POINTS);
    free(p);
    for (int i = 0; i < PLACES; i++)
        f.place[i] = (struct dt_point){2 * test_uniform() - 1, 2 * test_uniform() - 1};
    f.any = dt_base(dt_twin(&f.t->mesh, dt_base(f.t->mesh.hull)));
    return f;
}

static const char *const thin[] = {"cross", "circle", "kuzmin", "thin_line", "uniform"};

TEST(walks_from_the_deepest_of_a_sample_are_short)
{
    for (size_t k = 0; k < sizeof thin / sizeof *thin; k++) {
        struct field f = field_of(thin[k]);
        uint64_t steps = 0, far = 0;
        for (int i = 0; i < PLACES; i++) {
            uint32_t h = dt_jump_triangle(&f.t->mesh, f.t->points.xy, f.any, f.place[i]);
            CHECK(h == dt_base(h) && !dt_is_dead(&f.t->mesh, h) && !dt_is_ghost(&f.t->mesh, h));
            steps += steps_to(f.t, h, f.place[i]);
            far += steps_to(f.t, f.any, f.place[i]);
        }
        CHECK_MSG(steps <= 3 * PLACES * (uint64_t)dt_jump_samples(f.t->mesh.tri_end), "%s: %.1f",
                  thin[k], (double)steps / PLACES);
        CHECK_MSG(k > 0 || far > 4 * steps, "%s: %.1f", thin[k], (double)far / PLACES);
        dt_free(f.t);
    }
}

TEST(few_vertices_are_nearer_than_the_nearest_of_a_sample)
{
    for (size_t k = 0; k < sizeof thin / sizeof *thin; k++) {
        struct field f = field_of(thin[k]);
        const struct dt_point *xy = f.t->points.xy;
        uint64_t nearer = 0;
        for (int i = 0; i < PLACES; i++) {
            struct dt_point q = f.place[i];
            uint32_t v = dt_jump_vertex(&f.t->mesh, xy, 0, q);
            for (uint32_t w = 0; w < f.t->mesh.vertices; w++)
                nearer += dt_compare_distance(q, xy[w], xy[v]) < 0;
        }
        CHECK_MSG(nearer <= 3 * PLACES * (uint64_t)dt_jump_samples(f.t->mesh.vertices), "%s: %.1f",
                  thin[k], (double)nearer / PLACES);
        dt_free(f.t);
    }
}
