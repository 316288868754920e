/* random.h - random bits from the operating system. */
#pragma once

#include <stdint.h>

/* 64 bits, never all 0. */
uint64_t random_bits(void);
