/* hash.h - a 64-bit hash of bytes, by which two daemons compare what they have. It detects differences that arise by
 * chance or by a fault, with a probability of a miss of about 2^-64; it does not protect against bytes that were chosen to
 * collide. The mixing steps and constants are those of xxHash's XXH64 [Collet, xxHash specification, section XXH64],
 * with one accumulator. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* The hash of bytes[n] after those of the hash `before`; 0: there are none before. The division of a text into
 * calls matters: two pieces have another hash than both together. The same on every processor. Cost: O(n),
 * some gigabytes a second. */
uint64_t hash_bytes(uint64_t before, const void *bytes, size_t n);
