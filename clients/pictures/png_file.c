/* png_file.c - PNG [RFC 2083]: each row with the filter that makes the smallest differences, compressed by deflate.c; a piece of its
 * output is a chunk. */
#include "clients/pictures/png_file.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "clients/lib/bytes.h"
#include "clients/pictures/deflate.h"

enum { FILTERS = 5, PIXEL = 4 /* bytes */ };

static void put_u32(unsigned char *to, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(v >> (24 - 8 * i));
}

static void put_chunk(FILE *out, const char *name, const unsigned char *data, size_t n)
{
    unsigned char word[4];
    put_u32(word, (uint32_t)n);
    fwrite(word, 1, 4, out);
    fwrite(name, 1, 4, out);
    if (n > 0)
        fwrite(data, 1, n, out);
    put_u32(word, ~bytes_crc(bytes_crc(~0u, name, 4), data, n));
    fwrite(word, 1, 4, out);
}

static void put_data(void *ctx, const unsigned char *bytes, size_t n)
{
    put_chunk(ctx, "IDAT", bytes, n);
}

/* ---- filters [RFC 2083, section 6] ---- */

static int paeth(int left, int up, int corner)
{
    int p = left + up - corner, a = abs(p - left), b = abs(p - up), c = abs(p - corner);
    return a <= b && a <= c ? left : b <= c ? up : corner;
}

/* Filters a row into to[1 + n], the filter's number first; returns the sum of the differences. */
static uint64_t filter_row(unsigned char *to, unsigned char kind, const unsigned char *row,
                           const unsigned char *above, size_t n)
{
    uint64_t sum = 0;
    to[0] = kind;
    for (size_t i = 0; i < n; i++) {
        int left = i >= PIXEL ? row[i - PIXEL] : 0, up = above != NULL ? above[i] : 0,
            corner = i >= PIXEL && above != NULL ? above[i - PIXEL] : 0;
        const int expected[FILTERS] = {0, left, up, (left + up) / 2, paeth(left, up, corner)};
        to[1 + i] = (unsigned char)(row[i] - expected[kind]);
        sum += to[1 + i] < 128 ? to[1 + i] : 256u - to[1 + i];
    }
    return sum;
}

bool png_write(FILE *out, const unsigned char *rgba, uint32_t width, uint32_t height)
{
    unsigned char head[13];
    size_t n = PIXEL * (size_t)width;
    unsigned char *rows = malloc(2 * (n + 1));
    struct deflate *d = deflate_new(put_data, out);
    if (rows == NULL || d == NULL) {
        free(rows);
        free(d);
        return false;
    }
    unsigned char *best = rows, *other = rows + n + 1;
    fwrite("\x89PNG\r\n\x1a\n", 1, 8, out);
    put_u32(head, width);
    put_u32(head + 4, height);
    memcpy(head + 8, "\x08\x06\0\0", 5); /* 8 bits each of red, green, blue and opacity */
    put_chunk(out, "IHDR", head, sizeof head);
    for (uint32_t y = 0; y < height; y++) {
        const unsigned char *row = rgba + n * y, *above = y > 0 ? row - n : NULL;
        uint64_t least = filter_row(best, 0, row, above, n);
        for (int kind = 1; kind < FILTERS; kind++) {
            uint64_t sum = filter_row(other, (unsigned char)kind, row, above, n);
            if (sum < least) {
                unsigned char *swap = best;
                best = other;
                other = swap;
                least = sum;
            }
        }
        deflate_put(d, best, n + 1);
    }
    deflate_end(d);
    put_chunk(out, "IEND", NULL, 0);
    free(rows);
    return true;
}
