/* png_file_test.c - the output of png_write, read back by a reader of this test's own, with checksums. */
#include "clients/pictures/png_file.h"

#include <stdlib.h>
#include <string.h>

#include "tests/test.h"

static uint32_t big(const unsigned char *b)
{
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static uint32_t crc(const unsigned char *s, size_t n)
{
    uint32_t v = ~0u;
    for (size_t i = 0; i < n; i++) {
        v ^= s[i];
        for (int k = 0; k < 8; k++)
            v = v >> 1 ^ (v & 1 ? 0xEDB88320u : 0);
    }
    return ~v;
}

/* The next chunk at *p, checked. */
static size_t chunk(const unsigned char **p, const unsigned char *end, const char *name,
                    const unsigned char **data)
{
    CHECK(end - *p >= 12);
    size_t n = big(*p);
    CHECK(n <= (size_t)(end - *p) - 12 && memcmp(*p + 4, name, 4) == 0);
    CHECK(big(*p + 8 + n) == crc(*p + 4, n + 4));
    *data = *p + 8;
    *p += 12 + n;
    return n;
}

/* Unpacks the stored blocks z[n] into raw[room]; returns their bytes. */
static size_t inflate_stored(const unsigned char *z, size_t n, unsigned char *raw, size_t room)
{
    const unsigned char *p = z + 2, *end = z + n - 4;
    size_t have = 0;
    CHECK(n >= 11 && (z[0] & 15) == 8 && (z[0] * 256 + z[1]) % 31 == 0);
    for (bool last = false; !last;) {
        CHECK(end - p >= 5 && p[0] <= 1);
        size_t len = p[1] | (size_t)p[2] << 8;
        last = p[0] == 1;
        CHECK((p[1] ^ p[3]) == 255 && (p[2] ^ p[4]) == 255);
        CHECK(len <= (size_t)(end - p) - 5 && len <= room - have);
        memcpy(raw + have, p + 5, len);
        have += len;
        p += 5 + len;
    }
    uint32_t a = 1, b = 0;
    for (size_t i = 0; i < have; i++) {
        a = (a + raw[i]) % 65521;
        b = (b + a) % 65521;
    }
    CHECK(p == end && big(end) == (b << 16 | a));
    return have;
}

static void check_picture(uint32_t width, uint32_t height)
{
    size_t bytes = 4 * (size_t)width * height, size, n = 0;
    unsigned char *rgba = malloc(bytes), *raw = malloc(bytes + height), *z;
    char *file;
    FILE *out = open_memstream(&file, &size);
    CHECK(out != NULL && rgba != NULL && raw != NULL);
    for (size_t i = 0; i < bytes; i++)
        rgba[i] = (unsigned char)test_below(256);
    png_write(out, rgba, width, height);
    CHECK(fclose(out) == 0);
    const unsigned char *p = (const unsigned char *)file, *end = p + size, *data;
    CHECK(size > 8 && memcmp(p, "\x89PNG\r\n\x1a\n", 8) == 0);
    p += 8;
    CHECK(chunk(&p, end, "IHDR", &data) == 13 && big(data) == width && big(data + 4) == height);
    CHECK(memcmp(data + 8, "\x08\x06\0\0\0", 5) == 0);
    z = malloc(size);
    CHECK(z != NULL);
    while (memcmp(p + 4, "IDAT", 4) == 0) {
        size_t len = chunk(&p, end, "IDAT", &data);
        memcpy(z + n, data, len);
        n += len;
    }
    CHECK(chunk(&p, end, "IEND", &data) == 0 && p == end);
    CHECK(inflate_stored(z, n, raw, bytes + height) == bytes + height);
    for (uint32_t y = 0; y < height; y++) {
        const unsigned char *row = raw + (4 * (size_t)width + 1) * y;
        CHECK(row[0] == 0 && memcmp(row + 1, rgba + 4 * (size_t)width * y, 4 * (size_t)width) == 0);
    }
    free(rgba);
    free(raw);
    free(z);
    free(file);
}

TEST(png_of_any_size_reads_back)
{
    check_picture(1, 1);
    check_picture(3, 2);
    check_picture(16383, 1); /* a row of 65533 bytes */
    check_picture(127, 129); /* 65661: the second block is short */
    check_picture(5461, 3);  /* 65535: one block exactly */
    check_picture(10922, 3); /* two blocks less 3 bytes */
    check_picture(300, 301);
}
