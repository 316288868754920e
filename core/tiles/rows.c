/* rows.c - the triangles that a tile outputs. dt_flat writes all triangles with local ids. Own local ids are smaller than foreign
 * ones, and in the order of their global ids. So a row's first corner is its smallest own corner, and the rows of the tile are those whose
 * first corner is own and has the smallest global id. */
#include "core/tiles/tile.h"

#include <stdlib.h>
#include <string.h>

#include "core/arrays/workers.h"
#include "core/delaunay_arrays.h"

struct row {
    uint64_t id[3];
};

/* Whether the tile outputs the row with these local ids; *row: its global ids. */
static bool is_output(const struct dt_tile *tile, const uint32_t *local, struct row *row)
{
    for (unsigned k = 0; k < 3; k++)
        row->id[k] = tile->id[local[k]];
    return dt_is_own(tile, local[0]) && row->id[0] < row->id[1] && row->id[0] < row->id[2];
}

static struct row get(const void *out, bool wide, size_t i)
{
    struct row r;
    if (wide)
        memcpy(&r, (const char *)out + i * sizeof r, sizeof r);
    else
        for (unsigned k = 0; k < 3; k++)
            r.id[k] = ((const uint32_t *)out)[3 * i + k];
    return r;
}

static void put(void *out, bool wide, size_t i, struct row r)
{
    if (wide)
        memcpy((char *)out + i * sizeof r, &r, sizeof r);
    else
        for (unsigned k = 0; k < 3; k++)
            ((uint32_t *)out)[3 * i + k] = (uint32_t)r.id[k];
}

static bool precedes(struct row a, struct row b)
{
    return a.id[0] != b.id[0] ? a.id[0] < b.id[0] : a.id[1] < b.id[1];
}

static int compare_wide(const void *a, const void *b)
{
    return precedes(get(a, true, 0), get(b, true, 0)) ? -1 : 1;
}

static int compare_narrow(const void *a, const void *b)
{
    return precedes(get(a, false, 0), get(b, false, 0)) ? -1 : 1;
}

/* Sorts the rows from .. end - 1, which have the same first id, unless they are sorted. Only foreign corners can be out of order. */
static void sort_group(void *out, bool wide, size_t from, size_t end)
{
    size_t size = wide ? sizeof(struct row) : 3 * sizeof(uint32_t), i = from + 1;
    while (i < end && precedes(get(out, wide, i - 1), get(out, wide, i)))
        i++;
    if (i < end)
        qsort((char *)out + from * size, end - from, size, wide ? compare_wide : compare_narrow);
}

/* The local rows are in the last part of out[], and are overwritten from its beginning. Row i is written at or before the place of
 * local row i: 3 rows of 8 bytes take at most as much as is in front of it. */
static size_t select_rows(const struct dt_tile *tile, const uint32_t *local, size_t n, bool wide,
                          void *out)
{
    size_t kept = 0, group = 0;
    uint64_t first = 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t corner[3];
        struct row row;
        memcpy(corner, local + 3 * i, sizeof corner);
        if (!is_output(tile, corner, &row))
            continue;
        if (kept > group && row.id[0] != first) {
            sort_group(out, wide, group, kept);
            group = kept;
        }
        first = row.id[0];
        put(out, wide, kept++, row);
    }
    if (kept > group)
        sort_group(out, wide, group, kept);
    return kept;
}

static bool fits_narrow(const struct dt_tile *tile)
{
    bool fits = true;
    for (uint32_t i = 0; i < tile->points && fits; i++)
        fits = tile->id[i] <= UINT32_MAX;
    return fits;
}

enum dt_status dt_tile_triangles(const struct dt_tile *tile, bool wide, void *triangle,
                                 size_t *rows)
{
    if (!wide && !fits_narrow(tile))
        return DT_RANGE;
    struct dt_summary sum;
    dt_summary(tile->t, &sum);
    uint32_t *local = (uint32_t *)triangle + (wide ? 3 * (size_t)sum.triangles : 0);
    enum dt_status s = dt_flat(tile->t, false, local, NULL);
    if (s == DT_OK)
        *rows = select_rows(tile, local, sum.triangles, wide, triangle);
    return s;
}
