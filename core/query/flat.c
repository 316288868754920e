/* flat.c - the triangles in canonical order, with their half edges, all at once.
 *
 *     start[id]      the first place of the triangles whose smallest id is id, counted and added up
 *     entry[place]   the other two ids of a triangle, and its record in the mesh
 *     place_of[rec]  where the record's triangle is in the end, and which corner comes first
 *
 * Records are read in the order of memory, and only single words are written at random: faster than a walk around each
 * point (table.c), which needs no memory and can stop anywhere. */
#include "core/set/set.h"

#include <stdlib.h>

struct entry {
    uint32_t second, third, record;
};

struct flat {
    const struct dt *t;
    bool cw;
    uint32_t *start; /* owns one for each id, and one more */
    struct entry *entry;
    uint32_t *place_of; /* 4 * place + corner */
};

static bool is_triangle(const uint32_t *corner)
{
    return corner[2] != DT_NONE && corner[2] != DT_DEAD;
}

/* Which corner of a triangle has the smallest id; ids[3]: those of the corners. */
static uint32_t first_corner(const struct dt *t, const uint32_t *corner, uint32_t *ids)
{
    for (int k = 0; k < 3; k++)
        ids[k] = t->points.id[corner[k]];
    uint32_t first = ids[1] < ids[0] ? 1 : 0;
    return ids[2] < ids[first] ? 2 : first;
}

/* Makes start[id + 1] the number of triangles whose smallest id is id, and then the sums. */
static void count(const struct flat *f)
{
    const struct dt_mesh *m = &f->t->mesh;
    uint32_t ids[3], n = f->t->points.next_id;
    for (uint32_t i = 0; i < m->tri_end; i++) {
        const uint32_t *corner = &m->half[(size_t)8 * i];
        if (is_triangle(corner)) {
            uint32_t first = first_corner(f->t, corner, ids);
            f->start[ids[first] + 1]++;
        }
    }
    for (uint32_t id = 0; id < n; id++)
        f->start[id + 1] += f->start[id];
}

/* Puts every triangle among those with the same smallest id; start[id] becomes where these end. */
static void distribute(const struct flat *f)
{
    const struct dt_mesh *m = &f->t->mesh;
    uint32_t ids[3];
    for (uint32_t i = 0; i < m->tri_end; i++) {
        const uint32_t *corner = &m->half[(size_t)8 * i];
        if (!is_triangle(corner))
            continue;
        uint32_t k = first_corner(f->t, corner, ids);
        uint32_t next = k == 2 ? 0 : k + 1, before = k == 0 ? 2 : k - 1;
        f->entry[f->start[ids[k]]++] =
            (struct entry){ids[f->cw ? before : next], ids[f->cw ? next : before], i};
        f->place_of[i] = k;
    }
}

static int compare(const void *a, const void *b)
{
    uint32_t x = ((const struct entry *)a)->second, y = ((const struct entry *)b)->second;
    return x < y ? -1 : x > y;
}

/* Triangles that share their two smallest ids are on both sides of an edge, and differ in which of the two comes first; so the
 * second ids of one point's triangles differ. */
static void sort(struct entry *e, size_t n)
{
    enum { FEW = 16 };
    if (n > FEW) {
        qsort(e, n, sizeof *e, compare);
        return;
    }
    for (size_t i = 1; i < n; i++) {
        struct entry here = e[i];
        size_t j = i;
        for (; j > 0 && e[j - 1].second > here.second; j--)
            e[j] = e[j - 1];
        e[j] = here;
    }
}

static void write_triangles(const struct flat *f, uint32_t *out)
{
    uint32_t n = f->t->points.next_id;
    for (uint32_t id = 0, i = 0; id < n; id++) {
        uint32_t end = f->start[id];
        sort(f->entry + i, end - i);
        for (; i < end; i++) {
            const struct entry *e = &f->entry[i];
            f->place_of[e->record] |= 4 * i;
            *out++ = id;
            *out++ = e->second;
            *out++ = e->third;
        }
    }
}

/* The place of a half edge of the mesh in the arrays: clockwise, a triangle's half edges are in the opposite order. */
static uint32_t place(const struct flat *f, uint32_t h)
{
    uint32_t at = f->place_of[h / 8], first = at & 3, k = h & 7;
    uint32_t turn = k >= first ? k - first : k + 3 - first;
    return at / 4 * 3 + (f->cw ? 2 - turn : turn);
}

static void write_halfedges(const struct flat *f, uint32_t *out)
{
    const struct dt_mesh *m = &f->t->mesh;
    for (uint32_t i = 0; i < m->tri_end; i++) {
        if (!is_triangle(&m->half[(size_t)8 * i]))
            continue;
        for (uint32_t h = 8 * i; h < 8 * i + 3; h++) {
            uint32_t twin = dt_twin(m, h);
            out[place(f, h)] = dt_is_ghost(m, twin) ? DT_NONE : place(f, twin);
        }
    }
}

static void flat_clear(struct flat *f)
{
    dt_array_free(f->start);
    dt_array_free(f->entry);
    dt_array_free(f->place_of);
}

enum dt_status dt_flat(const struct dt *t, bool cw, uint32_t *triangles, uint32_t *halfedges)
{
    enum dt_status s = dt_readable(t);
    uint32_t n = s == DT_OK ? dt_mesh_triangles(&t->mesh) : 0;
    if (n == 0)
        return s;
    struct dt_pages *pages = t->mesh.pages;
    size_t ids = (size_t)t->points.next_id + 1;
    struct flat f = {.t = t,
                     .cw = cw,
                     .start = dt_array_new_in(pages, ids, sizeof *f.start),
                     .entry = dt_array_new_in(pages, n, sizeof *f.entry),
                     .place_of = dt_array_new_in(pages, t->mesh.tri_end, sizeof *f.place_of)};
    if (f.start == NULL || f.entry == NULL || f.place_of == NULL) {
        flat_clear(&f);
        return DT_NOMEM;
    }
    for (size_t i = 0; i < ids; i++)
        f.start[i] = 0;
    count(&f);
    distribute(&f);
    write_triangles(&f, triangles);
    if (halfedges != NULL)
        write_halfedges(&f, halfedges);
    flat_clear(&f);
    return DT_OK;
}
