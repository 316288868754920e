/* engines_test.c - two engines that share nothing but the predicates make the same triangles. */
#include <stdlib.h>
#include <string.h>

#include "core/divide/divide.h"
#include "core/shelling/shelling.h"
#include "tests/oracle/definition.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

typedef enum dt_status engine(const struct dt_point *in, uint32_t n, struct dt_point *p,
                              uint32_t *from, struct dt_mesh *m, const struct dt_options *opt);

/* The canonical triangles that the engine makes of n points; *count triangles, *ghosts ghosts. */
static struct triangle *triangles_of(engine *run, const struct dt_point *in, uint32_t n,
                                     uint32_t *count, uint32_t *ghosts)
{
    struct dt_mesh m = {.half = NULL};
    struct dt_point *p = malloc((n + 1) * sizeof *p);
    uint32_t *from = malloc((n + 1) * sizeof *from);
    struct triangle *t = malloc((2 * n + 1) * sizeof *t);
    CHECK(run(in, n, p, from, &m, NULL) == DT_OK);
    *count = mesh_triangles(&m, from, t);
    *ghosts = m.ghosts;
    dt_mesh_clear(&m);
    free(p);
    free(from);
    return t;
}

static void see_nothing(void *ctx, const struct dt_event *e)
{
    (void)ctx, (void)e;
}

static enum dt_status divide(const struct dt_point *in, uint32_t n, struct dt_point *p,
                             uint32_t *from, struct dt_mesh *m, const struct dt_options *opt)
{
    return dt_divide(in, NULL, n, p, from, m, opt);
}

/* With an observer it is not abandoned. */
static enum dt_status shelling_to_the_end(const struct dt_point *in, uint32_t n, struct dt_point *p,
                                          uint32_t *from, struct dt_mesh *m,
                                          const struct dt_options *opt)
{
    return dt_shelling_observed(in, n, p, from, m, opt, &(struct dt_observer){see_nothing, NULL});
}

static void compare(const char *name, const struct dt_point *in, uint32_t n)
{
    uint32_t divided, shelled, ghosts[2];
    struct triangle *a = triangles_of(divide, in, n, &divided, &ghosts[0]);
    struct triangle *b = triangles_of(shelling_to_the_end, in, n, &shelled, &ghosts[1]);
    CHECK_MSG(divided == shelled && memcmp(a, b, divided * sizeof *a) == 0, "%s, %u points", name,
              n);
    CHECK(ghosts[0] == ghosts[1]);
    free(a);
    free(b);
}

static void compare_family(const struct family *f, uint32_t n)
{
    struct dt_point *in = malloc((n + 1) * sizeof *in);
    family_points(f, in, n, test_random());
    compare(f->name, in, keep_distinct(in, n));
    free(in);
}

TEST(engines_agree_on_tiny_sets_of_every_family)
{
    for (const struct family *f = families; f->name != NULL; f++)
        for (uint32_t n = 0; n <= 12; n++)
            compare_family(f, n);
}

TEST_TIMEOUT(engines_agree_on_every_family, 60)
{
    for (const struct family *f = families; f->name != NULL; f++)
        for (uint32_t n = 40; n <= (f->hostile ? 700 : 10000); n *= 4)
            compare_family(f, n);
}

TEST(engines_agree_on_random_lattices)
{
    for (unsigned round = 0; round < 300; round++) {
        struct dt_point in[100];
        uint32_t width = 1 + test_below(12), height = 1 + test_below(12);
        for (uint32_t i = 0; i < 100; i++)
            in[i] = (struct dt_point){test_below(width), test_below(height)};
        compare("lattice", in, keep_distinct(in, 1 + test_below(100)));
    }
}

/* Lattices that are sheared, stretched and shifted: ties turn into near-ties, lines into
 * near-lines. */
TEST(engines_agree_on_lattices_under_rounded_maps)
{
    for (unsigned round = 0; round < 300; round++) {
        struct dt_point in[150];
        double a = test_uniform(), b = test_uniform(), c = test_uniform() * 1e3,
               s = test_below(2) ? 1e-9 : 1;
        for (uint32_t i = 0; i < 150; i++) {
            double x = test_below(13), y = test_below(13);
            in[i] = (struct dt_point){x * a - y * b * s + c, x * b * s + y * a + c};
        }
        compare("mapped lattice", in, keep_distinct(in, 150));
    }
}

static struct dt_ids triangles_by(const struct dt_point *p, uint32_t n, enum dt_method method)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    struct dt_options opt = {.method = method};
    struct dt_cursor c;
    struct dt_ids out = {.v = malloc(6 * n * sizeof(uint32_t))};
    size_t rows;
    CHECK(dt_add(t, p, n, &added) == DT_OK && dt_triangulate(t, &opt) == DT_OK);
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    CHECK(dt_table_begin(t, NULL, DT_TRIANGLES, false, &c) == DT_OK);
    CHECK(dt_table_read(t, &c, out.v, 6 * n, SIZE_MAX, &rows, &out.n) == DT_OK && rows == c.rows);
    dt_free(t);
    return out;
}

TEST(a_set_gives_the_same_table_by_either_method)
{
    enum { POINTS = 2000 };
    struct dt_point p[POINTS];
    family_points(family_find("duplicates"), p, POINTS, test_random());
    struct dt_ids a = triangles_by(p, POINTS, DT_DIVIDE), b = triangles_by(p, POINTS, DT_SHELLING);
    CHECK(a.n == b.n && a.n > POINTS && memcmp(a.v, b.v, a.n * sizeof *a.v) == 0);
    free(a.v);
    free(b.v);
}

/* 20,000 points that are nearly on a line: without a limit, 4 * 10^8 close looks. */
TEST_TIMEOUT(set_that_defeats_the_grid_gets_its_triangles_by_shelling_too, 30)
{
    enum { POINTS = 20000 };
    struct dt_point *p = malloc(POINTS * sizeof *p);
    for (uint32_t i = 0; i < POINTS; i++)
        p[i] = (struct dt_point){i * 0.1, i * 0.3}; /* rounded: no straight line */
    struct dt_mesh m = {.half = NULL};
    struct dt_point *q = malloc(POINTS * sizeof *q);
    uint32_t *from = malloc(POINTS * sizeof *from);
    CHECK(dt_shelling(p, POINTS, q, from, &m, NULL) == DT_TOOBIG);
    CHECK(m.half == NULL && m.vertices == 0);
    struct dt_ids a = triangles_by(p, POINTS, DT_DIVIDE), b = triangles_by(p, POINTS, DT_SHELLING);
    CHECK(a.n == b.n && a.n > POINTS && memcmp(a.v, b.v, a.n * sizeof *a.v) == 0);
    free(a.v);
    free(b.v);
    free(q);
    free(from);
    free(p);
}
