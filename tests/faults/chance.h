/* chance.h - random numbers apart from test_random: for threads, and where the same number is needed again. */
#pragma once

#include <stdint.h>

struct chance {
    uint64_t state;
};

static inline uint64_t chance_mix(uint64_t z) /* splitmix64 [Steele, Lea & Flood 2014] */
{
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static inline uint32_t chance_below(struct chance *c, uint32_t n)
{
    return (uint32_t)(chance_mix(c->state += 0x9E3779B97F4A7C15u) % n);
}
