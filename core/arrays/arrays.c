/* arrays.c - the life of struct dt_arrays, its tables, and its constraints. */
#include "core/arrays/arrays.h"

#include <stdlib.h>
#include <string.h>

#include "core/arrays/workers.h"
#include "core/memory/memory.h"
#include "core/memory/sort.h"
#include "core/mesh/fixed.h"
#include "core/query/flat.h"

void dt_arrays_free(struct dt_arrays *a)
{
    if (a == NULL)
        return;
    dt_array_free(a->place_of);
    dt_array_free(a->heirs);
    dt_array_free(a->first_heir);
    dt_free(a->t);
    free(a);
}

void dt_arrays_release(void *v)
{
    free(v);
}

void dt_arrays_counts(const struct dt_arrays *a, uint32_t counts[5])
{
    struct dt_summary sum;
    dt_summary(a->t, &sum);
    counts[0] = sum.points;
    counts[1] = sum.coincident;
    counts[2] = sum.triangles;
    counts[3] = sum.edges;
    counts[4] = sum.hull;
}

static enum dt_status read_table(const struct dt *t, enum dt_table table, uint32_t *out)
{
    struct dt_cursor c;
    size_t rows, words;
    enum dt_status s = dt_table_begin(t, NULL, table, false, &c);
    for (size_t left = c.rows; s == DT_OK && left > 0; left -= rows, out += words) {
        s = dt_table_read(t, &c, out, 3 * left, left, &rows, &words);
        if (s == DT_TOOLONG) { /* at a hub: it is called again */
            s = DT_OK;
            rows = words = 0;
        }
    }
    return s;
}

enum dt_status dt_arrays_table(const struct dt_arrays *a, enum dt_table table, uint32_t *out)
{
    return table == DT_LISTS || table == DT_TRIANGLES ? DT_RANGE : read_table(a->t, table, out);
}

void dt_arrays_twins(const struct dt_arrays *a, uint32_t *out)
{
    dt_flat_halfedges(a->t, false, a->place_of, out);
}

/* ---- aliases by representative ---- */

static enum dt_status find_heirs(struct dt_arrays *a, uint32_t n, uint32_t aliases)
{
    uint32_t *pair = dt_array_new(2 * (size_t)aliases, sizeof *pair);
    uint32_t *heirs = dt_array_new(aliases, sizeof *heirs);
    uint32_t *first = dt_array_new((size_t)n + 2, sizeof *first);
    enum dt_status s = pair == NULL || heirs == NULL || first == NULL ? DT_NOMEM : DT_OK;
    if (s == DT_OK)
        s = read_table(a->t, DT_COINCIDENT, pair);
    if (s != DT_OK) {
        dt_array_free(heirs);
        dt_array_free(first);
    } else { /* a counting sort; first[id + 1] moves from where those of id begin to where they end */
        memset(first, 0, ((size_t)n + 2) * sizeof *first);
        for (uint32_t i = 0; i < aliases; i++)
            first[pair[2 * (size_t)i + 1] + 2]++;
        for (uint32_t id = 0; id < n; id++)
            first[id + 2] += first[id + 1];
        for (uint32_t i = 0; i < aliases; i++)
            heirs[first[pair[2 * (size_t)i + 1] + 1]++] = pair[2 * (size_t)i];
        a->heirs = heirs;
        a->first_heir = first;
    }
    dt_array_free(pair);
    return s;
}

/* ---- points ---- */

static void measure(struct dt_arrays *a)
{
    struct dt_bounds box = {0};
    bool done = false;
    while (!done && dt_bounds_read(a->t, NULL, &box, 1u << 20, &done) == DT_OK)
        continue;
    a->size = box.hi.x - box.lo.x + (box.hi.y - box.lo.y);
}

/* The input of a triangulation. */
struct input {
    const struct dt_point *p;
    size_t n;
    const struct dt_constraint *c;
    size_t constraints;
    uint32_t *wrong; /* of constraints that are refused; NULL: there are none */
};

/* Constraints are declared before, so that a build finds all of their edges at once. */
static enum dt_status build(struct dt *t, const struct input *in, const struct dt_options *opt,
                            struct dt_added *added)
{
    size_t declared;
    enum dt_status s = dt_add_many(t, in->p, in->n, opt, added);
    if (s == DT_OK && in->constraints > 0)
        s = dt_constrain(t, in->c, in->constraints, opt, &declared, in->wrong);
    if (s == DT_OK)
        s = dt_triangulate(t, opt);
    if (s == DT_OK && in->wrong != NULL)
        s = dt_survey(t, opt);
    if (s == DT_CROSSES) {
        struct dt_crossed two;
        dt_crossed(t, &two);
        memcpy(in->wrong, (uint32_t[]){two.one.a, two.one.b, two.other.a, two.other.b},
               4 * sizeof *in->wrong);
    }
    return s == DT_OK ? dt_prepare(t, opt) : s;
}

/* The arguments of a call, and the arrays that it makes. */
struct making {
    struct dt_arrays *a;
    const struct input *in;
    uint32_t *triangle; /* NULL: no rows */
};

static enum dt_status triangulate(void *ctx, const struct dt_options *opt)
{
    const struct making *m = ctx;
    struct dt_arrays *a = m->a;
    struct dt_added added;
    enum dt_status s = build(a->t, m->in, opt, &added);
    if (s == DT_OK && added.coincident > 0)
        s = find_heirs(a, added.added, added.coincident);
    if (s == DT_OK)
        measure(a);
    return s == DT_OK && m->triangle != NULL ? dt_flat_rows(a->t, false, m->triangle, &a->place_of)
                                             : s;
}

static enum dt_status make(const struct input *in, struct dt_pages *pages, unsigned workers,
                           uint32_t *triangle, struct dt_arrays **out)
{
    struct dt_arrays *a = calloc(1, sizeof *a);
    struct making m = {a, in, triangle};
    enum dt_status s = a == NULL ? DT_NOMEM : dt_call_build(&a->t, pages, workers, triangulate, &m);
    *out = s == DT_OK ? a : NULL;
    if (s != DT_OK)
        dt_arrays_free(a);
    return s;
}

enum dt_status dt_arrays_declared(const struct dt_point *p, size_t n, const struct dt_constraint *c,
                                  size_t constraints, struct dt_pages *pages, unsigned workers,
                                  uint32_t *triangle, struct dt_arrays **out, uint32_t wrong[4])
{
    return make(&(struct input){p, n, c, constraints, wrong}, pages, workers, triangle, out);
}

enum dt_status dt_arrays_constrained(const struct dt_point *p, size_t n, const uint32_t *end,
                                     size_t constraints, bool border, struct dt_pages *pages,
                                     unsigned workers, uint32_t *triangle, struct dt_arrays **out,
                                     uint32_t wrong[4])
{
    struct dt_constraint *c = dt_array_new(constraints, sizeof *c);
    *out = NULL;
    for (size_t i = 0; c != NULL && i < constraints; i++)
        c[i] = (struct dt_constraint){end[2 * i], end[2 * i + 1], border, border};
    enum dt_status s =
        c == NULL ? DT_NOMEM
                  : dt_arrays_declared(p, n, c, constraints, pages, workers, triangle, out, wrong);
    dt_array_free(c);
    return s;
}

enum dt_status dt_arrays_new(const struct dt_point *p, size_t n, struct dt_pages *pages,
                             unsigned workers, uint32_t *triangle, struct dt_arrays **out)
{
    return make(&(struct input){.p = p, .n = n}, pages, workers, triangle, out);
}

/* ---- constraints ---- */

enum dt_status dt_arrays_constrained_edges(const struct dt_arrays *a, struct dt_ids *out)
{
    return dt_constrained_edges(a->t, out);
}

static const struct dt_regions *regions_of(const struct dt_arrays *a)
{
    return dt_is_constrained(a->t) ? &a->t->constraints->regions : NULL;
}

/* The face of each row; without borders all are in face 0. */
static void read_faces(const struct dt_arrays *a, uint32_t *face)
{
    const struct dt_mesh *m = &a->t->mesh;
    bool any = dt_has_borders(a->t);
    for (uint32_t h = 0; a->place_of != NULL && h < 8 * m->tri_end; h += 8) {
        uint32_t row = dt_row_of(a, h);
        if (row != DT_NONE)
            face[row] = any ? dt_face(m, h) : 0;
    }
}

enum dt_status dt_arrays_inside(const struct dt_arrays *a, const uint32_t *triangle, bool *inside)
{
    const struct dt_mesh *m = &a->t->mesh;
    const struct dt_regions *r = regions_of(a);
    bool any = dt_has_borders(a->t);
    for (uint32_t h = 0; a->place_of != NULL && h < 8 * m->tri_end; h += 8) {
        uint32_t row = dt_row_of(a, h);
        if (row != DT_NONE)
            inside[row] = any && r->inside[dt_face(m, h)];
    }
    return DT_OK;
}

/* Appends the numbers of the borders around a face. */
static enum dt_status add_numbers(const struct dt_regions *r, uint32_t face, struct dt_ids *number)
{
    uint32_t n = dt_regions_of(r, face, NULL, 0);
    enum dt_status s = n == 0 ? DT_OK : dt_ids_reserve(number, n);
    if (s != DT_OK || n == 0)
        return s;
    uint32_t *v = number->v + number->n;
    dt_regions_of(r, face, v, n);
    dt_sort_ids(v, n, NULL, NULL);
    for (uint32_t i = 0; i < n; i++)
        v[i] = r->region[v[i]].number;
    number->n += n;
    return DT_OK;
}

enum dt_status dt_arrays_faces(const struct dt_arrays *a, uint32_t *face, struct dt_ids *number,
                               struct dt_ids *end)
{
    const struct dt_regions *r = dt_has_borders(a->t) ? regions_of(a) : NULL;
    uint32_t faces = r == NULL || r->faces == 0 ? 1 : r->faces;
    enum dt_status s = dt_ids_reserve(end, faces);
    read_faces(a, face);
    for (uint32_t f = 0; s == DT_OK && f < faces; f++) {
        if (r != NULL)
            s = add_numbers(r, f, number);
        end->v[end->n++] = (uint32_t)number->n;
    }
    return s;
}

enum dt_status dt_arrays_regions(const struct dt_arrays *a, struct dt_region **rows, size_t *n,
                                 struct dt_region *inside)
{
    fenv_t caller = dt_call_begin();
    enum dt_status s = dt_regions(a->t, rows, n, inside);
    dt_call_end(&caller);
    return s;
}
