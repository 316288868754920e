/* number_exact.h - the exact comparison that reading falls back on; for number_*.c only. */
#ifndef PROTO_NUMBER_EXACT_H
#define PROTO_NUMBER_EXACT_H

#include <stdint.h>

/* The number (digits of text, a '.' among them ignored) * 10^exponent. */
struct proto_decimal {
    const char *text, *end; /* starts with a digit other than 0 */
    int64_t exponent;
};

/* Returns the double nearest to d, ties to even, as bits; more than the largest double gives infinity. The number d
 * must lie between 1e-345 and 1e310. The guess (the bits of a double >= 0) may be anything, but each
 * step of 1 that it is off costs a comparison of numbers of up to 3000 bits. */
uint64_t proto_round_exactly(const struct proto_decimal *d, uint64_t guess);

#endif
