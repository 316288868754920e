/* levels_test.c - the levels of contours at equal steps: b + k step, rounded once, and compared after that. */
#include "core/delaunay_surface.h"
#include "core/exact/bignum.h"
#include "tests/test.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { CAP = 10000 };

/* The levels that Python's fractions give: their number, the first, the last, and a hash of all. */
static const struct expected {
    double least, most, step, base;
    size_t n;
    double first, last;
    uint64_t hash;
} table[] = {
    {0x0.0p+0, 0x1.4a3d70a3d70a4p+0, 0x1.47ae147ae147bp-7, 0x1.999999999999ap-4, 130,
     0x1.0000000000000p-58, 0x1.4a3d70a3d70a4p+0, 0x54d3010b87ba740c},
    {0x0.0p+0, 0x1.1333333333333p+2, 0x1.999999999999ap-4, 0x0.0p+0, 44, 0x0.0p+0,
     0x1.1333333333333p+2, 0x651b6c56309cfbe7},
    {0x0.0p+0, 0x1.0000000000000p+0, 0x1.0000000000000p-2, 0x1.6345785d8a000p+56, 5, 0x0.0p+0,
     0x1.0000000000000p+0, 0xc1e8000000000000},
    {0x1.6345785d8a000p+56, 0x1.6345785d8a03ep+56, 0x1.0000000000000p-2, 0x1.6345785d8a000p+56, 63,
     0x1.6345785d8a000p+56, 0x1.6345785d8a03ep+56, 0x4a94efd608c1e83f},
    {0x1.6345785d8a000p+56, 0x1.6345785d8a00ap+56, 0x1.3333333333333p-2, -0x1.8000000000000p+1, 11,
     0x1.6345785d8a000p+56, 0x1.6345785d8a00ap+56, 0xd7c2c708242ca6bb},
    {-0x1.0000000000000p+1, 0x1.0000000000000p+1, 0x1.6666666666666p-1, 0x1.7e43c8800759cp+996, 6,
     -0x1.b88fc7e9b3d24p+0, 0x1.c77038164c2dbp+0, 0x45bf616a08ea2e56},
    {0x1.3333333333333p-2, 0x1.3333333333333p-2, 0x1.999999999999ap-4, 0x0.0p+0, 0, 0x0.0p+0,
     0x0.0p+0, 0x0000000000000000},
    {0x1.3333333333334p-2, 0x1.3333333333334p-2, 0x1.999999999999ap-4, 0x0.0p+0, 1,
     0x1.3333333333334p-2, 0x1.3333333333334p-2, 0xa71334000000015c},
    {0x0.0000000000001p-1022, 0x0.000000000000ap-1022, 0x0.0000000000001p-1022,
     0x1.7e43c8800759cp+996, 10, 0x0.0000000000001p-1022, 0x0.000000000000ap-1022,
     0x131e08d87d18c6bb},
    {-0x1.e42d130773b76p+1023, 0x1.e42d130773b76p+1023, 0x1.1ccf385ebc8a0p+1023,
     0x1.ab36d48e1acf0p+1023, 4, -0x1.ab36d48e1acf0p+1023, 0x1.ab36d48e1acf0p+1023,
     0x33b901b2ecf49e60},
    {0x1.fffffffffffffp+1023, 0x1.fffffffffffffp+1023, 0x1.008896bcf54fap+970, 0x0.0p+0, 1,
     0x1.fffffffffffffp+1023, 0x1.fffffffffffffp+1023, 0x64cffefffffffe4d},
    {0x1.0000000000000p+0, 0x1.0000000000010p+0, 0x1.0000000000000p-53, 0x0.0p+0, 17,
     0x1.0000000000000p+0, 0x1.0000000000010p+0, 0x1d34e1c0710adc70},
    {0x1.2e4738d8608fep+241, 0x1.2e4738d8608fep+241, 0x1.f767c482c9b00p+64, -0x1.199e84e56b1f0p-394,
     1, 0x1.2e4738d8608fep+241, 0x1.2e4738d8608fep+241, 0xc7f32e597ac1479a},
    {-0x1.8c13bc5069136p+179, -0x1.8c13bc5069136p+179, 0x1.3119920d46410p-142,
     -0x1.e86a62e9982d8p-695, 1, -0x1.8c13bc5069136p+179, -0x1.8c13bc5069136p+179,
     0x3cd18e8fca28bec2},
    {0x1.d976d9377b9a8p+115, 0x1.d976d9377b9a8p+115, 0x1.2edcf47fa8468p-290, 0x1.aa5670ef08e64p+667,
     1, 0x1.d976d9377b9a8p+115, 0x1.d976d9377b9a8p+115, 0x6a31f73194707878},
    {-0x1.71e6f430e7cb8p+154, -0x1.71e6f430e7cb8p+154, 0x1.c4dd61ae485b8p-230,
     -0x1.fe2ebb038a73cp+883, 1, -0x1.71e6f430e7cb8p+154, -0x1.71e6f430e7cb8p+154,
     0x9a456f0ef19deca8},
    {0x1.d72b8efdbff98p-132, 0x1.1536bdd2c2bb0p-75, 0x1.fa8f31653088ap-81, -0x1.af80c5afb48b8p-495,
     35, 0x1.fa8f31653088ap-81, 0x1.15064f03568abp-75, 0x33b138953c476e3e},
    {-0x1.45f8a6078e194p-100, 0x1.843c80911bb03p-90, 0x1.4151938125520p-95, 0x1.933104b10d77ap-290,
     39, 0x1.933104b10d77ap-290, 0x1.7d90df295c516p-90, 0x5547ae784b572bf6},
    {-0x1.560f9d8837f24p-152, 0x1.59a74365a2d18p+127, 0x1.e9e97fd1c4874p+123,
     -0x1.585cacb2da218p+772, 11, 0x1.875cde26ae648p+122, 0x1.3e6cd6d45047bp+127,
     0x2e6d2c508d87f291},
    {0x1.8921395b1a328p+43, 0x1.8921395b1a328p+43, 0x1.a656ab2c1ab50p-300, -0x1.283d8c2e75998p-276,
     1, 0x1.8921395b1a328p+43, 0x1.8921395b1a328p+43, 0xf6135f475cd83cf8},
    {-0x1.42cacdc2676fap+182, -0x1.42cacdc2676fap+182, 0x1.3b788a6dbb740p+18,
     -0x1.c5a18c5f356f2p-855, 1, -0x1.42cacdc2676fap+182, -0x1.42cacdc2676fap+182,
     0xa67ee3ba155c2ace},
    {0x1.612874b3bfe88p-283, 0x1.423242f83ce4bp+70, 0x1.cc0073dff9488p+65, -0x1.4c7bcf4483780p-133,
     22, 0x1.cc0073dff9488p+65, 0x1.3c404fa9fb61dp+70, 0xc0b438b40edacfd6},
    {-0x1.827ae7d026c50p-119, -0x1.827ae7d026c50p-119, 0x1.419cf5aeb63c0p-294,
     0x1.d14cc919279f4p-658, 1, -0x1.827ae7d026c50p-119, -0x1.827ae7d026c50p-119,
     0x91c7bd7e6b1e0bf0},
    {-0x1.3eb4bf7ccd0fcp+61, 0x1.2519b2af27af1p+177, 0x1.05dfc41f7fc58p+172, -0x1.fe2b4f397214cp+45,
     36, -0x1.fe2b4f397214cp+45, 0x1.1e6cbe8273c00p+177, 0x7c78fc959a21ad1c},
    {0x1.1fbb18660b860p-8, 0x1.b10fd23b795d2p+21, 0x1.915a96b482a26p+16, -0x1.da7d404894386p-50, 34,
     0x1.915a96b482a26p+16, 0x1.aa70401fcacc8p+21, 0xa33ecd0ffb5e9f03},
    {0x1.c5f318b9aa0c0p+25, 0x1.c5f320a178ce2p+25, 0x1.2a835454629d4p+1, -0x1.cb6a2f1367c90p+27, 7,
     0x1.c5f318c5404c0p+25, 0x1.c5f31fc454460p+25, 0x0b772ff51bd0ca6e},
    {0x1.7cdba75119cdcp-13, 0x1.1650296c09c94p-11, 0x1.71d1e85e48790p-15, -0x1.afed53afc4d42p-42, 8,
     0x1.ce4662685b2cap-13, 0x1.155d6e4356802p-11, 0xd11e094f5be6e9ec},
    {0x1.fca5f43decf44p-21, 0x1.9bb1297fb47d8p-8, 0x1.c4e272b06dbecp-13, -0x1.ad194901b3d80p+15, 30,
     0x1.dfc9760f63c80p-18, 0x1.9ae52a4d674ddp-8, 0x51220dfaad830c8d},
    {-0x1.df68e0e19ef46p+16, -0x1.df68d3ead4487p+16, 0x1.12af0fb1c5fc0p-9, 0x1.4e20692006d80p-3, 25,
     -0x1.df68e0d4eef60p+16, -0x1.df68d3f4ba39bp+16, 0xe7f31379098ddbb3},
    {-0x1.c6f4af02ae784p+27, -0x1.c6f4af02ae707p+27, 0x1.352de46bf8490p-23, 0x1.34e7853f2d1c8p-19,
     26, -0x1.c6f4af02ae782p+27, -0x1.c6f4af02ae709p+27, 0xea3108c22c3911fd},
    {0x1.ecda08dda72e0p+5, 0x1.ecda0c15a0393p+5, 0x1.5a8d349a80f04p-23, 0x1.0b0ec8e580c34p+38, 38,
     0x1.ecda08eaac0f6p+5, 0x1.ecda0c0c12990p+5, 0xed1a6e23c9390b2f},
    {-0x1.0c0fdb4106748p-24, 0x1.01009b1abc55ap-21, 0x1.60fbbfc967b68p-23, -0x1.4508e3690e480p-45,
     3, -0x1.4508e3690e480p-45, 0x1.60fbbd3f55efbp-22, 0x2dff3940874d9943},
    {0x1.68b4ec95ab4aap+2, 0x1.c30b943cff885p+9, 0x1.7fc1444fde5c0p+5, -0x1.840184fa83ec0p+27, 19,
     0x1.6f0ace19f5200p+3, 0x1.b575981241fc0p+9, 0x3adede20a3c44d20},
    {-0x1.abfc5587a8c88p-7, -0x1.773b763b4ca31p-7, 0x1.755885855d798p-15, -0x1.8cbcfacfbe70ap+44,
     36, -0x1.ab22a449af35ap-7, -0x1.78178a08736e0p-7, 0x9d12090b71903fff},
    {0x1.040635efe8b38p-1, 0x1.040eb82bfc7eap-1, 0x1.f41be7c41071cp-20, -0x1.478e8b7497254p+1, 35,
     0x1.040669516569ep-1, 0x1.040eb6c7fe6b2p-1, 0x8c57835731831e9d},
    {0x1.8a0a1f78343f0p-2, 0x1.b7d6782fa461ep+22, 0x1.d24f107c1d3d0p+18, 0x1.24e31a65c7888p+38, 15,
     0x1.11627bde4e9a0p+17, 0x1.a090424b8c0a3p+22, 0xbd03499a52edeecf},
};

static uint64_t hash_of(const double *level, size_t n)
{
    uint64_t h = 0, bits;
    for (size_t i = 0; i < n; i++) {
        memcpy(&bits, &level[i], sizeof bits);
        h = (h ^ bits) * 0x100000001b3u;
    }
    return h;
}

TEST(levels_are_those_of_exact_fractions_rounded_once)
{
    static double level[CAP];
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const struct expected *e = &table[i];
        size_t n = dt_levels_every(e->least, e->most, e->step, e->base, level, CAP);
        CHECK_MSG(n == e->n, "case %zu: %zu levels", i, n);
        CHECK_MSG(n == 0 || (level[0] == e->first && level[n - 1] == e->last),
                  "case %zu: %.17g to %.17g", i, level[0], level[n - 1]);
        CHECK_MSG(hash_of(level, n) == e->hash, "case %zu", i);
    }
}

TEST(a_level_that_equals_the_least_or_the_greatest_value_after_rounding_is_one)
{
    static double level[CAP];
    for (unsigned k = 1; k < 400; k++) {
        double end = fma(k, 0.01, 0.1);
        size_t n = dt_levels_every(0, end, 0.01, 0.1, level, CAP);
        CHECK_MSG(n > 0 && level[n - 1] == end, "%u: %.17g", k, end);
        n = dt_levels_every(end, end, 0.01, 0.1, level, CAP);
        CHECK_MSG(n == 1 && level[0] == end, "%u: %.17g", k, end);
        CHECK(dt_levels_every(nextafter(end, 1e9), end + 0.005, 0.01, 0.1, level, CAP) == 0);
        CHECK(dt_levels_every(end - 0.005, nextafter(end, 0), 0.01, 0.1, level, CAP) == 0);
    }
}

TEST(more_levels_than_fit_are_refused_however_many_they_are)
{
    double level[4];
    CHECK(dt_levels_every(0, 3, 1, 0, level, 4) == 4 && level[3] == 3);
    CHECK(dt_levels_every(0, 4, 1, 0, level, 4) == 5);
    CHECK(dt_levels_every(0, 1, 5e-324, 1e300, level, 4) == 5);
    CHECK(dt_levels_every(-DBL_MAX, DBL_MAX, DBL_MIN, 0, level, 4) == 5);
    CHECK(dt_levels_every(0x1p60, 0x1p60 + 1024, 1, 0, level, 4) ==
          5); /* though few after rounding */
    CHECK(dt_levels_every((double)NAN, (double)NAN, 1, 0, level, 4) == 0);
}

/* dt_levels_every finds the same from the first to the last of them. */
TEST(levels_around_values_are_the_same_and_one_more_on_each_side)
{
    static double level[CAP], same[CAP];
    size_t checked = 0;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const struct expected *e = &table[i];
        size_t n = dt_levels_around(e->least, e->most, e->step, e->base, level, CAP);
        if (n > CAP) {
            CHECK(e->n + 2 > CAP);
            continue;
        }
        CHECK(n >= 2 && level[0] <= e->least && level[n - 1] > e->most);
        CHECK(n == 2 || (level[1] > e->least && level[n - 2] <= e->most));
        if (isinf(level[n - 1]) || isinf(level[0]) ||
            dt_levels_every(level[0], level[n - 1], e->step, e->base, same, CAP) > CAP)
            continue;
        checked++;
        CHECK_MSG(dt_levels_every(level[0], level[n - 1], e->step, e->base, same, CAP) == n,
                  "%zu levels around %a .. %a, from %a to %a", n, e->least, e->most, level[0],
                  level[n - 1]);
        CHECK(memcmp(level, same, n * sizeof *level) == 0);
    }
    CHECK(checked > 10);
    CHECK(dt_levels_around(1, 1, 1e-300, 0, level, CAP) == 2 && level[0] == 1 &&
          level[1] == nextafter(1, 2));
    CHECK(dt_levels_around(0, 4, 2, 0, level, CAP) == 4 && level[0] == 0 && level[3] == 6);
    CHECK(dt_levels_around(0.5, 3.5, 2, 0, level, CAP) == 3 && level[0] == 0 && level[2] == 4);
    CHECK(dt_levels_around(0, 4, 2, 0, level, 3) == 4);
    CHECK(dt_levels_around(0, DBL_MAX, 0x1p1023, 0, level, CAP) == 3 && isinf(level[2]));
    CHECK(dt_levels_around((double)NAN, (double)NAN, 1, 0, level, CAP) == 0);
}

TEST(a_bignum_is_rounded_to_the_nearest_double_ties_to_even)
{
    for (int power = -1074; power <= 971; power++) {
        double unit = ldexp(1, power), odd = ldexp(0x1.0000000000001p52, power);
        struct dt_big a, half, tiny;
        if (isinf(odd))
            break;
        half = dt_big_of(
            unit); /* half a unit, and a 64th of the least: by products, since there may be no such double */
        a = dt_big_of(0.5);
        half = dt_big_multiply(half, a);
        a = dt_big_of(0x1p-200);
        tiny = dt_big_multiply(half, a);
        a = dt_big_of(odd);
        CHECK(dt_big_nearest(a) == odd);
        a = dt_big_add(a, half); /* the tie goes up, to the even one */
        CHECK(dt_big_nearest(a) == odd + unit);
        a = dt_big_subtract(a, tiny);
        CHECK(dt_big_nearest(a) == odd);
        a = dt_big_of(odd + unit);
        a = dt_big_add(a, half); /* the tie goes down */
        CHECK(dt_big_nearest(a) == odd + unit);
        a = dt_big_add(a, tiny);
        CHECK(dt_big_nearest(a) == odd + 2 * unit);
        a.sign = -1;
        CHECK(dt_big_nearest(a) == -(odd + 2 * unit));
    }
}

TEST(a_bignum_beyond_the_largest_double_is_infinite_from_halfway_to_the_next_power_on)
{
    struct dt_big a, half, tiny;
    a = dt_big_of(DBL_MAX);
    half = dt_big_of(0x1p970);
    tiny = dt_big_of(1);
    CHECK(dt_big_nearest(a) == DBL_MAX);
    a = dt_big_add(a, half);
    CHECK(dt_big_nearest(a) == HUGE_VAL);
    a = dt_big_subtract(a, tiny);
    CHECK(dt_big_nearest(a) == DBL_MAX);
    a.sign = -1;
    CHECK(dt_big_nearest(a) == -DBL_MAX);
}
