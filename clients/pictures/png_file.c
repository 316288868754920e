/* png_file.c - PNG [RFC 2083] around stored blocks [RFC 1951, section 3.2.4]; each block is a chunk. */
#include "clients/pictures/png_file.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

enum { BLOCK = 65535, HEAD = 4 + 2 + 5 }; /* a chunk's name; zlib's header; a block's */

struct png {
    FILE *out;
    uint32_t crc[256];
    uint32_t a, b; /* Adler's checksum [RFC 1950] */
    uint64_t left; /* bytes of all rows that are still to come */
    unsigned char data[HEAD + BLOCK + 4];
    size_t start, n; /* data[start .. n) is used */
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

/* A chunk, whose name data begins with. */
static void put_chunk(struct png *p, const unsigned char *data, size_t n)
{
    unsigned char word[4];
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t i = 0; i < n; i++)
        crc = p->crc[(crc ^ data[i]) & 255] ^ (crc >> 8);
    put_u32(word, (uint32_t)(n - 4));
    fwrite(word, 1, 4, p->out);
    fwrite(data, 1, n, p->out);
    put_u32(word, ~crc);
    fwrite(word, 1, 4, p->out);
}

/* Begins the next block, of as many bytes as are left and fit. */
static void begin_block(struct png *p, bool first)
{
    size_t len = p->left < BLOCK ? (size_t)p->left : BLOCK;
    p->n = 0;
    memcpy(p->data, "IDAT\x78\x01", first ? 6 : 4);
    p->n = first ? 6 : 4;
    p->data[p->n++] = len == p->left; /* the last one */
    p->data[p->n++] = (unsigned char)len;
    p->data[p->n++] = (unsigned char)(len >> 8);
    p->data[p->n++] = (unsigned char)~len;
    p->data[p->n++] = (unsigned char)(~len >> 8);
    p->start = p->n;
}

static void put_bytes(struct png *p, const unsigned char *s, size_t n)
{
    while (n > 0) {
        size_t room = BLOCK - (p->n - p->start), some = n < room ? n : room;
        memcpy(p->data + p->n, s, some);
        for (size_t i = 0; i < some; i++) {
            p->a = (p->a + s[i]) % 65521;
            p->b = (p->b + p->a) % 65521;
        }
        p->n += some;
        p->left -= some;
        s += some;
        n -= some;
        if (p->left > 0 && some == room) {
            put_chunk(p, p->data, p->n);
            begin_block(p, false);
        }
    }
}

void png_write(FILE *out, const unsigned char *rgba, uint32_t width, uint32_t height)
{
    struct png p = {.out = out, .a = 1, .left = (4 * (uint64_t)width + 1) * height};
    unsigned char head[17] = "IHDR";
    make_table(&p);
    fwrite("\x89PNG\r\n\x1a\n", 1, 8, out);
    put_u32(head + 4, width);
    put_u32(head + 8, height);
    memcpy(head + 12, "\x08\x06\0\0", 5); /* 8 bits each of red, green, blue and opacity */
    put_chunk(&p, head, sizeof head);
    begin_block(&p, true);
    for (uint32_t y = 0; y < height; y++) {
        put_bytes(&p, (const unsigned char[]){0}, 1); /* no filter */
        put_bytes(&p, rgba + 4 * (size_t)width * y, 4 * (size_t)width);
    }
    put_u32(p.data + p.n, p.b << 16 | p.a);
    put_chunk(&p, p.data, p.n + 4);
    put_chunk(&p, (const unsigned char *)"IEND", 4);
}
