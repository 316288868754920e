/* thinned_test.c - surfaces of few points of arrays in which points coincide, against dt_thin of different places. */
#include <fenv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_arrays.h"
#include "tests/test.h"

enum { N = 300, CONSTRAINTS = 3 };

/* Points of a small lattice, with values; the first `places` of place[] are where points are, each once, in the order of the points. */
struct input {
    struct dt_point p[N], place[N];
    double z[N], value[N];            /* of points, of places */
    uint32_t of[N], first[N], places; /* the place of each point, the first point at each place */
};

static void draw(struct input *in, unsigned side)
{
    memset(in, 0, sizeof *in);
    for (uint32_t i = 0; i < N; i++) {
        in->p[i] = (struct dt_point){test_below(side), test_below(side)};
        in->z[i] = test_below(5) == 0 ? (double)NAN : test_below(40);
        uint32_t k = 0;
        while (k < in->places && (in->place[k].x != in->p[i].x || in->place[k].y != in->p[i].y))
            k++;
        in->of[i] = k;
        if (k < in->places)
            continue;
        in->first[k] = i;
        in->place[k] = in->p[i];
        in->value[in->places++] = in->z[i];
    }
}

static struct dt_thinning of_points(const struct input *in, double error, uint32_t most)
{
    return (struct dt_thinning){
        .point = in->p, .value = in->z, .n = N, .error = error, .most = most};
}

TEST(of_points_that_coincide_the_first_ones_are_thinned_out)
{
    static struct input in;
    for (unsigned round = 0; round < 60; round++) {
        draw(&in, 1 + test_below(30));
        struct dt_constraint all[CONSTRAINTS], places[CONSTRAINTS];
        uint32_t n = 0;
        for (uint32_t i = 0; i < CONSTRAINTS; i++) {
            uint32_t a = test_below(N), b = test_below(N);
            all[i] = (struct dt_constraint){a, b, false, 0};
            if (a == b)
                all[i].b = (b + 1) % N;
            places[n] = (struct dt_constraint){in.of[all[i].a], in.of[all[i].b], false, 0};
            n += places[n].a != places[n].b;
        }
        struct dt_thinning points = of_points(&in, test_below(20), UINT32_MAX);
        points.constraint = all;
        points.constraints = CONSTRAINTS;
        struct dt_thinning different = points;
        different.point = in.place;
        different.value = in.value;
        different.n = in.places;
        different.constraint = places;
        different.constraints = n;
        struct dt_thinned got, want;
        enum dt_status status = dt_thin(&different, NULL, &want);
        CHECK(dt_arrays_thin(&points, &got) == status);
        CHECK(got.n == want.n && got.least == want.least && got.error == want.error);
        for (uint32_t i = 0; i < got.n; i++)
            CHECK(got.kept[i] == in.first[want.kept[i]]);
        dt_pages_release(got.kept);
        dt_pages_release(want.kept);
    }
}

TEST(thinning_of_arrays_refuses_bad_input_and_keeps_nothing)
{
    static struct input in;
    draw(&in, 30);
    struct dt_thinned out;
    struct dt_thinning t = of_points(&in, 1, 2);
    CHECK(dt_arrays_thin(&t, &out) == DT_TOOBIG && out.least > 2 && out.kept == NULL);
    for (unsigned i = 0; i < 3; i++) {
        static const double wrong[] = {-1, (double)NAN, (double)INFINITY};
        t = of_points(&in, wrong[i], UINT32_MAX);
        CHECK(dt_arrays_thin(&t, &out) == DT_RANGE && out.kept == NULL);
    }
    t = of_points(&in, 1, UINT32_MAX);
    t.constraints = 1;
    t.constraint = &(struct dt_constraint){0, N, false, 0};
    CHECK(dt_arrays_thin(&t, &out) == DT_NOPOINT && out.kept == NULL);
    t.constraint = &(struct dt_constraint){7, 7, false, 0};
    CHECK(dt_arrays_thin(&t, &out) == DT_NOEDGE && out.kept == NULL);
    t.constraints = 0;
    in.z[5] = -(double)INFINITY;
    CHECK(dt_arrays_thin(&t, &out) == DT_RANGE && out.kept == NULL);
    in.z[5] = 0;
    in.p[9].y = 0x1p202;
    CHECK(dt_arrays_thin(&t, &out) == DT_RANGE && out.kept == NULL);
}

TEST(no_points_are_thinned_out_to_none)
{
    struct dt_thinned out;
    struct dt_thinning t = {.error = 1, .most = 5};
    CHECK(dt_arrays_thin(&t, &out) == DT_OK && out.n == 0 && out.least == 0);
    dt_pages_release(out.kept);
}

TEST(thinning_of_arrays_does_not_depend_on_the_rounding_mode)
{
    static struct input in;
    draw(&in, 25);
    struct dt_thinning t = of_points(&in, 3, UINT32_MAX);
    struct dt_thinned near, up;
    CHECK(dt_arrays_thin(&t, &near) == DT_OK);
    CHECK(fesetround(FE_UPWARD) == 0);
    CHECK(dt_arrays_thin(&t, &up) == DT_OK);
    CHECK(fegetround() == FE_UPWARD && fesetround(FE_TONEAREST) == 0);
    CHECK(near.n == up.n && near.error == up.error &&
          memcmp(near.kept, up.kept, near.n * sizeof near.kept[0]) == 0);
    dt_pages_release(near.kept);
    dt_pages_release(up.kept);
}
