/* rows.c - all rows of DT_TRIANGLES at once, and the row of each triangle of the mesh: sorted by their smallest corners in
 * passes over the records, as a counting sort does; then the few rows of each corner by their second word.
 *
 * Reading the table star by star gives the same rows in twice the time, without the numbers of the records. */
#include <stdlib.h>
#include <string.h>

#include "core/arrays/arrays.h"

#include "core/query/query.h"

struct row {
    uint32_t b, c, record;
};

static bool is_triangle(const struct dt_mesh *m, uint32_t record)
{
    return m->half[8 * (size_t)record + 2] < DT_DEAD;
}

/* The corners of a triangle, from the smallest id. */
static inline void corners(const struct dt *t, uint32_t record, uint32_t out[3])
{
    const uint32_t *v = t->mesh.half + 8 * (size_t)record, *id = t->points.id;
    uint32_t a = id[v[0]], b = id[v[1]], c = id[v[2]];
    bool second = b < a && b < c, third = c < a && c < b;
    out[0] = second ? b : third ? c : a;
    out[1] = second ? c : third ? a : b;
    out[2] = second ? a : third ? b : c;
}

/* first[a]: where the rows begin whose smallest corner is a, for all a < n, and end[n]: their number. */
static void count(const struct dt *t, uint32_t *first, uint32_t n)
{
    uint32_t sum = 0, abc[3];
    memset(first, 0, ((size_t)n + 1) * sizeof *first);
    for (uint32_t i = 0; i < t->mesh.tri_end; i++)
        if (is_triangle(&t->mesh, i)) {
            corners(t, i, abc);
            first[abc[0]]++;
        }
    for (uint32_t i = 0; i <= n; i++) {
        uint32_t here = first[i];
        first[i] = sum;
        sum += here;
    }
}

/* Puts the rows in their order by smallest corners; first[a] becomes where those of a end. */
static void distribute(const struct dt *t, uint32_t *first, struct row *row)
{
    uint32_t abc[3];
    for (uint32_t i = 0; i < t->mesh.tri_end; i++)
        if (is_triangle(&t->mesh, i)) {
            corners(t, i, abc);
            row[first[abc[0]]++] = (struct row){abc[1], abc[2], i};
        }
}

static int compare(const void *a, const void *b)
{
    const struct row *p = a, *q = b;
    return p->b < q->b ? -1 : p->b > q->b;
}

static void sort_few(struct row *row, uint32_t n)
{
    enum { FEW = 24 };
    if (n > FEW) {
        qsort(row, n, sizeof *row, compare);
        return;
    }
    for (uint32_t i = 1; i < n; i++) {
        struct row here = row[i];
        uint32_t j = i;
        for (; j > 0 && row[j - 1].b > here.b; j--)
            row[j] = row[j - 1];
        row[j] = here;
    }
}

/* Sorts the rows of each smallest corner and writes them out. */
static void write_rows(struct dt_arrays *a, const uint32_t *end, struct row *row, uint32_t n,
                       uint32_t *triangle)
{
    for (uint32_t id = 0, i = 0; id < n; id++) {
        sort_few(row + i, end[id] - i);
        for (; i < end[id]; i++) {
            triangle[3 * (size_t)i] = id;
            triangle[3 * (size_t)i + 1] = row[i].b;
            triangle[3 * (size_t)i + 2] = row[i].c;
            a->row[row[i].record] = i;
        }
    }
}

enum dt_status dt_arrays_sort(struct dt_arrays *a, uint32_t *triangle)
{
    const struct dt *t = a->t;
    struct dt_pages *pages = t->mesh.pages;
    uint32_t n = dt_next_id(t), triangles = dt_mesh_triangles(&t->mesh);
    uint32_t *first = dt_array_new_in(pages, (size_t)n + 1, sizeof *first);
    struct row *row = dt_array_new_in(pages, triangles, sizeof *row);
    uint32_t *of = dt_array_new_in(pages, t->mesh.tri_end, sizeof *of);
    bool good = first != NULL && row != NULL && of != NULL;
    if (good) {
        a->row = of;
        memset(of, 0xff, t->mesh.tri_end * sizeof *of);
        count(t, first, n);
        distribute(t, first, row);
        write_rows(a, first, row, n, triangle);
    } else {
        dt_array_free(of);
    }
    dt_array_free(first);
    dt_array_free(row);
    return good ? DT_OK : DT_NOMEM;
}

/* ---- twins ---- */

/* The corner of the record that comes first in its row. */
static uint32_t first_corner(const struct dt *t, uint32_t record)
{
    const uint32_t *v = t->mesh.half + 8 * (size_t)record, *id = t->points.id;
    uint32_t a = id[v[0]], b = id[v[1]], c = id[v[2]];
    return b < a && b < c ? 1 : c < a && c < b ? 2 : 0;
}

static uint32_t side_of(const struct dt_arrays *a, uint32_t half)
{
    uint32_t row = dt_row_of(a, half);
    return row == DT_NONE ? DT_NONE
                          : 3 * row + ((half & 3) + 3 - first_corner(a->t, half >> 3)) % 3;
}

void dt_arrays_twins(const struct dt_arrays *a, uint32_t *out)
{
    const struct dt_mesh *m = &a->t->mesh;
    for (uint32_t i = 0; i < m->tri_end; i++) {
        if (!is_triangle(m, i))
            continue;
        uint32_t turn = first_corner(a->t, i);
        for (uint32_t k = 0; k < 3; k++)
            out[3 * (size_t)a->row[i] + k] = side_of(a, dt_twin(m, 8 * i + (turn + k) % 3));
    }
}
