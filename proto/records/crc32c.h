/* crc32c.h - the checksum of all data on disk: CRC-32C (Castagnoli polynomial
 * 0x1EDC6F41, reflected; RFC 3720, appendix B.4). */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* Extends the checksum crc, 0 at first, by bytes[n]. Uses the processor's instruction if there is one. Cost: linear,
 * about 8 bytes in 3 cycles. */
uint32_t crc32c(uint32_t crc, const void *bytes, size_t n);

/* The same without special instructions, for other processors and for tests. */
uint32_t crc32c_portable(uint32_t crc, const void *bytes, size_t n);
