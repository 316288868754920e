/* las_file.c - see las_file.h. A coordinate is an integer, times a scale, plus an offset. Nearly always the scale is a power
 * of ten: then the result is the decimal fraction that is meant, rounded once. */
#include "clients/files/las_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/lib/bytes.h"

enum { FORMATS = 11, SHORTEST_HEADER = 227, BLOCK = 1 << 18, MOST_DIGITS = 12 };

/* Bytes of a point of each format. */
static const uint16_t shortest[FORMATS] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/* The k for which v is the double nearest to 10^-k; -1: there is none. */
static int decimal_places(double v)
{
    double power = 1;
    for (int k = 0; k <= MOST_DIGITS; k++, power *= 10)
        if (v == 1 / power)
            return k;
    return -1;
}

const char *las_read_header(struct las_header *h, const unsigned char *bytes, size_t n)
{
    *h = (struct las_header){.digits = 0};
    if (n < SHORTEST_HEADER || memcmp(bytes, "LASF", 4) != 0)
        return "not LAS: the header is not complete";
    h->major = bytes[24];
    h->minor = bytes[25];
    h->data = bytes_u32(bytes + 96);
    h->format = bytes[104] & 0x3F;
    h->compressed = (bytes[104] & 0xC0) != 0;
    h->record = bytes_u16(bytes + 105);
    h->points = bytes_u32(bytes + 107);
    if (h->major != 1 || h->minor > 4)
        return "a version of LAS that is not known";
    if (h->minor == 4 && n >= 255)
        h->points = bytes_integer(bytes + 247, 8);
    if (h->format >= FORMATS)
        return "a format of LAS points that is not known";
    if (h->record < shortest[h->format] || h->data < SHORTEST_HEADER)
        return "not LAS: the header contradicts itself";
    for (int i = 0; i < 3; i++) {
        h->scale[i] = bytes_double(bytes + 131 + 8 * i);
        h->offset[i] = bytes_double(bytes + 155 + 8 * i);
        if (!isfinite(h->scale[i]) || h->scale[i] == 0 || !isfinite(h->offset[i]))
            return "not LAS: a scale or an offset is not a number";
        int places = decimal_places(h->scale[i]);
        h->digits = places < 0 || h->digits < 0 ? -1 : places > h->digits ? places : h->digits;
    }
    return NULL;
}

/* x = scale * v + offset. With scale = 10^-k and an offset of at most k decimal places, (v + offset * 10^k) / 10^k is rounded once. */
static double coordinate(const struct las_header *h, int axis, const unsigned char *at)
{
    double v = (double)(int32_t)bytes_u32(at);
    int places = decimal_places(h->scale[axis]);
    double power = places >= 0 ? pow(10, places) : 0, shift = rint(h->offset[axis] * power);
    if (places >= 0 && fabs(shift) < 0x1p52 && shift / power == h->offset[axis])
        return (v + shift) / power;
    return v * h->scale[axis] + h->offset[axis];
}

/* Reads n bytes unless the file ends before. -1 on an error. */
static ssize_t read_whole(int fd, unsigned char *to, size_t n)
{
    size_t have = 0;
    while (have < n) {
        ssize_t got = read(fd, to + have, n - have);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            break;
        have += (size_t)got;
    }
    return (ssize_t)have;
}

static bool add_point(struct points_file *f, const struct las_header *h, const unsigned char *p,
                      struct las_notes *notes)
{
    bool wide = h->format >= 6;
    double row[3] = {coordinate(h, 2, p + 8), (double)bytes_u16(p + 12), wide ? p[16] : p[15] & 31};
    notes->withheld += wide ? p[15] >> 2 & 1 : p[15] >> 7;
    notes->noise += row[2] == 7 || (wide && row[2] == 18);
    f->row = row;
    bool ok = points_file_append(f, coordinate(h, 0, p), coordinate(h, 1, p + 4)) ||
              points_file_skip(f, "", 0);
    f->row = NULL;
    return ok;
}

static bool read_points(struct points_file *f, int fd, const struct las_header *h,
                        unsigned char *block, struct las_notes *notes)
{
    size_t most = BLOCK / h->record;
    for (uint64_t left = h->points; left > 0;) {
        size_t n = left < most ? (size_t)left : most;
        ssize_t got = read_whole(fd, block, n * h->record);
        if (got < 0)
            return points_file_stop(f, "%s", strerror(errno));
        for (size_t i = 0; i < (size_t)got / h->record; i++)
            if (!add_point(f, h, block + i * h->record, notes))
                return false;
        if ((size_t)got < n * h->record)
            return points_file_stop(f, "the file ends after %zu of %ju points", f->n,
                                    (uintmax_t)h->points);
        left -= n;
    }
    return true;
}

/* Counts possible points behind the last one. From version 1.3 on there may be other records behind it. */
static bool look_behind(struct points_file *f, int fd, const struct las_header *h,
                        unsigned char *block, struct las_notes *notes)
{
    const size_t whole = (size_t)(BLOCK / h->record) * h->record;
    size_t got = h->minor < 3 ? whole : 0;
    while (got == whole) {
        ssize_t n = read_whole(fd, block, whole);
        if (n < 0)
            return points_file_stop(f, "%s", strerror(errno));
        got = (size_t)n;
        notes->behind += got / h->record;
    }
    return true;
}

/* Reads the header, and what is between it and the points. */
static bool start(struct points_file *f, int fd, struct las_header *h, unsigned char *block)
{
    ssize_t n = read_whole(fd, block, SHORTEST_HEADER), more = 0;
    size_t size = n == SHORTEST_HEADER ? bytes_u16(block + 94) : 0;
    if (size > SHORTEST_HEADER)
        more = read_whole(fd, block + n, (size < LAS_HEADER ? size : LAS_HEADER) - SHORTEST_HEADER);
    if (n < 0 || more < 0)
        return points_file_stop(f, "%s", strerror(errno));
    uint64_t have = (uint64_t)(n + more);
    const char *fault = las_read_header(h, block, (size_t)have);
    if (fault != NULL)
        return points_file_stop(f, "%s", fault);
    if (h->compressed)
        return points_file_stop(f, "the points are compressed (LAZ)");
    if (have > h->data)
        return points_file_stop(f, "not LAS: the header contradicts itself");
    for (; have < h->data; have += (uint64_t)n) {
        n = read_whole(fd, block, h->data - have < BLOCK ? (size_t)(h->data - have) : BLOCK);
        if (n <= 0)
            return points_file_stop(f, "the file ends before its points");
    }
    return true;
}

bool las_is_compressed(struct points_file *f, int fd, bool *compressed)
{
    unsigned char bytes[LAS_HEADER];
    struct las_header h;
    ssize_t n = pread(fd, bytes, sizeof bytes, 0);
    *compressed = false;
    if (n < 0) /* a pipe: the header will be read with the points */
        return true;
    const char *fault = las_read_header(&h, bytes, (size_t)n);
    *compressed = h.compressed;
    return fault == NULL || points_file_stop(f, "%s", fault);
}

bool las_file_read(struct points_file *f, int fd, struct table_fields *t, struct las_notes *notes)
{
    unsigned char *block = malloc(BLOCK);
    struct las_header h;
    *notes = (struct las_notes){.withheld = 0};
    f->line = 0;
    if (block == NULL)
        return points_file_stop(f, "out of memory");
    bool ok = start(f, fd, &h, block);
    if (ok) {
        table_fields_add(t, 2, "z", 1);
        if (t->all) {
            table_fields_add(t, 3, "intensity", 9);
            table_fields_add(t, 4, "classification", 14);
        }
        f->fields = t->n;
        ok = read_points(f, fd, &h, block, notes) && look_behind(f, fd, &h, block, notes);
    }
    free(block);
    return ok;
}
