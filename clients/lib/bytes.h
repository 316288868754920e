/* bytes.h - little-endian numbers in bytes, as replies and many files have them; and the checksum of zip, gzip and PNG. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* The integer of n bytes, at most 8. */
static inline uint64_t bytes_integer(const void *at, size_t n)
{
    const unsigned char *byte = at;
    uint64_t v = 0;
    while (n-- > 0)
        v = v << 8 | byte[n];
    return v;
}

static inline uint16_t bytes_u16(const void *at)
{
    return (uint16_t)bytes_integer(at, 2);
}

static inline uint32_t bytes_u32(const void *at)
{
    return (uint32_t)bytes_integer(at, 4);
}

static inline double bytes_double(const void *at)
{
    uint64_t bits = bytes_integer(at, 8);
    double v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

/* Continues CRC-32 with these bytes [RFC 1952, section 8]. The first crc is ~0; the checksum is the complement of the last one. */
static inline uint32_t bytes_crc(uint32_t crc, const void *at, size_t n)
{
    const unsigned char *byte = at;
    for (size_t i = 0; i < n; i++) {
        crc ^= byte[i];
        for (int k = 0; k < 8; k++)
            crc = crc & 1 ? 0xEDB88320u ^ (crc >> 1) : crc >> 1;
    }
    return crc;
}
