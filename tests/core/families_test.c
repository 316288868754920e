/* families_test.c - the point sets that all other tests rely on have the properties of their names. */
#include "tests/oracle/families.h"
#include "tests/test.h"

#include <math.h>
#include <string.h>

enum { N = 3000 };

static struct dt_point points[N], again[N];

static bool in_range(double v)
{
    return v == 0 || (fabs(v) >= 0x1p-142 && fabs(v) <= 0x1p201);
}

TEST(families_are_in_range_at_every_small_size)
{
    for (const struct family *f = families; f->name != NULL; f++)
        for (size_t n = 0; n <= 70; n++) {
            family_points(f, points, n, n);
            for (size_t i = 0; i < n; i++)
                CHECK_MSG(in_range(points[i].x) && in_range(points[i].y), "%s %zu", f->name, n);
        }
}

TEST(families_depend_on_the_seed_alone)
{
    for (const struct family *f = families; f->name != NULL; f++) {
        family_points(f, points, N, 7);
        memset(again, 0, sizeof again);
        family_points(f, again, N, 7);
        CHECK_MSG(memcmp(points, again, sizeof again) == 0, "%s", f->name);
    }
}

TEST(family_names_are_unique)
{
    for (const struct family *f = families; f->name != NULL; f++)
        CHECK_MSG(family_find(f->name) == f, "%s", f->name);
    CHECK(family_find("no such family") == NULL);
}

static int compare(const void *a, const void *b)
{
    const struct dt_point *p = a, *q = b;
    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    return p->y < q->y ? -1 : p->y > q->y;
}

TEST(exact_circle_is_exact_and_distinct)
{
    const int64_t radius = 125LL * 169 * 17 * 29 * 37 * 41 * 53 * 61;
    family_points(family_find("circle_exact"), points, N, 3);
    qsort(points, N, sizeof points[0], compare);
    for (int i = 0; i < N; i++) {
        __extension__ __int128 x = (int64_t)points[i].x, y = (int64_t)points[i].y, r = radius;
        CHECK(x * x + y * y == r * r);
        CHECK(i == 0 || compare(&points[i - 1], &points[i]) < 0);
    }
}

TEST(half_of_the_duplicates_coincide)
{
    int distinct = 1;
    family_points(family_find("duplicates"), points, N, 3);
    qsort(points, N, sizeof points[0], compare);
    for (int i = 1; i < N; i++)
        distinct += compare(&points[i - 1], &points[i]) != 0;
    CHECK(distinct == N / 2);
}
