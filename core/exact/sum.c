/* sum.c - see sum.h. */
#include "core/exact/sum.h"

#include <string.h>

#include "core/exact/bignum.h"
#include "core/exact/double2.h"

enum { LOWEST = -448, OFTEN = 1 << 29 };

/* Makes all digits but the last one numbers from 0 to 2^32 - 1. */
static void carry(struct dt_sum *s)
{
    for (int i = 0; i + 1 < DT_SUM_DIGITS; i++) {
        int64_t low = s->digit[i] & UINT32_MAX;
        s->digit[i + 1] += (s->digit[i] - low) / ((int64_t)1 << 32);
        s->digit[i] = low;
    }
    s->added = 0;
}

/* v is 0 or a multiple of 2^-388. A digit changes by less than 2^32, so 2^29 of them do not overflow it. */
static void add(struct dt_sum *s, double v)
{
    enum { FRACTION = 52, LEAST = -1075 };
    uint64_t bits, one = (uint64_t)1 << FRACTION;
    if (v == 0)
        return;
    memcpy(&bits, &v, sizeof bits);
    int at = (int)(bits >> FRACTION & 2047) + LEAST - LOWEST, i = at / 32;
    unsigned __int128 wide = (unsigned __int128)((bits & (one - 1)) | one) << at % 32;
    for (; wide != 0; wide >>= 32, i++) {
        int64_t part = (int64_t)(wide & UINT32_MAX);
        s->digit[i] += v < 0 ? -part : part;
    }
    if (++s->added == OFTEN)
        carry(s);
}

void dt_sum_cross(struct dt_sum *s, struct dt_point a, struct dt_point b)
{
    double product, error;
    dt_two_product(a.x, b.y, &product, &error);
    add(s, product);
    add(s, error);
    dt_two_product(-a.y, b.x, &product, &error);
    add(s, product);
    add(s, error);
}

double dt_sum_half(struct dt_sum *s)
{
    struct dt_sum size = *s;
    carry(&size);
    bool negative = size.digit[DT_SUM_DIGITS - 1] < 0;
    for (int i = 0; negative && i < DT_SUM_DIGITS; i++)
        size.digit[i] = -size.digit[i];
    carry(&size);
    struct dt_big big = {.sign = negative ? -1 : 1, .exponent = LOWEST / 64};
    for (int i = 0; i < DT_SUM_DIGITS; i += 2) {
        uint64_t limb = (uint64_t)size.digit[i] | (uint64_t)size.digit[i + 1] << 32;
        if (limb == 0 && big.n == 0)
            big.exponent++;
        else
            big.limb[big.n++] = limb;
    }
    while (big.n > 0 && big.limb[big.n - 1] == 0)
        big.n--;
    return big.n == 0 ? 0 : dt_big_nearest(&big) / 2;
}
