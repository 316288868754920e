/* random.h - random bits from the operating system. */
#ifndef SERVER_RANDOM_H
#define SERVER_RANDOM_H

#include <stdint.h>

/* 64 bits, never all 0. */
uint64_t random_bits(void);

#endif
