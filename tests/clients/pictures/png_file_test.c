/* png_file_test.c - the output of png_write, read back by a reader of this test's own, with checksums. */
#include "clients/pictures/png_file.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

/* ---- a reader of compressed data, after RFC 1951, one bit at a time ---- */

struct bits {
    const unsigned char *p, *end;
    unsigned at; /* of the byte *p */
};

static unsigned next_bits(struct bits *b, unsigned n)
{
    unsigned v = 0;
    for (unsigned i = 0; i < n; i++) {
        CHECK(b->p < b->end);
        v |= (unsigned)(*b->p >> b->at & 1) << i;
        b->at = (b->at + 1) % 8;
        b->p += b->at == 0;
    }
    return v;
}

struct code {
    unsigned char length[320]; /* of each symbol's code; 0: it has none */
    size_t n;
    unsigned short symbol[320]; /* those that have a code, in the order of the codes */
    unsigned count[16];         /* of codes, by length */
};

static void sort_code(struct code *c)
{
    size_t k = 0;
    for (unsigned length = 1; length <= 15; length++)
        for (size_t i = 0; i < c->n; i++)
            if (c->length[i] == length) {
                c->symbol[k++] = (unsigned short)i;
                c->count[length]++;
            }
}

static unsigned next_symbol(struct bits *b, const struct code *c)
{
    unsigned seen = 0, first = 0, before = 0; /* codes that are shorter */
    for (unsigned length = 1; length <= 15; length++) {
        seen = seen << 1 | next_bits(b, 1);
        if (seen - first < c->count[length])
            return c->symbol[before + seen - first];
        before += c->count[length];
        first = (first + c->count[length]) << 1;
    }
    CHECK_MSG(false, "no such code");
    return 0;
}

static void read_lengths(struct bits *b, const struct code *lengths, unsigned char *to, size_t n)
{
    for (size_t i = 0; i < n;) {
        unsigned v = next_symbol(b, lengths), repeat = 1, of = v;
        if (v >= 16) {
            CHECK(v > 16 || i > 0);
            of = v == 16 ? to[i - 1] : 0;
            repeat = v == 16   ? 3 + next_bits(b, 2)
                     : v == 17 ? 3 + next_bits(b, 3)
                               : 11 + next_bits(b, 7);
        }
        for (; repeat > 0; repeat--, i++) {
            CHECK(i < n);
            to[i] = (unsigned char)of;
        }
    }
}

static size_t read_block(struct bits *b, const struct code *literal, const struct code *distance,
                         unsigned char *raw, size_t have, size_t room)
{
    for (unsigned v; (v = next_symbol(b, literal)) != 256;) {
        if (v < 256) {
            CHECK(have < room);
            raw[have++] = (unsigned char)v;
            continue;
        }
        unsigned extra = v < 265 || v == 285 ? 0 : (v - 261) / 4;
        unsigned length = v == 285  ? 258
                          : v < 265 ? v - 254
                                    : ((4 + (v - 261) % 4) << extra) + 3 + next_bits(b, extra);
        v = next_symbol(b, distance);
        extra = v < 4 ? 0 : v / 2 - 1;
        size_t back = v < 4 ? v + 1 : ((2 + v % 2) << extra) + 1 + next_bits(b, extra);
        CHECK(back <= have && back <= 32768 && length <= room - have);
        for (; length > 0; length--, have++)
            raw[have] = raw[have - back];
    }
    return have;
}

/* The codes that precede a block. */
static void read_codes(struct bits *b, struct code *literal, struct code *distance)
{
    static const unsigned char order[] = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                          11, 4,  12, 3, 13, 2, 14, 1, 15};
    struct code lengths = {.n = 19};
    unsigned char both[320];
    *literal = (struct code){.n = 257 + next_bits(b, 5)};
    *distance = (struct code){.n = 1 + next_bits(b, 5)};
    unsigned some = 4 + next_bits(b, 4);
    for (unsigned i = 0; i < some; i++)
        lengths.length[order[i]] = (unsigned char)next_bits(b, 3);
    sort_code(&lengths);
    read_lengths(b, &lengths, both, literal->n + distance->n);
    memcpy(literal->length, both, literal->n);
    memcpy(distance->length, both + literal->n, distance->n);
}

/* The codes of blocks without their own. */
static void fix_codes(struct code *literal, struct code *distance)
{
    *literal = (struct code){.n = 288};
    *distance = (struct code){.n = 30};
    for (size_t i = 0; i < 288; i++)
        literal->length[i] = i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8;
    memset(distance->length, 5, distance->n);
}

/* A block that is not compressed. */
static size_t read_stored(struct bits *b, unsigned char *raw, size_t have, size_t room)
{
    next_bits(b, (8 - b->at) % 8);
    size_t n = next_bits(b, 16);
    CHECK((next_bits(b, 16) ^ n) == 0xFFFF && n <= room - have && n <= (size_t)(b->end - b->p));
    memcpy(raw + have, b->p, n);
    b->p += n;
    return have + n;
}

/* Unpacks z[n] into raw[room]; returns the number of bytes. */
static size_t inflate(const unsigned char *z, size_t n, unsigned char *raw, size_t room)
{
    struct bits b = {z + 2, z + n - 4, 0};
    struct code literal, distance;
    size_t have = 0;
    CHECK(n >= 6 && (z[0] & 15) == 8 && (z[0] * 256 + z[1]) % 31 == 0);
    for (bool last = false; !last;) {
        last = next_bits(&b, 1);
        const unsigned type = next_bits(&b, 2);
        CHECK(type < 3);
        if (type == 0) {
            have = read_stored(&b, raw, have, room);
            continue;
        }
        type == 1 ? fix_codes(&literal, &distance) : read_codes(&b, &literal, &distance);
        sort_code(&literal);
        sort_code(&distance);
        have = read_block(&b, &literal, &distance, raw, have, room);
    }
    uint32_t sum_a = 1, sum_b = 0;
    for (size_t i = 0; i < have; i++) {
        sum_a = (sum_a + raw[i]) % 65521;
        sum_b = (sum_b + sum_a) % 65521;
    }
    CHECK(b.end - b.p <= 1 && big(b.end) == (sum_b << 16 | sum_a));
    return have;
}

/* Takes the filter back [RFC 2083, section 6]. */
static void unfilter(unsigned char *row, const unsigned char *above, size_t n)
{
    for (size_t i = 1; i <= n; i++) {
        int a = i > 4 ? row[i - 4] : 0, b = above != NULL ? above[i] : 0,
            c = i > 4 && above != NULL ? above[i - 4] : 0, p = a + b - c;
        int nearest = abs(p - a) <= abs(p - b) && abs(p - a) <= abs(p - c) ? a
                      : abs(p - b) <= abs(p - c)                           ? b
                                                                           : c;
        const int expected[] = {0, a, b, (a + b) / 2, nearest};
        CHECK(row[0] < 5);
        row[i] = (unsigned char)(row[i] + expected[row[0]]);
    }
}

enum kind { NOISE, RELIEF, STRIPES };

static unsigned char sample(enum kind kind, size_t x, size_t y, size_t channel)
{
    if (kind == NOISE)
        return (unsigned char)test_below(256);
    if (kind == STRIPES)
        return x % 50 < 25 ? 255 : (unsigned char)(60 * channel);
    return (unsigned char)(channel == 3 ? 255 : (x * x / 300 + y * 3 / 2 + channel * 20) & 255);
}

/* Returns the bytes of the file. */
static size_t check_picture(enum kind kind, uint32_t width, uint32_t height)
{
    size_t bytes = 4 * (size_t)width * height, size, n = 0;
    unsigned char *rgba = malloc(bytes), *raw = malloc(bytes + height), *z;
    char *file;
    FILE *out = open_memstream(&file, &size);
    CHECK(out != NULL && rgba != NULL && raw != NULL);
    for (size_t i = 0; i < bytes; i++)
        rgba[i] = sample(kind, i / 4 % width, i / 4 / width, i % 4);
    CHECK(png_write(out, rgba, width, height) == NULL);
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
    CHECK(inflate(z, n, raw, bytes + height) == bytes + height);
    for (uint32_t y = 0; y < height; y++) {
        unsigned char *row = raw + (4 * (size_t)width + 1) * y;
        unfilter(row, y > 0 ? row - (4 * (size_t)width + 1) : NULL, 4 * (size_t)width);
        CHECK(memcmp(row + 1, rgba + 4 * (size_t)width * y, 4 * (size_t)width) == 0);
    }
    free(rgba);
    free(raw);
    free(z);
    free(file);
    return size;
}

TEST(png_of_any_size_reads_back)
{
    static const uint32_t size[][2] = {{1, 1},    {3, 2},     {16383, 1}, {127, 129},
                                       {5461, 3}, {10922, 3}, {300, 301}};
    for (size_t i = 0; i < sizeof size / sizeof size[0]; i++)
        for (enum kind kind = NOISE; kind <= STRIPES; kind++)
            check_picture(kind, size[i][0], size[i][1]);
}

TEST(png_of_a_relief_is_a_fraction_of_its_pixels_and_noise_hardly_grows)
{
    size_t pixels = 4 * (size_t)400 * 400;
    CHECK(check_picture(RELIEF, 400, 400) < pixels / 10);
    CHECK(check_picture(STRIPES, 400, 400) < pixels / 100);
    CHECK(check_picture(NOISE, 400, 400) < pixels + pixels / 100);
}

TEST(png_is_not_compressed_where_there_is_no_gzip)
{
    CHECK(setenv("PATH", "/nowhere", 1) == 0);
    CHECK(check_picture(RELIEF, 400, 400) > 4 * (size_t)400 * 400);
    check_picture(NOISE, 1, 1);
    check_picture(NOISE, 16383, 1); /* blocks and their rest */
    check_picture(NOISE, 4095, 4);
}

/* A gzip that does this is the only one. */
static void replace_gzip(const char *script)
{
    FILE *f = fopen("gzip", "w");
    CHECK(f != NULL);
    fprintf(f, "#!/bin/sh\n%s\n", script);
    CHECK(fclose(f) == 0 && chmod("gzip", 0755) == 0);
}

TEST(png_is_not_compressed_where_gzip_fails_or_ends_early)
{
    static const char *const scripts[] = {
        "exit 1",
        "exit 0",
        "cat",
        "head -c 9",
        "/bin/gzip -c4n | head -c 18",
        "/bin/gzip -c4n | head -c 500",
        "head -c 2000 | /bin/gzip -c4n",
        "/bin/gzip -c4n; exit 1",
        "/bin/gzip -c4n; kill -9 $$",
    };
    char path[] = "/tmp/gzip.XXXXXX";
    if (access("/bin/gzip", X_OK) != 0)
        SKIP("there is no /bin/gzip");
    CHECK(mkdtemp(path) != NULL && chdir(path) == 0);
    CHECK(setenv("PATH", ".:/bin:/usr/bin", 1) == 0);
    for (size_t i = 0; i < sizeof scripts / sizeof scripts[0]; i++) {
        replace_gzip(scripts[i]);
        size_t size = check_picture(NOISE, 200, 200);
        size_t relief = check_picture(RELIEF, 200, 200);
        CHECK_MSG(relief > 4 * (size_t)200 * 200 && size > 4 * (size_t)200 * 200, "%s", scripts[i]);
    }
    CHECK(unlink("gzip") == 0 && chdir("/") == 0 && rmdir(path) == 0);
}

TEST(png_is_compressed_whatever_options_the_environment_has_for_gzip)
{
    static const char *const options[] = {"-r", "--badopt", "-d", "-l"};
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        CHECK(setenv("GZIP", options[i], 1) == 0);
        CHECK(check_picture(RELIEF, 200, 200) < 4 * (size_t)200 * 200 / 10);
    }
}
