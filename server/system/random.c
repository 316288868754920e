/* random.c - see random.h. */
#include "server/system/random.h"

#include "server/system/loop.h"

#include <sys/random.h>
#include <unistd.h>

uint64_t random_bits(void)
{
    uint64_t bits = 0;
    if (getrandom(&bits, sizeof bits, 0) != (ssize_t)sizeof bits) /* a kernel without it */
        bits = (uint64_t)clock_ns() * UINT64_C(0x9E3779B97F4A7C15) ^ (uint64_t)getpid();
    return bits == 0 ? 1 : bits;
}
