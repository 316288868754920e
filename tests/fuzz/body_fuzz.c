/* body_fuzz.c - libFuzzer target: any bytes as the points that follow LOAD and LOADB. The first two
 * bytes choose the form, the columns and the count. The outcome must not depend on the two pieces in which
 * the rest arrives. */
#include "core/delaunay.h"
#include "proto/body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LIMIT = 100 }; /* points of one load */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool condition)
{
    if (!condition)
        abort();
}

/* Feeds the data until the body consumes none; returns the number of consumed bytes, -1 for a fault of
 * the framing. */
static ptrdiff_t feed(struct body *b, const uint8_t *data, size_t n, bool last)
{
    size_t at = 0;
    while (!b->complete) {
        char *exact = malloc(n - at + (n == at));
        require(exact != NULL);
        memcpy(exact, data + at, n - at);
        ptrdiff_t took = body_feed(b, exact, n - at, last);
        free(exact);
        require(took <= (ptrdiff_t)(n - at));
        if (took < 0)
            return -1;
        if (took == 0)
            break;
        at += (size_t)took;
    }
    return (ptrdiff_t)at;
}

/* Reads a body whose first `cut` bytes arrive first. Returns what feed returns for the whole body. */
static ptrdiff_t read_body(struct body *b, unsigned kind, uint64_t count, const uint8_t *data,
                           size_t size, size_t cut)
{
    body_init(b, (enum body_form)(kind % 3), count, LIMIT, dt_coordinates_ok);
    if (kind >= 128) /* values after the coordinates, or alone */
        body_columns(b, kind / 3 % 2 * 2, kind / 6 % 3 + 1);
    if (kind >= 64 && kind < 192 && b->form != BODY_BINARY)
        body_paths(b);
    ptrdiff_t first = feed(b, data, cut, false);
    if (first < 0 || b->complete)
        return first;
    ptrdiff_t rest = feed(b, data + first, size - (size_t)first, true);
    require(rest < 0 || b->complete);
    return rest < 0 ? -1 : first + rest;
}

/* The same body of text, of which the lines before the last one are parsed apart and joined. */
static void require_joined(const struct body *whole, enum body_form form, uint64_t count,
                           const uint8_t *data, size_t size)
{
    struct body lines, joined;
    uint64_t n;
    bool ended;
    body_init(&joined, form, count, LIMIT, dt_coordinates_ok);
    body_columns(&joined, whole->coordinates, body_numbers(whole) - whole->coordinates);
    if (whole->paths)
        body_paths(&joined);
    if (form == BODY_BINARY || joined.complete)
        return;
    size_t at = body_scan(&joined, (const char *)data, size,
                          form == BODY_LINES ? count - 1 : UINT64_MAX, &n, &ended);
    body_init(&lines, BODY_LINES, n, LIMIT, dt_coordinates_ok);
    body_columns_of(&lines, whole);
    require(feed(&lines, data, at, false) == (ptrdiff_t)at && (lines.complete || n == 0));
    if (body_join(&joined, &lines)) {
        require(feed(&joined, data + at, size - at, true) >= 0 && joined.complete);
        require(joined.n == whole->n && joined.fault == whole->fault && joined.line == whole->line);
        require(whole->n == 0 || memcmp(joined.xy, whole->xy, whole->n * whole->width * 8) == 0);
    } else {
        require(lines.fault != BODY_GOOD && lines.fault == whole->fault);
    }
    body_free(&lines);
    body_free(&joined);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct body whole, pieces;
    if (size < 2)
        return 0;
    unsigned kind = data[0];
    uint64_t count = data[1];
    data += 2;
    size -= 2;
    ptrdiff_t took = read_body(&whole, kind, count, data, size, size);
    require(whole.fault == BODY_GOOD || whole.xy == NULL);
    require(whole.n <= LIMIT && (took < 0 || whole.complete));
    for (size_t i = 0; i < whole.width * whole.n; i++)
        require(i % whole.width < whole.coordinates ? dt_coordinate_ok(whole.xy[i])
                                                    : isinf(whole.xy[i]) == 0);
    for (size_t cut = 0; cut < size && cut < 64; cut++) {
        ptrdiff_t again = read_body(&pieces, kind, count, data, size, cut);
        require(again == took && pieces.n == whole.n && pieces.fault == whole.fault);
        require(took < 0 || pieces.fault_line == whole.fault_line);
        require(whole.n == 0 || memcmp(pieces.xy, whole.xy, whole.n * whole.width * 8) == 0);
        body_free(&pieces);
    }
    if (took >= 0)
        require_joined(&whole, (enum body_form)(kind % 3), count, data, size);
    body_free(&whole);
    return 0;
}
