/* png_file.c - PNG [RFC 2083]: each row with the filter that makes the smallest differences, compressed by deflate.c; a piece of its
 * output is a chunk. */
#include "clients/pictures/png_file.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "clients/pictures/deflate.h"

enum { FILTERS = 5, PIXEL = 4 /* bytes */ };

struct png {
    FILE *out;
    uint32_t crc[256];
};

/* The table of the CRC [RFC 2083, section 15]. */
static void make_table(struct png *p)
{
    for (uint32_t i = 0; i < 256; i++) {
        p->crc[i] = i;
        for (int k = 0; k < 8; k++)
            p->crc[i] = p->crc[i] & 1 ? 0xEDB88320u ^ (p->crc[i] >> 1) : p->crc[i] >> 1;
    }
}

static void put_u32(unsigned char *to, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(v >> (24 - 8 * i));
}

static uint32_t add_crc(const struct png *p, uint32_t crc, const void *data, size_t n)
{
    const unsigned char *s = data;
    for (size_t i = 0; i < n; i++)
        crc = p->crc[(crc ^ s[i]) & 255] ^ (crc >> 8);
    return crc;
}

static void put_chunk(struct png *p, const char *name, const unsigned char *data, size_t n)
{
    unsigned char word[4];
    put_u32(word, (uint32_t)n);
    fwrite(word, 1, 4, p->out);
    fwrite(name, 1, 4, p->out);
    if (n > 0)
        fwrite(data, 1, n, p->out);
    put_u32(word, ~add_crc(p, add_crc(p, ~0u, name, 4), data, n));
    fwrite(word, 1, 4, p->out);
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
    struct png p = {.out = out};
    unsigned char head[13];
    size_t n = PIXEL * (size_t)width;
    unsigned char *rows = malloc(2 * (n + 1));
    struct deflate *d = deflate_new(put_data, &p);
    if (rows == NULL || d == NULL) {
        free(rows);
        free(d);
        return false;
    }
    unsigned char *best = rows, *other = rows + n + 1;
    make_table(&p);
    fwrite("\x89PNG\r\n\x1a\n", 1, 8, out);
    put_u32(head, width);
    put_u32(head + 4, height);
    memcpy(head + 8, "\x08\x06\0\0", 5); /* 8 bits each of red, green, blue and opacity */
    put_chunk(&p, "IHDR", head, sizeof head);
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
    put_chunk(&p, "IEND", NULL, 0);
    free(rows);
    return true;
}
