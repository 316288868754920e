/* median_test.c - partition at the median: correct for all kinds of points, in bounded time for any
 * order. */
#include "core/divide/median.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/divide/divide.h"
#include "core/divide/part.h"
#include "tests/bench/pivots.h"
#include "tests/core/polls.h"
#include "tests/test.h"

static struct dt_point uniform(void)
{
    return (struct dt_point){test_uniform() - 0.5, test_uniform() - 0.5};
}

static struct dt_point lattice(void)
{
    return (struct dt_point){(int)test_below(9) - 4, (int)test_below(9) - 4};
}

static struct dt_point zeros(void)
{
    return (struct dt_point){test_below(2) ? 0.0 : -0.0, (int)test_below(3) - 1};
}

static struct dt_point any_exponent(void)
{
    double x = ldexp(0.5 + test_uniform() / 2, (int)test_below(343) - 141);
    double y = ldexp(0.5 + test_uniform() / 2, (int)test_below(343) - 141);
    return (struct dt_point){test_below(2) ? x : -x, test_below(2) ? y : -y};
}

static struct dt_point one_place(void)
{
    return (struct dt_point){3, 4};
}

static struct dt_point last_bits(void)
{
    return (struct dt_point){1 + test_below(5) * 0x1p-52, 1 + test_below(5) * 0x1p-52};
}

static bool before(unsigned axis, struct dt_point a, struct dt_point b)
{
    return axis == 0 ? dt_before_x(a, b) : dt_before_y(a, b);
}

/* from[] has moved with the points, and no point is lost. */
static void check_same_points(const struct dt_point *in, const struct dt_point *p,
                              const uint32_t *from, uint32_t n)
{
    bool *seen = calloc(n, sizeof *seen);
    for (uint32_t i = 0; i < n; i++) {
        CHECK(from[i] < n && !seen[from[i]] && memcmp(&p[i], &in[from[i]], sizeof *p) == 0);
        seen[from[i]] = true;
    }
    free(seen);
}

static void check_part(struct dt_point (*draw)(void), uint32_t n, unsigned axis)
{
    struct dt_point *in = calloc(n, sizeof *in), *p = calloc(n, sizeof *p);
    uint32_t *from = calloc(n, sizeof *from);
    struct dt_stop stop = {0};
    for (uint32_t i = 0; i < n; i++) {
        p[i] = in[i] = draw();
        from[i] = i;
    }
    dt_median_part(p, from, n, axis, &stop);
    check_same_points(in, p, from, n);
    uint32_t last = 0, first = n / 2; /* of the first half and of the second */
    for (uint32_t i = 0; i < n; i++) {
        if (i < n / 2 && before(axis, p[last], p[i]))
            last = i;
        if (i >= n / 2 && before(axis, p[i], p[first]))
            first = i;
    }
    CHECK(!before(axis, p[first], p[last]));
    free(in);
    free(p);
    free(from);
}

TEST(the_first_half_precedes_the_second_on_either_axis)
{
    struct dt_point (*const kinds[])(void) = {uniform,      lattice,   zeros,
                                              any_exponent, one_place, last_bits};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        for (unsigned axis = 0; axis < 2; axis++) {
            for (uint32_t n = 2; n < 40; n++)
                check_part(kinds[k], n, axis);
            check_part(kinds[k], 5000, axis);
        }
}

/* One point alone at each digit: no order and no values make more rounds. */
static struct dt_point *one_a_digit(uint32_t n)
{
    struct dt_point *p = malloc(n * sizeof *p);
    for (uint32_t i = 0; i < n; i++)
        p[i] = (struct dt_point){i < 64 ? ldexp(1, -(int)(i % 53)) + 1 : 1,
                                 i < 128 ? ldexp(1, -(int)(i % 53)) + 1 : 1};
    return p;
}

TEST(a_median_needs_a_bounded_number_of_passes_and_polls_in_each)
{
    enum { N = 10 * DT_POLL, ROUNDS = 12, PASSES = 3 };
    struct dt_point *hostile[2] = {malloc(N * sizeof **hostile), one_a_digit(N)};
    pivots_fill(hostile[0], N);
    for (int k = 0; k < 2; k++) {
        uint32_t *from = calloc(N, sizeof *from);
        struct dt_stop stop = {0};
        polls_begin();
        dt_median_part(hostile[k], from, N, 0, &stop);
        CHECK(polls_count() >= N / DT_POLL && polls_count() < ROUNDS * PASSES * (N / DT_POLL + 2));
        free(from);
        free(hostile[k]);
    }
}

TEST(a_median_stops_at_any_poll_and_loses_no_point)
{
    enum { N = 3 * DT_POLL };
    struct dt_point *in = malloc(N * sizeof *in), *p = malloc(N * sizeof *p);
    uint32_t *from = malloc(N * sizeof *from);
    bool stopped = true;
    for (uint32_t i = 0; i < N; i++)
        in[i] = any_exponent();
    for (uint64_t nth = 1; stopped; nth++) {
        struct dt_stop stop = {0};
        memcpy(p, in, N * sizeof *p);
        for (uint32_t i = 0; i < N; i++)
            from[i] = i;
        polls_begin();
        polls_cancel_at(nth);
        dt_median_part(p, from, N, 1, &stop);
        stopped = dt_stop_status(&stop) == DT_CANCELLED;
        CHECK(!stopped || polls_count() <= nth + 6);
        check_same_points(in, p, from, N);
    }
    polls_begin();
    free(in);
    free(p);
    free(from);
}

/* By pivots from the known sequence this took minutes. */
TEST(divide_is_as_fast_for_an_order_that_defeats_known_pivots)
{
    enum { N = 1000000 };
    struct dt_point *in = malloc(N * sizeof *in), *p = malloc(N * sizeof *p);
    uint32_t *from = malloc(N * sizeof *from);
    struct dt_mesh mesh = {0};
    pivots_fill(in, N);
    CHECK(dt_divide(in, NULL, N, p, from, &mesh, NULL) == DT_OK);
    dt_mesh_clear(&mesh);
    free(in);
    free(p);
    free(from);
}
