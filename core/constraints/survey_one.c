/* survey_one.c - finds what a border encloses if there are no other constraints; see regions.h.
 *
 * An edge is a side if an odd number of constraints cover it, which the mesh knows (core/mesh/fixed.h). So neither sides nor rooms need
 * lists as in survey.c. There are two faces: 0, outside, and 1, inside, which are any number of pieces of the plane. */
#include <stdlib.h>

#include "core/constraints/regions.h"
#include "core/exact/sum.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"

enum { OUTSIDE, INSIDE, UNKNOWN, FACES = 2 };

struct flood {
    struct dt_mesh *m;
    const struct dt_point *xy;
    struct dt_stop *work;
    uint32_t *triangle; /* owns: stack */
    size_t n, cap;
    struct dt_sum area;
};

bool dt_is_one_border(const struct dt_declared *d)
{
    uint32_t what = DT_NONE;
    if (d->rows == 0 || d->borders != d->rows)
        return false;
    for (uint32_t i = 0; i < d->end; i++) {
        if (!dt_declared_is_live(d, i))
            continue;
        if (what != DT_NONE && d->row[i].what != what)
            return false;
        what = d->row[i].what;
    }
    return true;
}

/* Whether every vertex is the end of an even number of constraints. */
static enum dt_status find_closed(const struct dt_points *p, const struct dt_declared *d,
                                  bool *closed)
{
    uint64_t *odd = calloc(p->end / 64 + (size_t)1, sizeof *odd), any = 0;
    if (odd == NULL)
        return DT_NOMEM;
    for (uint32_t i = 0; i < d->end; i++)
        for (int k = 0; k < 2 && dt_declared_is_live(d, i); k++) {
            uint32_t v = dt_points_vertex(p, d->row[i].end[k]);
            odd[v / 64] ^= (uint64_t)1 << v % 64;
        }
    for (uint32_t i = 0; i <= p->end / 64; i++)
        any |= odd[i];
    free(odd);
    *closed = any == 0;
    return DT_OK;
}

static enum dt_status reach(struct flood *f, uint32_t h, uint32_t face)
{
    dt_face_set(f->m, h, face);
    if (f->n == f->cap) {
        size_t cap = f->cap + f->cap / 2 + 64;
        uint32_t *larger = dt_array_grow(f->triangle, f->n, cap, sizeof *larger);
        if (larger == NULL)
            return DT_NOMEM;
        f->triangle = larger;
        f->cap = cap;
    }
    f->triangle[f->n++] = dt_base(h);
    return DT_OK;
}

/* Visits what is beyond h, whose triangle is in the face. A side that is met from the inside is counted. */
static enum dt_status look_beyond(struct flood *f, uint32_t h, uint32_t face)
{
    uint32_t g = dt_twin(f->m, h);
    if (dt_fixed_count(f->m, h) % 2 == 1) {
        if (face == INSIDE)
            dt_sum_cross(&f->area, f->xy[dt_origin(f->m, h)], f->xy[dt_dest(f->m, h)]);
        face = INSIDE - face;
    }
    return dt_face(f->m, g) == UNKNOWN ? reach(f, g, face) : DT_OK;
}

static enum dt_status flood(struct flood *f)
{
    enum dt_status status = reach(f, f->m->hull, OUTSIDE);
    while (status == DT_OK && f->n > 0) {
        uint32_t t = f->triangle[--f->n], face = dt_face(f->m, t);
        status = dt_work(f->work, 1);
        for (uint32_t k = 0; k < 3 && status == DT_OK; k++)
            status = look_beyond(f, t + k, face);
    }
    return status;
}

static void set_faces(struct dt_mesh *m, uint32_t face)
{
    for (uint32_t t = 0; t < m->tri_end; t++)
        dt_face_set(m, 8 * t, face);
}

/* The region and its range of faces, which an open border has not. */
static enum dt_status make_region(struct dt_regions *r, uint32_t number, bool closed)
{
    r->region = calloc(1, sizeof *r->region);
    r->range = calloc(1, sizeof *r->range);
    r->sorted = calloc(1, sizeof *r->sorted);
    r->start = calloc(3, sizeof *r->start);
    r->inside = calloc(FACES, sizeof *r->inside);
    if (r->region == NULL || r->range == NULL || r->sorted == NULL || r->start == NULL ||
        r->inside == NULL)
        return DT_NOMEM;
    r->region[0] = (struct dt_region){.number = number, .closed = closed};
    r->n = 1;
    r->ranges = closed;
    r->range[0] = (struct dt_region_range){INSIDE, INSIDE + 1, 0, INSIDE + 1};
    r->start[1] = r->start[2] = closed;
    r->inside[INSIDE] = closed;
    r->faces = FACES;
    return DT_OK;
}

enum dt_status dt_regions_survey_one(struct dt_regions *r, struct dt_mesh *m,
                                     const struct dt_points *p, const struct dt_declared *d,
                                     struct dt_stop *work)
{
    struct flood f = {.m = m, .xy = p->xy, .work = work};
    uint32_t row = 0;
    bool closed;
    while (!dt_declared_is_live(d, row))
        row++;
    enum dt_status status = find_closed(p, d, &closed);
    if (status == DT_OK)
        status = make_region(r, d->row[row].what >> 1, closed);
    if (status == DT_OK) {
        set_faces(m, closed ? UNKNOWN : OUTSIDE);
        if (closed && m->vertices >= 2)
            status = flood(&f);
    }
    if (status == DT_OK) {
        r->area = r->region[0].area = dt_sum_half(&f.area);
        r->current = true;
    }
    dt_array_free(f.triangle);
    return status;
}
