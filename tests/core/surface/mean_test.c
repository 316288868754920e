/* mean_test.c - values between points, against the weights of the definition in exact arithmetic. */
#include "core/delaunay_surface.h"
#include "tests/core/sets.h"
#include "tests/oracle/voronoi.h"
#include "tests/test.h"

#include <math.h>

enum { FEW = 80 }; /* points: the definition takes long */

static double value_of_id[DT_FIELD_PAGE];

static void check_mean(const struct dt *t, struct dt_point q, enum dt_interpolation how)
{
    static const double *page[] = {value_of_id};
    struct dt_surface s = {.page = page, .pages = 1, .how = how, .max_edge = HUGE_VAL};
    struct dt_point p[FEW];
    double z[FEW], weight[FEW], least = HUGE_VAL, most = -HUGE_VAL, sum = 0, got;
    uint32_t n = 0;
    size_t done;
    for (uint32_t id = 0, rep; id < dt_next_id(t); id++)
        if (dt_representative(t, id, &rep) == DT_OK && rep == id) {
            CHECK(dt_get(t, id, &p[n]) == DT_OK);
            z[n++] = value_of_id[id];
        }
    voronoi_weights(p, n, q, how, weight);
    for (uint32_t i = 0; i < n; i++) {
        least = weight[i] > 0 ? fmin(least, z[i]) : least;
        most = weight[i] > 0 ? fmax(most, z[i]) : most;
        sum += weight[i] * z[i];
    }
    CHECK(dt_values(t, &s, &q, 1, NULL, &got, &done) == DT_OK && done == 1);
    CHECK_MSG(fabs(got - sum) <= DT_WEIGHTS_ERROR * (most - least) + 0x1p-51 * most, "off by %g",
              fabs(got - sum));
}

static void check_means(const struct pair *pair)
{
    if (dt_next_id(pair->t) > FEW)
        return;
    for (int i = 0; i < FEW; i++)
        value_of_id[i] = test_uniform();
    for (int i = 0; i < (test_is_sanitized() ? 1 : 4); i++) { /* the definition takes long */
        struct dt_point q = random_place(pair->b);
        struct dt_location at;
        CHECK(dt_locate(pair->t, q, &at) == DT_OK);
        if (at.where != DT_INSIDE)
            continue;
        check_mean(pair->t, q, DT_NATURAL);
        check_mean(pair->t, q, DT_LAPLACE);
    }
}

TEST_TIMEOUT(means_are_those_of_the_definition_on_every_family, 240)
{
    for_each_pair(check_means);
}
