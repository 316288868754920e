/* hash.c - see hash.h. */
#include "proto/records/hash.h"

#include <string.h>

static const uint64_t P1 = 0x9E3779B185EBCA87, P2 = 0xC2B2AE3D27D4EB4F, P3 = 0x165667B19E3779F9,
                      P4 = 0x85EBCA77C2B2AE63, P5 = 0x27D4EB2F165667C5;

static uint64_t rotate(uint64_t v, unsigned by)
{
    return v << by | v >> (64 - by);
}

uint64_t hash_bytes(uint64_t before, const void *bytes, size_t n)
{
    const unsigned char *p = bytes;
    uint64_t h = before + P5 + n;
    for (; n > 0; p += 8) {
        size_t take = n < 8 ? n : 8;
        uint64_t w = 0; /* little-endian (number.h) */
        if (take == 8)
            memcpy(&w, p, 8);
        else
            memcpy(&w, p, take);
        h ^= rotate(w * P2, 31) * P1;
        h = rotate(h, 27) * P1 + P4;
        n -= take;
    }
    h = (h ^ h >> 33) * P2;
    h = (h ^ h >> 29) * P3;
    return h ^ h >> 32;
}
