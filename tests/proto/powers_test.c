/* powers_test.c - every entry of the table of powers, by definition. */
#include "proto/powers.h"

#include <string.h>

#include "tests/test.h"

#define WORDS 40 /* 1280 bits, low word first */

static void multiply_small(uint32_t *n, uint32_t m)
{
    uint64_t carry = 0;
    for (int i = 0; i < WORDS; i++) {
        carry += (uint64_t)n[i] * m;
        n[i] = (uint32_t)carry;
        carry >>= 32;
    }
    CHECK(carry == 0);
}

static int bit_length(const uint32_t *n)
{
    for (int i = WORDS; i-- > 0;)
        if (n[i] != 0)
            return 32 * i + 32 - __builtin_clz(n[i]);
    return 0;
}

static void shift_left(uint32_t *n, int bits)
{
    for (; bits >= 31; bits -= 31)
        multiply_small(n, (uint32_t)1 << 31);
    multiply_small(n, (uint32_t)1 << bits);
}

static int compare(const uint32_t *a, const uint32_t *b)
{
    for (int i = WORDS; i-- > 0;)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

static void set_power5(uint32_t *n, int e)
{
    memset(n, 0, WORDS * sizeof n[0]);
    n[0] = 1;
    while (e-- > 0)
        multiply_small(n, 5);
}

/* n = g * 5^e + add * 5^e */
static void set_product(uint32_t *n, struct proto_u128 g, bool add, int e)
{
    memset(n, 0, WORDS * sizeof n[0]);
    n[0] = (uint32_t)g.lo, n[1] = (uint32_t)(g.lo >> 32), n[2] = (uint32_t)g.hi,
    n[3] = (uint32_t)(g.hi >> 32);
    if (add)
        for (int i = 0; ++n[i] == 0; i++)
            continue;
    while (e-- > 0)
        multiply_small(n, 5);
}

/* g <= 5^q * 2^s < g + 1 where both have 128 bits; equal up to q = 55. */
TEST(powers_of_ten_are_rounded_down_and_exact_where_possible)
{
    uint32_t power[WORDS], low[WORDS], high[WORDS];
    for (int q = 0; q <= PROTO_POWER_MAX; q++) {
        struct proto_u128 g = proto_powers[q - PROTO_POWER_MIN];
        CHECK(g.hi >> 63 == 1 && g.lo != UINT64_MAX);
        set_power5(power, q);
        int bits = bit_length(power);
        CHECK(proto_log2_power(q) == bits - 1 + q);
        set_product(low, g, false, 0);
        set_product(high, g, true, 0);
        if (bits < 128)
            shift_left(power, 128 - bits);
        else
            shift_left(low, bits - 128), shift_left(high, bits - 128);
        CHECK((q <= 55 ? compare(low, power) == 0 : compare(low, power) < 0) &&
              compare(power, high) < 0);
    }
}

/* g * 5^|q| <= 2^s < (g + 1) * 5^|q|; from -27 on g is one more, so (g - 1) * 5^|q| < 2^s < g *
 * 5^|q|. */
TEST(negative_powers_of_ten_are_rounded_as_reading_needs_them)
{
    uint32_t power[WORDS], two[WORDS], low[WORDS], high[WORDS];
    for (int q = -1; q >= PROTO_POWER_MIN; q--) {
        struct proto_u128 g = proto_powers[q - PROTO_POWER_MIN];
        CHECK(g.hi >> 63 == 1 && g.lo != UINT64_MAX);
        if (q >= -27) {
            CHECK(g.lo != 0);
            g.lo--;
        }
        set_power5(power, -q);
        int bits = bit_length(power);
        CHECK(proto_log2_power(q) == -bits + q);
        set_power5(two, 0);
        shift_left(two, bits + 127);
        set_product(low, g, false, -q);
        set_product(high, g, true, -q);
        CHECK(compare(low, two) < 0 && compare(two, high) < 0);
    }
}
