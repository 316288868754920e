/* arrays.c - the life of struct dt_arrays, its tables, and its constraints. */
#include "core/arrays/arrays.h"

#include <stdlib.h>
#include <string.h>

#include "core/arrays/workers.h"
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
    const uint32_t *end; /* two for each constraint */
    size_t constraints;
    bool border;
    uint32_t *wrong; /* of constraints that are refused; NULL: there are none */
};

static enum dt_status declare(struct dt *t, const struct input *in, const struct dt_options *opt)
{
    size_t added;
    struct dt_constraint *c = dt_array_new(in->constraints, sizeof *c);
    for (size_t i = 0; c != NULL && i < in->constraints; i++)
        c[i] = (struct dt_constraint){in->end[2 * i], in->end[2 * i + 1], in->border, in->border};
    enum dt_status s =
        c == NULL ? DT_NOMEM : dt_constrain(t, c, in->constraints, opt, &added, in->wrong);
    dt_array_free(c);
    return s;
}

/* Constraints are declared before, so that a build finds all of their edges at once. */
static enum dt_status build(struct dt *t, const struct input *in, const struct dt_options *opt,
                            struct dt_added *added)
{
    enum dt_status s = dt_add_many(t, in->p, in->n, opt, added);
    if (s == DT_OK && in->constraints > 0)
        s = declare(t, in, opt);
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

static enum dt_status triangulate(struct dt_arrays *a, const struct input *in,
                                  const struct dt_options *opt, uint32_t *triangle)
{
    struct dt_added added;
    enum dt_status s = build(a->t, in, opt, &added);
    if (s == DT_OK && added.coincident > 0)
        s = find_heirs(a, added.added, added.coincident);
    if (s == DT_OK)
        measure(a);
    return s == DT_OK ? dt_flat_rows(a->t, false, triangle, &a->place_of) : s;
}

static enum dt_status make(const struct input *in, struct dt_pages *pages, unsigned workers,
                           uint32_t *triangle, struct dt_arrays **out)
{
    struct dt_workers w;
    struct dt_arrays *a = calloc(1, sizeof *a);
    enum dt_status s = DT_NOMEM;
    dt_workers_init(&w, workers);
    if (a != NULL)
        a->t = dt_new_in(0, pages);
    if (a != NULL && a->t != NULL)
        s = triangulate(a, in, &(struct dt_options){.pool = &w.pool}, triangle);
    if (s != DT_OK) {
        dt_arrays_free(a);
        a = NULL;
    }
    *out = a;
    return s;
}

enum dt_status dt_arrays_constrained(const struct dt_point *p, size_t n, const uint32_t *end,
                                     size_t constraints, bool border, struct dt_pages *pages,
                                     unsigned workers, uint32_t *triangle, struct dt_arrays **out,
                                     uint32_t wrong[4])
{
    fenv_t caller = dt_call_begin();
    enum dt_status s =
        make(&(struct input){p, n, end, constraints, border, wrong}, pages, workers, triangle, out);
    dt_call_end(&caller);
    return s;
}

enum dt_status dt_arrays_new(const struct dt_point *p, size_t n, struct dt_pages *pages,
                             unsigned workers, uint32_t *triangle, struct dt_arrays **out)
{
    return dt_arrays_constrained(p, n, NULL, 0, false, pages, workers, triangle, out, NULL);
}

/* ---- constraints ---- */

enum dt_status dt_arrays_constrained_edges(const struct dt_arrays *a, struct dt_ids *out)
{
    return dt_constrained_edges(a->t, out);
}

enum dt_status dt_arrays_inside(const struct dt_arrays *a, const uint32_t *triangle, bool *inside)
{
    struct dt_ids rows = {0};
    struct dt_summary sum;
    fenv_t caller = dt_call_begin();
    enum dt_status s = dt_inside(a->t, DT_NONE, DT_TRIANGLES, false, NULL, &rows);
    dt_summary(a->t, &sum);
    for (size_t i = 0, at = 0; s == DT_OK && i < sum.triangles; i++) {
        inside[i] = at < rows.n && memcmp(&triangle[3 * i], &rows.v[at], 3 * sizeof *rows.v) == 0;
        at += inside[i] ? 3 : 0;
    }
    free(rows.v);
    dt_call_end(&caller);
    return s;
}
