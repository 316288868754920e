/* flat.c - the triangles in canonical order, with their half edges, all at once.
 *
 *     start[id]      the first place of the triangles whose smallest id is id, counted and added up
 *     entry[place]   the other two ids of a triangle, and its record in the mesh
 *     place_of[rec]  where the record's triangle is in the end, and which corner comes first
 *
 * Records are read in the order of memory, and only single words are written at random: faster than a walk around each
 * point (table.c), which needs no memory and can stop anywhere. */
#include "core/query/flat.h"

#include "core/query/query.h"

#include <stdlib.h>
#include <string.h>

struct entry {
    uint32_t second, third, record;
};

struct flat {
    const struct dt *t;
    bool cw;
    uint32_t *start; /* owns one for each id, and one more */
    struct entry *entry;
    uint32_t *place_of; /* 4 * place + corner, the place from write_triangles on; DT_NONE: none */
};

/* Makes start[id + 1] the number of triangles whose smallest id is id, and then the sums. */
static void count(const struct flat *f)
{
    const uint32_t *half = f->t->mesh.half, *id = f->t->points.id;
    uint32_t *start = f->start, *place_of = f->place_of;
    for (uint32_t i = 0, end = f->t->mesh.tri_end; i < end; i++) {
        const uint32_t *corner = &half[(size_t)8 * i];
        place_of[i] = DT_NONE;
        if (corner[2] == DT_NONE || corner[2] == DT_DEAD)
            continue;
        uint32_t least;
        place_of[i] = dt_least_of_three(id[corner[0]], id[corner[1]], id[corner[2]], &least);
        start[least + 1]++;
    }
    for (uint32_t k = 0, ids = f->t->points.next_id; k < ids; k++)
        start[k + 1] += start[k];
}

/* Puts every triangle among those with the same smallest id; start[id] becomes where these end. */
static void distribute(const struct flat *f)
{
    static const uint32_t next[] = {1, 2, 0, 1};
    const uint32_t *half = f->t->mesh.half, *place_of = f->place_of;
    const uint32_t *id = f->t->points.id, *after = f->cw ? next + 1 : next;
    uint32_t *start = f->start;
    struct entry *entry = f->entry;
    for (uint32_t i = 0, end = f->t->mesh.tri_end; i < end; i++) {
        uint32_t k = place_of[i];
        if (k == DT_NONE)
            continue;
        const uint32_t *corner = &half[(size_t)8 * i];
        uint32_t second = after[k], third = 3 - k - second;
        entry[start[id[corner[k]]]++] = (struct entry){id[corner[second]], id[corner[third]], i};
    }
}

static int compare(const void *a, const void *b)
{
    uint32_t x = ((const struct entry *)a)->second, y = ((const struct entry *)b)->second;
    return x < y ? -1 : x > y;
}

enum { FEW = 16 };

/* Returns how many of n entries come before e, which is number i. Triangles on both sides of an edge differ in the end
 * that comes first; so the second ids of one point's triangles differ. Few are compared with each other, because a sort's
 * branches would be unpredictable; many are sorted. */
static uint32_t rank_of(const struct entry *e, uint32_t i, uint32_t n)
{
    uint32_t before = 0;
    if (n > FEW)
        return i;
    for (uint32_t k = 0; k < n; k++)
        before += e[k].second < e[i].second;
    return before;
}

static void write_triangles(const struct flat *f, uint32_t *out)
{
    for (uint32_t id = 0, from = 0; id < f->t->points.next_id; id++) {
        struct entry *e = &f->entry[from];
        uint32_t n = f->start[id] - from;
        if (n > FEW)
            qsort(e, n, sizeof *e, compare);
        for (uint32_t i = 0; i < n; i++) {
            uint32_t place = from + rank_of(e, i, n), *row = &out[(size_t)3 * place];
            row[0] = id;
            row[1] = e[i].second;
            row[2] = e[i].third;
            f->place_of[e[i].record] |= 4 * place;
        }
        from += n;
    }
}

enum dt_status dt_flat_rows(const struct dt *t, bool cw, uint32_t *triangles, uint32_t **place_of)
{
    enum dt_status s = dt_readable(t);
    struct dt_pages *pages = t->mesh.pages;
    size_t ids = (size_t)t->points.next_id + 1;
    struct flat f = {.t = t, .cw = cw};
    *place_of = NULL;
    if (s != DT_OK)
        return s;
    f.start = dt_array_new_in(pages, ids, sizeof *f.start);
    f.entry = dt_array_new_in(pages, dt_mesh_triangles(&t->mesh), sizeof *f.entry);
    f.place_of = dt_array_new_in(pages, t->mesh.tri_end, sizeof *f.place_of);
    if (f.start == NULL || f.entry == NULL || f.place_of == NULL) {
        s = DT_NOMEM;
        dt_array_free(f.place_of);
    } else {
        memset(f.start, 0, ids * sizeof *f.start);
        count(&f);
        distribute(&f);
        write_triangles(&f, triangles);
        *place_of = f.place_of;
    }
    dt_array_free(f.start);
    dt_array_free(f.entry);
    return s;
}

/* turns[cw][corner that comes first][half edge of the mesh]: the place of the half edge in its triangle's row. Clockwise,
 * the half edges are in the opposite order. */
static const uint8_t turns[2][3][4] = {{{0, 1, 2}, {2, 0, 1}, {1, 2, 0}},
                                       {{2, 1, 0}, {0, 2, 1}, {1, 0, 2}}};

void dt_flat_halfedges(const struct dt *t, bool cw, const uint32_t *place_of, uint32_t *out)
{
    const struct dt_mesh *m = &t->mesh;
    const uint8_t(*turn)[4] = turns[cw];
    for (uint32_t i = 0; i < m->tri_end; i++) {
        uint32_t at = place_of[i];
        if (at == DT_NONE)
            continue;
        const uint32_t *twins = &m->half[(size_t)8 * i + 4];
        uint32_t *row = &out[(size_t)3 * (at / 4)];
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t twin = twins[k], beyond = place_of[twin / 8];
            row[turn[at & 3][k]] =
                beyond == DT_NONE ? DT_NONE : 3 * (beyond / 4) + turn[beyond & 3][twin & 7];
        }
    }
}

enum dt_status dt_flat(const struct dt *t, bool cw, uint32_t *triangles, uint32_t *halfedges)
{
    uint32_t *place_of;
    enum dt_status s = dt_flat_rows(t, cw, triangles, &place_of);
    if (s == DT_OK && halfedges != NULL)
        dt_flat_halfedges(t, cw, place_of, halfedges);
    dt_array_free(place_of);
    return s;
}
