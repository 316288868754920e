/* record_fuzz.c - libFuzzer target: any bytes as a segment. A record that is accepted is written as the same bytes
 * again. Checksums are corrected first, or no input would ever get past them. */
#include <stdlib.h>
#include <string.h>

#include "proto/records/crc32c.h"
#include "proto/records/record.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool ok)
{
    if (!ok)
        abort();
}

static void write_back(const struct record *r, const char *bytes, size_t len)
{
    size_t item = record_item_size(r->type);
    struct buf b = {0};
    struct record copy = *r;
    void *items = calloc(item > 0 ? r->n + 1 : 1, item + 5); /* some are longer in memory */
    copy.items = items;
    if (item > 0)
        record_items(r, 0, r->n, items);
    record_write(&b, &copy);
    require(buf_len(&b) == len && memcmp(buf_head(&b), bytes, len) == 0);
    buf_free(&b);
    free(items);
}

static void put_checksum(char *at, const char *from, size_t n)
{
    uint32_t crc = crc32c(0, from, n);
    for (int i = 0; i < 4; i++)
        at[i] = (char)(crc >> 8 * i);
}

static void mend(char *bytes, size_t n)
{
    uint32_t rest = 0;
    for (int i = 0; n >= RECORD_HEADER && i < 4; i++)
        rest |= (uint32_t)(unsigned char)bytes[4 + i] << 8 * i;
    if (n >= RECORD_HEADER && rest <= n - RECORD_HEADER)
        put_checksum(bytes, bytes + 4, RECORD_HEADER - 4 + rest);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct segment s;
    struct record r;
    char *exact = malloc(size + 1), *at = exact;
    memcpy(exact, data, size);
    if (size >= SEGMENT_HEADER)
        put_checksum(at + SEGMENT_HEADER - 4, at, SEGMENT_HEADER - 4);
    ptrdiff_t took = segment_read(at, size, &s);
    while (took > 0) {
        at += took;
        size -= (size_t)took;
        mend(at, size);
        took = record_read(at, size, &r);
        if (took > 0)
            write_back(&r, at, (size_t)took);
    }
    require(took == 0 || took == -1);
    free(exact);
    return 0;
}
