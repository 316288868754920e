/* png_file.c - PNG [RFC 2083]: each row with the filter that makes the smallest differences. The rows are compressed by gzip: what
 * it writes between its header and its trailer is what a PNG has between the header and the checksum of zlib [RFC 1950, RFC 1952]. */
#include "clients/pictures/png_file.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/lib/bytes.h"
#include "clients/reading/program.h"

enum {
    FILTERS = 5,
    PIXEL = 4, /* bytes */
    GZIP_HEADER = 10,
    GZIP_TRAILER = 8,
    STORED_MOST = 65535 /* bytes of a block that is not compressed */
};

static void put_u32(unsigned char *to, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(v >> (24 - 8 * i));
}

static void put_chunk(FILE *out, const char *name, const void *data, size_t n)
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

/* Adler's checksum, of which `sum` has both halves [RFC 1950, section 9]. */
static uint32_t add_sum(uint32_t sum, const unsigned char *s, size_t n)
{
    uint32_t a = sum & 0xFFFF, b = sum >> 16;
    for (size_t i = 0; i < n; i++) {
        a = (a + s[i]) % 65521;
        b = (b + a) % 65521;
    }
    return b << 16 | a;
}

/* Writes the filtered rows, and computes their checksum. False when out of memory. */
static bool write_rows(FILE *to, const unsigned char *rgba, size_t n, uint32_t height,
                       uint32_t *sum)
{
    unsigned char *rows = malloc(2 * (n + 1));
    *sum = 1;
    if (rows == NULL)
        return false;
    unsigned char *best = rows, *other = rows + n + 1;
    for (uint32_t y = 0; y < height; y++) {
        const unsigned char *row = rgba + n * y, *above = y > 0 ? row - n : NULL;
        uint64_t least = filter_row(best, 0, row, above, n);
        for (int kind = 1; kind < FILTERS; kind++) {
            uint64_t other_sum = filter_row(other, (unsigned char)kind, row, above, n);
            if (other_sum < least) {
                unsigned char *swap = best;
                best = other;
                other = swap;
                least = other_sum;
            }
        }
        *sum = add_sum(*sum, best, n + 1);
        fwrite(best, 1, n + 1, to);
    }
    free(rows);
    return true;
}

/* ---- compression ---- */

/* Blocks that are not compressed [RFC 1951, section 3.2.4]. */
static void put_stored(FILE *out, FILE *rows)
{
    static unsigned char block[5 + STORED_MOST];
    for (int last = 0; !last;) {
        size_t n = fread(block + 5, 1, STORED_MOST, rows);
        last = n < STORED_MOST;
        const unsigned char head[5] = {(unsigned char)last, n & 255, (unsigned char)(n >> 8),
                                       ~n & 255, (unsigned char)(~n >> 8 & 255)};
        memcpy(block, head, 5);
        put_chunk(out, "IDAT", block, 5 + n);
    }
}

/* Has the rows compressed by gzip, into `to`. */
static bool run_gzip(FILE *rows, FILE *to)
{
    const char *words[] = {"gzip", "-c4n", NULL}; /* -n: the header has no name */
    static unsigned char block[65536];
    ssize_t got;
    pid_t pid;
    int from;
    if (program_start(&pid, words, fileno(rows), &from, false) != 0)
        return false;
    while ((got = read(from, block, sizeof block)) > 0)
        fwrite(block, 1, (size_t)got, to);
    close(from);
    return program_end(pid) == 0 && got == 0 && fflush(to) == 0 && !ferror(to);
}

/* Writes the rows, `length` bytes, compressed. False, and nothing is written, if there is no gzip, or it fails, or its file does not
 * end with the length of the rows. */
static bool put_compressed(FILE *out, FILE *rows, uint32_t length)
{
    char *packed = NULL;
    size_t n = 0;
    FILE *to = open_memstream(&packed, &n);
    bool whole = to != NULL && run_gzip(rows, to) && n > GZIP_HEADER + GZIP_TRAILER &&
                 memcmp(packed, "\x1f\x8b\x08", 4) == 0 && bytes_u32(packed + n - 4) == length;
    if (to != NULL)
        fclose(to);
    n -= whole ? GZIP_TRAILER : n;
    for (size_t at = GZIP_HEADER; at < n; at += STORED_MOST)
        put_chunk(out, "IDAT", packed + at, n - at < STORED_MOST ? n - at : STORED_MOST);
    free(packed);
    return whole;
}

static const char *compress(FILE *out, FILE *rows)
{
    long length = ftell(rows);
    if (length < 0 || fflush(rows) != 0 || ferror(rows))
        return "there is no room for a temporary file";
    rewind(rows);
    if (!put_compressed(out, rows, (uint32_t)length)) {
        rewind(rows); /* gzip may have read some */
        put_stored(out, rows);
    }
    return NULL;
}

const char *png_write(FILE *out, const unsigned char *rgba, uint32_t width, uint32_t height)
{
    unsigned char head[13], tail[4];
    uint32_t sum;
    FILE *rows = tmpfile();
    if (rows == NULL)
        return "there is no room for a temporary file";
    fwrite("\x89PNG\r\n\x1a\n", 1, 8, out);
    put_u32(head, width);
    put_u32(head + 4, height);
    memcpy(head + 8, "\x08\x06\0\0", 5); /* 8 bits each of red, green, blue and opacity */
    put_chunk(out, "IHDR", head, sizeof head);
    put_chunk(out, "IDAT", "\x78\x9C", 2); /* a window of 32 KiB */
    const char *fault = write_rows(rows, rgba, PIXEL * (size_t)width, height, &sum)
                            ? compress(out, rows)
                            : "out of memory";
    fclose(rows);
    put_u32(tail, sum);
    put_chunk(out, "IDAT", tail, sizeof tail);
    put_chunk(out, "IEND", NULL, 0);
    return fault;
}
