/* deflate.h - compression as zlib's [RFC 1950, RFC 1951]: repeated strings of the last 32 KiB, and Huffman codes made for each
 * block. Smaller output than without it is not promised: random bytes grow by less than 1 %. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Gets the output in pieces. */
typedef void deflate_output_fn(void *ctx, const unsigned char *bytes, size_t n);

struct deflate;

/* NULL when out of memory (about 1 MB). */
struct deflate *deflate_new(deflate_output_fn *output, void *ctx);

void deflate_put(struct deflate *d, const unsigned char *bytes, size_t n);

/* Writes the rest and the checksum, and frees it. */
void deflate_end(struct deflate *d);
