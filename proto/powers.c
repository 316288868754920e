/* powers.c - see powers.h. The table is computed before main, in about 50 us.
 *
 * Going up, each power of five is the one before times 5. Going down, 2^959 is divided by 5 again and again:
 *
 *     floor(floor(2^959 / 5^n) / 5) = floor(2^959 / 5^(n+1))
 *
 * so remainders that are dropped do not add up. At n = 342 the quotient still has 164 bits. */
#include "proto/powers.h"

enum { WORDS = 30 }; /* 960 bits, the lowest word first */

struct proto_u128 proto_powers[PROTO_POWER_MAX - PROTO_POWER_MIN + 1];

static void multiply_by_five(uint32_t n[WORDS])
{
    uint64_t carry = 0;
    for (int i = 0; i < WORDS; i++) {
        carry += (uint64_t)n[i] * 5;
        n[i] = (uint32_t)carry;
        carry >>= 32;
    }
}

static void divide_by_five(uint32_t n[WORDS])
{
    uint64_t rest = 0;
    for (int i = WORDS; i-- > 0;) {
        rest = rest << 32 | n[i];
        n[i] = (uint32_t)(rest / 5);
        rest %= 5;
    }
}

/* The 128 bits of n > 0 from its highest one on. */
static struct proto_u128 highest_bits(const uint32_t n[WORDS])
{
    int top = WORDS - 1;
    while (n[top] == 0)
        top--;
    unsigned zeros = (unsigned)__builtin_clz(n[top]);
    uint64_t pair[4]; /* of neighbouring words, from the highest one on */
    for (int i = 0; i < 4; i++) {
        uint64_t high = i <= top ? n[top - i] : 0, low = i < top ? n[top - i - 1] : 0;
        pair[i] = (high << 32 | low) << zeros >> 32;
    }
    return (struct proto_u128){pair[0] << 32 | pair[1], pair[2] << 32 | pair[3]};
}

/* Before the constructors of programs that link the library, which may read numbers. */
__attribute__((constructor(101))) static void make_powers(void)
{
    struct proto_u128 *one = &proto_powers[-PROTO_POWER_MIN];
    uint32_t up[WORDS] = {1}, down[WORDS] = {[WORDS - 1] = (uint32_t)1 << 31};
    for (int q = 0; q <= PROTO_POWER_MAX; q++, multiply_by_five(up))
        one[q] = highest_bits(up);
    for (int q = -1; q >= PROTO_POWER_MIN; q--) {
        divide_by_five(down);
        one[q] = highest_bits(down);
        one[q].lo += q >= -27;
    }
}
