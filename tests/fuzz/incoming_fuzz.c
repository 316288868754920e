/* incoming_fuzz.c - libFuzzer target: any bytes from a leader. They come in two parts; the first byte chooses where.
 * It must pass on whole headers and records, in order. A snapshot that is complete is read as a start would
 * read it. Checksums are corrected first. */
#include "proto/records/crc32c.h"
#include "server/disk/recover.h"
#include "server/follow/incoming.h"
#include "server/system/notice.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The bytes that have been received. */
struct received {
    const char *bytes; /* of the whole stream */
    uint64_t passed;   /* up to here has been passed on, or is of a snapshot */
    const struct incoming *incoming;
};

static void require(bool ok)
{
    if (!ok)
        abort();
}

/* ---- checksums ---- */

static void put_checksum(char *at, const char *from, size_t n)
{
    uint32_t crc = crc32c(0, from, n);
    for (int i = 0; i < 4; i++)
        at[i] = (char)(crc >> 8 * i);
}

/* Corrects the header or record at the beginning; returns its length, 0 if it is not whole. */
static size_t mend(char *at, size_t n)
{
    if (n >= 8 && memcmp(at, "DELAUNAY", 8) == 0) {
        if (n < SEGMENT_HEADER)
            return 0;
        put_checksum(at + SEGMENT_HEADER - 4, at, SEGMENT_HEADER - 4);
        return SEGMENT_HEADER;
    }
    if (n < RECORD_HEADER)
        return 0;
    uint32_t rest = record_outline(at).length;
    if (rest > n - RECORD_HEADER)
        return 0;
    put_checksum(at, at + 4, RECORD_HEADER - 4 + rest);
    return RECORD_HEADER + rest;
}

/* ---- what the stream calls ---- */

static bool take_header(void *ctx, const struct segment *h)
{
    (void)ctx;
    require(h->kind == SEGMENT_LOG || h->kind == SEGMENT_SNAPSHOT);
    return true;
}

static bool take_log(void *ctx, const char *bytes, size_t n)
{
    struct received *got = ctx;
    require(n > 0 && got->passed + n <= got->incoming->taken);
    require(memcmp(bytes, got->bytes + got->incoming->taken - n, n) == 0);
    for (size_t at = 0; at < n;) {
        struct segment h;
        struct record r;
        bool header = n - at >= 8 && memcmp(bytes + at, "DELAUNAY", 8) == 0;
        ptrdiff_t took =
            header ? segment_read(bytes + at, n - at, &h) : record_read(bytes + at, n - at, &r);
        require(took > 0 && (!header || h.kind == SEGMENT_LOG));
        at += (size_t)took;
    }
    got->passed = got->incoming->taken;
    return true;
}

static bool take_snapshot(void *ctx, struct aside *a, const struct segment *h)
{
    struct received *got = ctx;
    struct datadir arrived;
    struct recovery r;
    if (!aside_complete(a, h, &arrived))
        return false;
    recovery_init(&r, &arrived);
    recovery_run(&r);
    require(r.result != RECOVERY_OK || r.last == h->lsn);
    recovery_clear(&r);
    aside_close(&arrived);
    got->passed = got->incoming->taken;
    return true;
}

/* ---- a run ---- */

/* The directory is made once, in memory if possible. */
static struct datadir *directory(void)
{
    static struct datadir dir = {.fd = -1};
    static char path[] = "/dev/shm/incoming_fuzz.XXXXXX", other[] = "/tmp/incoming_fuzz.XXXXXX";
    if (dir.fd >= 0)
        return &dir;
    notice_set_level(NOTICE_ERROR);
    require(datadir_open(&dir, mkdtemp(path) != NULL ? path : mkdtemp(other), false));
    return &dir;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct incoming_calls calls = {take_header, take_log, take_snapshot};
    if (size < 2)
        return 0;
    size_t n = size - 1, cut = data[0] * n / 256;
    char *bytes = malloc(n);
    require(bytes != NULL);
    memcpy(bytes, data + 1, n);
    for (size_t at = 0, took = 1; took > 0; at += took)
        took = mend(bytes + at, n - at);
    struct incoming s = {.dir = directory(), .calls = &calls};
    struct received got = {.bytes = bytes, .incoming = &s};
    s.ctx = &got;
    buf_append(&s.in, bytes, cut);
    bool good = incoming_take(&s);
    require(good || s.why[0] != '\0');
    buf_append(&s.in, bytes + cut, n - cut);
    if (good)
        incoming_take(&s);
    require(s.taken <= n);
    incoming_clear(&s);
    free(bytes);
    return 0;
}
