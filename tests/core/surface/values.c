/* values.c - see values.h. */
#include "tests/core/surface/values.h"

#include "tests/core/sets.h"
#include "tests/test.h"

#include <math.h>
#include <string.h>

const enum dt_interpolation all_methods[METHODS + 1] = {DT_LINEAR, DT_NATURAL, DT_LAPLACE,
                                                        DT_CLOSEST, DT_SMOOTH};

/* Pages of values, by id; of the ids beyond them they are missing. */
enum { PAGES = 60 };
static double random_values[PAGES + 1][DT_FIELD_PAGE];

void make_values(void)
{
    for (int i = 0; i <= PAGES; i++)
        for (int k = 0; k < DT_FIELD_PAGE; k++)
            random_values[i][k] = i == PAGES ? (double)NAN : 1000 + test_uniform();
}

double value_of(uint32_t id)
{
    return random_values[id / DT_FIELD_PAGE][id % DT_FIELD_PAGE];
}

struct dt_surface surface_of(enum dt_interpolation how)
{
    static const double *page[PAGES + 1];
    for (int i = 0; i <= PAGES; i++)
        page[i] = random_values[i];
    return (struct dt_surface){.page = page, .pages = PAGES, .how = how, .max_edge = HUGE_VAL};
}

struct dt *set_with(const struct dt_point *p, const double *z, uint32_t n)
{
    uint32_t missing;
    struct dt *t = set_of(p, n);
    CHECK(dt_field_set_run(t, "z", 1, 0, z, n, NULL, &missing) == DT_OK);
    return t;
}

struct dt_surface surface_in(const struct dt *t, enum dt_interpolation how)
{
    struct dt_surface s = {.how = how, .max_edge = HUGE_VAL};
    CHECK(dt_surface_begin(&s, dt_field_find(t, "z", 1), NULL) == DT_OK);
    return s;
}

double value_at(const struct dt *t, const struct dt_surface *s, struct dt_point q)
{
    double value;
    size_t done;
    CHECK(dt_values(t, s, &q, 1, NULL, &value, &done) == DT_OK && done == 1);
    return value;
}

void check_same(double got, double want, struct dt_point q)
{
    CHECK_MSG(memcmp(&got, &want, sizeof got) == 0 || (isnan(got) && isnan(want)),
              "%.17g instead of %.17g at %.17g %.17g", got, want, q.x, q.y);
}

/* The value of the field z at x y. */
double value_in(const struct dt *t, enum dt_interpolation how, double max_edge, double x, double y)
{
    struct dt_surface s = surface_in(t, how);
    s.max_edge = max_edge;
    double value = value_at(t, &s, (struct dt_point){x, y});
    dt_surface_end(&s);
    return value;
}
