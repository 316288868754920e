/* sets.c - see sets.h. */
#include "tests/core/sets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/oracle/families.h"
#include "tests/test.h"

struct dt *set_of(const struct dt_point *p, uint32_t n)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(t != NULL && dt_add(t, p, n, &added) == DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_OK && dt_prepare(t, NULL) == DT_OK);
    return t;
}

struct dt *set_of_each(const struct dt_point *p, uint32_t n)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(t != NULL && dt_triangulate(t, NULL) == DT_OK);
    for (uint32_t i = 0; i < n; i++)
        CHECK(dt_add(t, &p[i], 1, &added) == DT_OK);
    CHECK(dt_refresh(t, NULL) == DT_OK);
    return t;
}

struct pair pair_of(const struct dt_point *p, uint32_t n)
{
    return (struct pair){set_of(p, n), brute_new(p, NULL, n)};
}

void pair_free(struct pair *pair)
{
    dt_free(pair->t);
    brute_free(pair->b);
}

/* About a third of the ids of a set deleted again. */
static struct pair pair_with_holes(const struct dt_point *p, uint32_t n)
{
    struct pair pair = {.t = set_of(p, n)};
    bool live[256];
    uint32_t deleted, missing;
    for (uint32_t i = 0; i < n; i++) {
        live[i] = test_below(3) != 0;
        CHECK(live[i] || dt_delete(pair.t, &i, 1, &deleted, &missing) == DT_OK);
    }
    CHECK(dt_refresh(pair.t, NULL) == DT_OK);
    pair.b = brute_new(p, live, n);
    return pair;
}

void for_each_pair(void (*test)(const struct pair *pair))
{
    static const uint32_t sizes[] = {0, 1, 2, 3, 4, 5, 7, 12, 25, 60};
    struct dt_point p[64];
    for (const struct family *f = families; f->name != NULL; f++) {
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            family_points(f, p, sizes[i], test_random());
            struct pair pair = pair_of(p, sizes[i]), holes = pair_with_holes(p, sizes[i]);
            test(&pair);
            test(&holes);
            pair_free(&pair);
            pair_free(&holes);
        }
    }
}

const char *const table_names[6] = {"POINTS", "COINCIDENT", "LISTS", "TRIANGLES", "EDGES", "HULL"};

void append_ids(struct dt_ids *ids, const uint32_t *v, size_t n)
{
    if (n == 0)
        return;
    if (ids->n + n > ids->cap) {
        ids->cap = 2 * (ids->n + n);
        ids->v = realloc(ids->v, ids->cap * sizeof *ids->v);
        CHECK(ids->v != NULL);
    }
    memcpy(ids->v + ids->n, v, n * sizeof *v);
    ids->n += n;
}

static void print_ids(const char *what, const struct dt_ids *ids)
{
    fprintf(stderr, "%s:", what);
    for (size_t i = 0; i < ids->n; i++)
        fprintf(stderr, " %u", ids->v[i]);
    fprintf(stderr, "\n");
}

void check_equal_ids(const char *what, const struct dt_ids *got, const struct dt_ids *want)
{
    if (got->n == want->n && (got->n == 0 || memcmp(got->v, want->v, got->n * sizeof *got->v) == 0))
        return;
    print_ids("got ", got);
    print_ids("want", want);
    test_fail(__FILE__, __LINE__, "%s", what);
}

static double valid(double v)
{
    return dt_coordinate_ok(v) ? v : 0;
}

struct dt_point random_place(const struct brute *b)
{
    if (b->n == 0)
        return (struct dt_point){test_uniform(), test_uniform()};
    struct dt_point p = b->p[test_below(b->n)], q = b->p[test_below(b->n)];
    switch (test_below(6)) {
    case 0:
        return p;
    case 1:
        return (struct dt_point){valid(p.x / 2 + q.x / 2), valid(p.y / 2 + q.y / 2)};
    case 2:
        return (struct dt_point){valid(nextafter(p.x, q.x)), valid(nextafter(p.y, q.y))};
    case 3:
        return (struct dt_point){p.x, q.y};
    case 4:
        return (struct dt_point){valid(2 * p.x - q.x), valid(2 * p.y - q.y)};
    }
    double u = test_uniform(), v = test_uniform();
    return (struct dt_point){valid(p.x + (q.x - p.x) * u), valid(p.y + (q.y - p.y) * v)};
}
