/* own_triangles.c - the triangles that a tile outputs: those whose corner with the smallest global id is own. They are counted by
 * that corner, whose local ids are in the order of the global ones, and then written where they belong. The rows of one corner are sorted
 * last. Vertices are in the order of the plane, so global ids are read by vertex. */
#include "core/tiles/tile.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/memory.h"

struct row {
    uint64_t id[3];
};

struct rows {
    const struct dt_tile *tile;
    const uint32_t *half, *local; /* of the mesh; local ids by vertex */
    uint64_t *global;             /* owns; by vertex */
    uint32_t *end; /* owns own + 1: by local id, where its rows are written, or end */
    /* owns; by record of the mesh: 4 * local id + corner of the smallest; DT_NONE: none */
    uint32_t *key;
    bool wide;
    void *out;
};

static inline void put(const struct rows *r, size_t i, struct row row)
{
    if (r->wide)
        memcpy((char *)r->out + i * sizeof row, &row, sizeof row);
    else
        for (unsigned k = 0; k < 3; k++)
            ((uint32_t *)r->out)[3 * i + k] = (uint32_t)row.id[k];
}

static bool is_triangle(const uint32_t *corner)
{
    return corner[2] != DT_NONE && corner[2] != DT_DEAD;
}

/* The corner of a triangle with the smallest global id. Without branches, which would be unpredictable. */
static inline unsigned least_corner(const struct rows *r, const uint32_t *corner)
{
    const uint64_t a = r->global[corner[0]], b = r->global[corner[1]], c = r->global[corner[2]];
    unsigned first = b < a, ahead = c < a && c < b;
    return (first & (ahead - 1)) | ahead << 1;
}

/* Sets the keys, and makes end[local] the place of the first row of each own point. Returns how many rows there are. */
static size_t count(const struct rows *r)
{
    uint32_t own = r->tile->own, sum = 0;
    memset(r->end, 0, ((size_t)own + 1) * sizeof *r->end);
    for (uint32_t i = 0; i < r->tile->t->mesh.tri_end; i++) {
        const uint32_t *corner = &r->half[(size_t)8 * i];
        r->key[i] = DT_NONE;
        if (!is_triangle(corner))
            continue;
        unsigned k = least_corner(r, corner);
        uint32_t least = r->local[corner[k]];
        if (!dt_is_own(r->tile, least))
            continue;
        r->key[i] = 4 * least + k;
        r->end[least]++;
    }
    for (uint32_t k = 0; k <= own; k++) {
        uint32_t n = r->end[k];
        r->end[k] = sum;
        sum += n;
    }
    return sum;
}

static inline void *row_at(const struct rows *r, size_t i)
{
    return (char *)r->out + i * (r->wide ? 3 * sizeof(uint64_t) : 3 * sizeof(uint32_t));
}

/* Prefetches what record i + NEAR will write, and what is needed to find that for record i + FAR. */
static inline void fetch(const struct rows *r, uint32_t i)
{
    enum { NEAR = 12, FAR = 24 };
    uint32_t records = r->tile->t->mesh.tri_end;
    if (i + FAR < records && r->key[i + FAR] != DT_NONE)
        dt_fetch(&r->end[r->key[i + FAR] / 4]);
    if (i + NEAR < records && r->key[i + NEAR] != DT_NONE)
        dt_fetch(row_at(r, r->end[r->key[i + NEAR] / 4]));
}

static void distribute(const struct rows *r)
{
    static const unsigned after[] = {1, 2, 0, 1};
    for (uint32_t i = 0; i < r->tile->t->mesh.tri_end; i++) {
        uint32_t key = r->key[i];
        fetch(r, i);
        if (key == DT_NONE)
            continue;
        const uint32_t *corner = &r->half[(size_t)8 * i];
        unsigned k = key & 3;
        put(r, r->end[key / 4]++,
            (struct row){{r->global[corner[k]], r->global[corner[after[k]]],
                          r->global[corner[after[k + 1]]]}});
    }
}

/* ---- the order of rows with the same first id: their second ids differ ---- */

static int compare_wide(const void *a, const void *b)
{
    uint64_t x = ((const uint64_t *)a)[1], y = ((const uint64_t *)b)[1];
    return x < y ? -1 : x > y;
}

static int compare_narrow(const void *a, const void *b)
{
    uint32_t x = ((const uint32_t *)a)[1], y = ((const uint32_t *)b)[1];
    return x < y ? -1 : x > y;
}

static void sort_group(const struct rows *r, size_t from, size_t n)
{
    if (r->wide)
        qsort((uint64_t *)r->out + 3 * from, n, 3 * sizeof(uint64_t), compare_wide);
    else
        qsort((uint32_t *)r->out + 3 * from, n, 3 * sizeof(uint32_t), compare_narrow);
}

/* Few rows are sorted by insertion. */
static void sort_few(uint32_t *row, size_t n)
{
    for (size_t i = 1; i < n; i++)
        for (size_t k = i; k > 0 && row[3 * k + 1] < row[3 * k - 2]; k--)
            for (size_t w = 3 * k; w < 3 * k + 3; w++) {
                uint32_t kept = row[w];
                row[w] = row[w - 3];
                row[w - 3] = kept;
            }
}

static void sort_rows(const struct rows *r)
{
    enum { FEW = 12 };
    for (size_t local = 0, from = 0; local < r->tile->own; from = r->end[local++]) {
        size_t n = r->end[local] - from;
        if (!r->wide && n <= FEW)
            sort_few((uint32_t *)r->out + 3 * from, n);
        else if (n > 1)
            sort_group(r, from, n);
    }
}

/* ---- calls ---- */

static bool fits_narrow(const struct dt_tile *tile)
{
    bool fits = true;
    for (uint32_t i = 0; i < tile->points && fits; i++)
        fits = tile->id[i] <= UINT32_MAX;
    return fits;
}

static enum dt_status read_globals(struct rows *r)
{
    const struct dt_points *p = &r->tile->t->points;
    r->global = dt_array_new_in(p->pages, (size_t)p->end + 1, sizeof *r->global);
    if (r->global == NULL)
        return DT_NOMEM;
    for (uint32_t v = 0; v < p->end; v++)
        if (p->id[v] != DT_NONE)
            r->global[v] = r->tile->id[p->id[v]];
    return DT_OK;
}

enum dt_status dt_tile_triangles(const struct dt_tile *tile, bool wide, void *triangle,
                                 size_t *rows)
{
    struct rows r = {.tile = tile,
                     .half = tile->t->mesh.half,
                     .local = tile->t->points.id,
                     .wide = wide,
                     .out = triangle};
    enum dt_status s = wide || fits_narrow(tile) ? dt_readable(tile->t) : DT_RANGE;
    if (s != DT_OK)
        return s;
    struct dt_pages *pages = tile->t->points.pages;
    r.end = dt_array_new_in(pages, (size_t)tile->own + 1, sizeof *r.end);
    r.key = dt_array_new_in(pages, (size_t)tile->t->mesh.tri_end + 1, sizeof *r.key);
    s = r.end == NULL || r.key == NULL ? DT_NOMEM : read_globals(&r);
    if (s == DT_OK) {
        *rows = count(&r);
        distribute(&r);
        sort_rows(&r);
    }
    dt_array_free(r.global);
    dt_array_free(r.key);
    dt_array_free(r.end);
    return s;
}
