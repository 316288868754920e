/* histogram_test.c - quantiles against a sorted list. */
#include "server/ops/histogram.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

TEST(histogram_without_counts_returns_zero)
{
    static struct histogram h;
    CHECK(histogram_quantile(&h, 0.5) == 0 && histogram_quantile(&h, 1) == 0);
}

TEST(histogram_keeps_small_values_exactly)
{
    static struct histogram h;
    for (uint64_t v = 1; v <= 60; v++)
        histogram_add(&h, v, 1);
    CHECK(histogram_quantile(&h, 0.5) == 30 && histogram_quantile(&h, 0) == 1);
    CHECK(histogram_quantile(&h, 1) == 60 && h.max == 60 && h.total == 60);
}

TEST(histogram_quantiles_are_right_to_three_per_cent)
{
    enum { N = 20000 };
    static struct histogram h;
    static uint64_t v[N];
    for (int i = 0; i < N; i++) {
        v[i] = test_random() >> (24 + test_below(40));
        histogram_add(&h, v[i], 1);
    }
    qsort(v, N, sizeof v[0], by_value);
    for (int percent = 1; percent <= 100; percent++) {
        double share = percent / 100.0; /* 0.28 * 20000 is 5600.000000000001: value 5601 */
        uint64_t want = v[(size_t)ceil(share * N) - 1];
        uint64_t got = histogram_quantile(&h, share);
        CHECK_MSG(got >= want && got - want <= want / 32 + 1, "%d %%: %llu, not %llu", percent,
                  (unsigned long long)got, (unsigned long long)want);
    }
}

TEST(histogram_counts_many_at_once)
{
    static struct histogram h;
    histogram_add(&h, 5, 99);
    histogram_add(&h, 50, 1);
    CHECK(h.total == 100 && histogram_quantile(&h, 0.99) == 5 && histogram_quantile(&h, 1) == 50);
}

TEST(histogram_accepts_any_value)
{
    static struct histogram h;
    histogram_add(&h, UINT64_MAX, 1);
    histogram_add(&h, (uint64_t)1 << 50, 1);
    histogram_add(&h, 0, 2);
    CHECK(histogram_quantile(&h, 0.5) == 0 && histogram_quantile(&h, 1) == UINT64_MAX);
}
