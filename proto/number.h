/* number.h - numbers on the wire: decimal text to binary and back, independent of the locale.
 *
 * These functions do not allocate and have no state. Reading and writing are exact: proto_read_double reads what
 * proto_write_double has written to the same bits, and no shorter string of digits has that property. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Numbers of bodies, replies and files are little-endian, and are copied as they are. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "this machine is not little-endian");

#define PROTO_NUMBER_MAX 32 /* bytes that a function below may write */

/* A coordinate is 0, or its magnitude is in this range [PROTOCOL.md, section 1]; the core's is the same. */
#define PROTO_COORDINATE_LEAST 0x1p-142
#define PROTO_COORDINATE_MOST 0x1p201

static inline bool proto_is_coordinate(double v)
{
    double size = v < 0 ? -v : v;
    return size == 0 || (size >= PROTO_COORDINATE_LEAST && size <= PROTO_COORDINATE_MOST);
}

/* Reads the decimal number that is all of s[0 .. len): an optional sign, digits with at most one '.' among, before or
 * after them. Optionally 'e' or 'E' follows, with an optional sign and digits. Blanks,
 * NaN, infinities and hexadecimal are refused: false, *v unchanged.
 *
 * The result is the double nearest to the number, ties to even, for any number of digits, with two conventions. A
 * number too large for a double becomes an infinity. A number that is not zero never becomes zero, but at least the
 * smallest double of its sign. So a check of the range of *v is a check of the number. Cost: linear in
 * the digits; much more for hundreds of digits near a tie. */
bool proto_read_double(const char *s, size_t len, double *v);

/* The same for a number at the front of s[0 .. len): returns its length; 0 if there is none, *v unchanged. */
size_t proto_read_leading_double(const char *s, size_t len, double *v);

/* Whether s[0 .. len) is a number that proto_read_double reads. */
bool proto_is_number(const char *s, size_t len);

/* Reads the decimal digits that are all of s[0 .. len). A sign, a blank, no digit, or a value above
 * 2^32 - 1, or 2^64 - 1: false, *v unchanged. */
bool proto_read_u32(const char *s, size_t len, uint32_t *v);
bool proto_read_u64(const char *s, size_t len, uint64_t *v);

/* The same for hexadecimal digits in lower case. */
bool proto_read_hex(const char *s, size_t len, uint64_t *v);

/* Writes the finite number v with the fewest digits that read back to v (and of those the nearest to v). The
 * layout is JavaScript's: 0.000001 <= |v| < 1e21 without an exponent, others like 1e-7
 * or 1.5e+22. The string is not terminated; dst must have room for PROTO_NUMBER_MAX bytes. Returns
 * its length, at most 25. */
size_t proto_write_double(char *dst, double v);

/* Writes v in decimal; the string is not terminated. Returns its length, at most 10; of dst, 11 bytes may be
 * overwritten. */
size_t proto_write_u32(char *dst, uint32_t v);

/* The same of 64 bits: at most 20 digits, and 20 bytes. */
size_t proto_write_u64(char *dst, uint64_t v);
