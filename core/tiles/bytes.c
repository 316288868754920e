/* bytes.c - a tile as bytes: a head, the points by local id, the global ids, the pairs that were sent. Postponed faces are not among
 * them: if there are any, all faces are judged again. */
#include "core/tiles/tile.h"

#include <string.h>

#include "core/memory/memory.h"

static const char MAGIC[8] = "dt_tile2";

struct head {
    char magic[8];
    uint64_t own, points, judged, opened, sent;
};

enum { PER_POINT = sizeof(struct dt_point) + sizeof(uint64_t) };

size_t dt_tile_size(const struct dt_tile *tile)
{
    return sizeof(struct head) + (size_t)tile->points * PER_POINT +
           tile->sent.n * sizeof *tile->sent.v;
}

void dt_tile_write(const struct dt_tile *tile, uint8_t *out)
{
    struct head head = {.own = tile->own,
                        .points = tile->points,
                        .judged = tile->postponed.n > 0 ? 0 : tile->judged,
                        .opened = tile->opened,
                        .sent = tile->sent.n};
    size_t ids = tile->points * sizeof *tile->id;
    memcpy(head.magic, MAGIC, sizeof MAGIC);
    memcpy(out, &head, sizeof head);
    out += sizeof head;
    for (uint32_t i = 0; i < tile->points; i++, out += sizeof(struct dt_point)) {
        struct dt_point p;
        (void)dt_get(tile->t, i, &p); /* every local id is live */
        memcpy(out, &p, sizeof p);
    }
    if (ids > 0)
        memcpy(out, tile->id, ids);
    if (tile->sent.n > 0)
        memcpy(out + ids, tile->sent.v, tile->sent.n * sizeof *tile->sent.v);
}

/* ---- reading ---- */

/* Whether the head fits the size of the bytes. */
static bool head_ok(const struct head *h, size_t size)
{
    bool counts = h->own <= h->points && h->points <= DT_MAX_POINTS && h->judged <= h->points &&
                  h->opened <= 1 && h->sent <= SIZE_MAX / 16;
    return counts && memcmp(h->magic, MAGIC, sizeof MAGIC) == 0 &&
           size - sizeof *h == h->points * PER_POINT + h->sent * sizeof(uint64_t);
}

/* Whether the pairs ascend, and are of own points. */
static bool pairs_ok(const struct dt_pairs *p, uint32_t own)
{
    bool ok = true;
    for (size_t i = 0; i < p->n && ok; i++)
        ok = (uint32_t)p->v[i] < own && (i == 0 || p->v[i - 1] < p->v[i]);
    return ok;
}

/* The arrays that the bytes have, aligned. */
struct parts {
    struct dt_point *p; /* owns */
    uint64_t *id;       /* owns */
    struct dt_pairs sent;
};

static void clear(struct parts *a)
{
    dt_array_free(a->p);
    dt_array_free(a->id);
    dt_pairs_clear(&a->sent);
}

static enum dt_status copy_parts(struct parts *a, const struct head *h, const uint8_t *bytes)
{
    size_t n = (size_t)h->points;
    a->p = dt_array_new(n + 1, sizeof *a->p);
    a->id = dt_array_new(n + 1, sizeof *a->id);
    a->sent.v = dt_array_new((size_t)h->sent + 1, sizeof *a->sent.v);
    if (a->p == NULL || a->id == NULL || a->sent.v == NULL)
        return DT_NOMEM;
    a->sent.n = (size_t)h->sent;
    a->sent.cap = a->sent.n + 1;
    memcpy(a->p, bytes, n * sizeof *a->p);
    memcpy(a->id, bytes + n * sizeof *a->p, n * sizeof *a->id);
    memcpy(a->sent.v, bytes + n * PER_POINT, a->sent.n * sizeof *a->sent.v);
    return pairs_ok(&a->sent, (uint32_t)h->own) ? DT_OK : DT_CORRUPT;
}

/* Errors of the arguments are errors of the bytes here. */
static enum dt_status of_bytes(enum dt_status s)
{
    return s == DT_RANGE ? DT_CORRUPT : s;
}

static enum dt_status build(struct parts *a, const struct head *h, struct dt_pages *pages,
                            unsigned workers, struct dt_tile **out)
{
    uint32_t own = (uint32_t)h->own, foreign = (uint32_t)h->points - own;
    enum dt_status s = of_bytes(dt_tile_new(a->p, a->id, own, pages, workers, out));
    if (s != DT_OK)
        return s;
    struct dt_tile *tile = *out;
    s = of_bytes(dt_tile_insert(tile, a->p + own, a->id + own, foreign));
    if (s == DT_OK && tile->points != h->points)
        s = DT_CORRUPT;
    tile->judged = (uint32_t)h->judged;
    tile->opened = h->opened == 1;
    tile->sent = a->sent;
    a->sent = (struct dt_pairs){0};
    return s;
}

enum dt_status dt_tile_read(const uint8_t *bytes, size_t size, struct dt_pages *pages,
                            unsigned workers, struct dt_tile **out)
{
    struct head h;
    struct parts a = {0};
    *out = NULL;
    if (size < sizeof h)
        return DT_CORRUPT;
    memcpy(&h, bytes, sizeof h);
    if (!head_ok(&h, size))
        return DT_CORRUPT;
    enum dt_status s = copy_parts(&a, &h, bytes + sizeof h);
    if (s == DT_OK)
        s = build(&a, &h, pages, workers, out);
    clear(&a);
    if (s != DT_OK) {
        dt_tile_free(*out);
        *out = NULL;
    }
    return s;
}
