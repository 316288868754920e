/* reply_read_fuzz.c - libFuzzer target: any bytes as replies, whole and cut in two, must be split in
 * the same way. Converted to RESP 3 they must be whole elements.
 *
 *     clang -g -O1 -std=c11 -D_GNU_SOURCE -I. -fsanitize=fuzzer,address,undefined
 * tests/fuzz/reply_read_fuzz.c \ proto/reply_read.c proto/resp.c server/replies/resp3.c ... */
#include <stdlib.h>
#include <string.h>

#include "proto/reply_read.h"
#include "server/replies/resp3.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A checksum over all parts of data, the first `cut` bytes arriving first; raw bytes count one by
 * one. */
static uint64_t digest(const uint8_t *data, size_t size, size_t cut)
{
    struct reply_reader r = {0};
    struct reply_part part;
    uint64_t sum = 1;
    size_t start = 0;
    for (int half = 0; half < 2; half++) {
        size_t n = (half == 0 ? cut : size) - start;
        char *exact = malloc(n + 1);
        memcpy(exact, data + start, n);
        size_t at = 0;
        ptrdiff_t used;
        while ((used = reply_read(&r, exact + at, n - at, &part)) > 0) {
            at += (size_t)used;
            if (part.kind != REPLY_BYTES)
                sum = (sum * 31 + part.kind) * 31 + part.last;
            for (size_t i = 0; i < part.len; i++)
                sum = sum * 31 + (unsigned char)part.text[i];
            uint64_t v;
            if (part.kind == REPLY_OK && reply_key_number(&part, "points", &v))
                sum = sum * 31 + v + reply_rows(&part);
        }
        free(exact);
        start += at;
        if (used < 0)
            return sum ^ 1;
    }
    return sum * 2 + reply_reader_idle(&r);
}

/* Every element of RESP ends in CR LF. */
static void convert(const char *types, const uint8_t *data, size_t size)
{
    struct reply_reader r = {0};
    struct buf out = {0};
    char *exact = malloc(size + 1);
    memcpy(exact, data, size);
    resp3_reframe(&r, types, exact, size, &out);
    size_t n = buf_len(&out);
    if (n > 0 && r.bytes_left == 0 && (n < 3 || memcmp(buf_head(&out) + n - 2, "\r\n", 2) != 0))
        abort();
    buf_free(&out);
    free(exact);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const types[] = {"m", "id", "i", "t", NULL};
    if (size == 0)
        return 0;
    convert(types[data[0] % 5], data + 1, size - 1);
    if (digest(data + 1, size - 1, size - 1) != digest(data + 1, size - 1, data[0] % size))
        abort();
    return 0;
}
