/* reading.c - see reading.h. */
#include "core/contours/reading.h"

#include "core/exact/predicates.h"
#include "core/set/view_rows.h"

#include <stdlib.h>
#include <string.h>

enum dt_status dt_reading_begin(struct dt_reading *r, const struct dt *t, const struct dt_view *v,
                                const struct dt_field *f, const double *level, uint32_t levels,
                                double max_edge)
{
    enum dt_status s = dt_pass_begin(&r->pass, t, v);
    if (s != DT_OK)
        return s;
    r->field = f;
    r->levels = levels;
    r->max_edge = max_edge;
    r->ids = v == NULL ? t->points.next_id : dt_view_next_id(v);
    r->level = malloc(levels * sizeof *level + 1);
    r->class = malloc(r->ids * sizeof *r->class + 1);
    if (r->level == NULL || r->class == NULL)
        return DT_NOMEM;
    if (levels > 0)
        memcpy(r->level, level, levels * sizeof *level);
    return DT_OK;
}

void dt_reading_clear(struct dt_reading *r)
{
    free(r->level);
    free(r->class);
}

/* ---- classes ---- */

/* The number of levels that are not above z. The loop has no branch that depends on z, which would be unpredictable. */
static uint32_t class_of(struct dt_reading *r, double z)
{
    if (isnan(z)) {
        r->gaps = true;
        return DT_CLASS;
    }
    const double *from = r->level;
    uint32_t n = r->levels;
    while (n > 1) {
        uint32_t half = n / 2;
        from += from[half - 1] <= z ? half : 0;
        n -= half;
    }
    uint32_t class = (uint32_t)(from - r->level) + (n > 0 && *from <= z);
    return class > 0 && r->level[class - 1] == z ? class | DT_CLASS_MARK : class;
}

bool dt_reading_classes(struct dt_reading *r)
{
    uint32_t end = r->ids - r->from < DT_READ_PIECE ? r->ids : r->from + DT_READ_PIECE;
    while (r->from < end) {
        uint64_t at = r->from;
        const double *page = dt_field_page(r->field, r->pass.view, &at);
        for (; r->from < end && (page == NULL || r->from < at); r->gaps = true)
            r->class[r->from++] = DT_CLASS;
        for (uint32_t i = 0; r->from < end && i < DT_FIELD_PAGE; i++)
            r->class[r->from++] = class_of(r, page[i]);
    }
    return r->from == r->ids;
}

/* ---- triangles ---- */

enum { AHEAD = 16 };

/* Fetches the classes of the triangle that is AHEAD. */
static void fetch_ahead(const struct dt *t, const struct dt_reading *r)
{
    const struct dt_mesh *m = &t->mesh;
    const uint32_t *v = m->half + 8 * ((size_t)r->pass.record + AHEAD);
    if (r->pass.record + AHEAD >= m->tri_end || v[2] >= DT_DEAD)
        return;
    for (int k = 0; k < 3; k++)
        dt_fetch(&r->class[t->points.id[v[k]]]);
}

static enum dt_status visit_mesh(const struct dt *t, struct dt_reading *r, dt_take_triangle *take,
                                 void *ctx, bool *done)
{
    const struct dt_mesh *m = &t->mesh;
    const uint32_t *id = t->points.id;
    enum dt_status s = DT_OK;
    bool whole = true;
    dt_pass_piece(&r->pass, m);
    for (uint32_t h; s == DT_OK && whole && dt_pass_next(&r->pass, m, &h);) {
        const uint32_t *v = m->half + h;
        fetch_ahead(t, r);
        s = take(ctx, t, (const uint32_t[]){id[v[0]], id[v[1]], id[v[2]]}, &whole);
        r->pass.record -= !whole;
    }
    *done = s == DT_OK && r->pass.record == m->tri_end;
    return s;
}

static enum dt_status visit_table(const struct dt *t, struct dt_reading *r, dt_take_triangle *take,
                                  void *ctx, bool *done)
{
    bool whole = true;
    enum dt_status s = dt_pass_read(&r->pass, t, done);
    for (const uint32_t *row; s == DT_OK && whole && (row = dt_pass_row(&r->pass)) != NULL;) {
        s = take(ctx, t, row, &whole);
        r->pass.at -= whole ? 0 : 3;
    }
    *done = *done && s == DT_OK;
    return s;
}

enum dt_status dt_reading_visit(const struct dt *t, struct dt_reading *r, dt_take_triangle *take,
                                void *ctx, bool *done)
{
    return r->pass.tabled ? visit_table(t, r, take, ctx, done) : visit_mesh(t, r, take, ctx, done);
}

enum dt_status dt_reading_corners(const struct dt *t, const struct dt_reading *r,
                                  const uint32_t *id, struct dt_corner *corner, int n)
{
    double z[3];
    enum dt_status s = DT_OK;
    dt_field_values(r->field, r->pass.view, id, (size_t)n, z);
    for (int k = 0; k < n && s == DT_OK; k++) {
        corner[k].id = id[k];
        corner[k].class = dt_class(r, id[k]);
        corner[k].marked = (r->class[id[k]] & DT_CLASS_MARK) != 0;
        corner[k].z = z[k];
        s = dt_view_get(t, r->pass.view, id[k], &corner[k].p);
    }
    return s;
}

bool dt_reading_is_short(const struct dt_reading *r, const struct dt_corner corner[3])
{
    for (int k = 0; r->max_edge < HUGE_VAL && k < 3; k++)
        if (dt_compare_radius(corner[k].p, corner[(k + 1) % 3].p, r->max_edge) > 0)
            return false;
    return true;
}

bool dt_reading_has_ids(const struct dt *t, const struct dt_reading *r, const uint32_t id[3])
{
    struct dt_corner corner[3];
    for (int k = 0; k < 3; k++)
        if (dt_class(r, id[k]) == DT_CLASS)
            return false;
    for (int k = 0; r->max_edge < HUGE_VAL && k < 3; k++)
        corner[k].p = dt_view_place(t, r->pass.view, id[k]);
    return dt_reading_is_short(r, corner);
}

bool dt_reading_has(const struct dt *t, const struct dt_reading *r, uint32_t record)
{
    const uint32_t *v = t->mesh.half + 8 * (size_t)record, *id = t->points.id;
    return v[2] < DT_DEAD && dt_pass_counts(&r->pass, &t->mesh, 8 * record) &&
           dt_reading_has_ids(t, r, (const uint32_t[]){id[v[0]], id[v[1]], id[v[2]]});
}

/* ---- crossings ---- */

static double between(double a, double b, double share)
{
    double x = a + (b - a) * share, lo = a < b ? a : b, hi = a < b ? b : a;
    return x < lo ? lo : x > hi ? hi : x;
}

struct dt_point dt_level_place(const struct dt_corner *higher, const struct dt_corner *lower,
                               double level)
{
    double fall = higher->z - lower->z, share = (higher->z - level) / fall;
    if (isinf(fall))
        share = (higher->z / 2 - level / 2) / (higher->z / 2 - lower->z / 2);
    return (struct dt_point){between(higher->p.x, lower->p.x, share),
                             between(higher->p.y, lower->p.y, share)};
}

size_t dt_edge_slots(size_t n)
{
    size_t slots = 16;
    while (slots < 2 * n)
        slots *= 2;
    return slots;
}
