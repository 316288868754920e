/* triangulate_test.c - dt_triangulate in two steps. */
#include "core/delaunay.h"
#include "tests/test.h"

#include <string.h>

enum { POINTS = 5000 };

/* A set of points that come together, not triangulated yet. */
static struct dt *loaded(void)
{
    static struct dt_point p[POINTS];
    struct dt *t = dt_new(0);
    struct dt_added added;
    for (int i = 0; i < POINTS; i++)
        p[i] = (struct dt_point){test_below(70), test_below(70)}; /* many coincide */
    CHECK(dt_add(t, p, POINTS, &added) == DT_OK);
    return t;
}

static struct dt_summary summary_of(const struct dt *t)
{
    struct dt_summary sum;
    dt_summary(t, &sum);
    return sum;
}

TEST(build_in_two_steps_is_that_in_one)
{
    struct dt *t = loaded(), *other;
    struct dt_build *b;
    CHECK(dt_clone(t, &other) == DT_OK && dt_triangulate(other, NULL) == DT_OK);
    CHECK(dt_build_suits(t, NULL) && !dt_build_suits(other, NULL));
    CHECK(!dt_build_suits(t, &(struct dt_options){.method = DT_SHELLING}));
    CHECK(dt_build(t, NULL, &b) == DT_OK && !summary_of(t).triangulated);
    dt_build_free(b);
    CHECK(dt_build(t, NULL, &b) == DT_OK);
    dt_built(t, b);
    CHECK(dt_check(t, NULL, NULL) == DT_OK && !dt_build_suits(t, NULL));
    struct dt_summary got = summary_of(t), want = summary_of(other);
    CHECK(got.triangulated && got.current && got.coincident == want.coincident);
    CHECK(got.triangles == want.triangles && got.edges == want.edges && got.hull == want.hull);
    dt_free(t);
    dt_free(other);
}

TEST(build_without_memory_leaves_the_set_as_it_was)
{
    struct dt *t = loaded();
    struct dt_build *b = NULL;
    enum dt_status status = DT_NOMEM;
    for (long n = 1; status == DT_NOMEM; n++) {
        test_fail_alloc(n);
        status = dt_build(t, NULL, &b);
        CHECK(test_alloc_failed() == (status == DT_NOMEM) && (b == NULL) == (status == DT_NOMEM));
        CHECK(!summary_of(t).triangulated && dt_build_suits(t, NULL));
    }
    test_fail_alloc(0);
    dt_built(t, b);
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
}
