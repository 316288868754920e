/* angle_histogram.c - the histogram of the triangles' angles, as of the moment of a view; see core/delaunay_constraints.h.
 *
 * Nothing depends on the order of the triangles: counts, extremes, and an area that is an exact sum. The area is summed up along the
 * edges of what counts; of the table, along all edges, where those between two triangles cancel out. */
#include "core/exact/sum.h"
#include "core/refining/angles.h"
#include "core/set/view_rows.h"
#include "core/triangle/pass.h"

#include <stdlib.h>

struct dt_measure {
    struct dt_pass pass;
    double cosine2[DT_ANGLE_BINS]; /* of the lower end of each bin */
    struct dt_shapes out;          /* but for area and angles; squares of lengths */
    struct dt_sum area;            /* twice */
    struct dt_angles angles;
};

void dt_measure_free(struct dt_measure *m)
{
    free(m);
}

size_t dt_measure_memory(const struct dt_measure *m)
{
    return sizeof *m;
}

static void begin_to_count(struct dt_measure *m)
{
    m->out = (struct dt_shapes){.shortest = HUGE_VAL};
    m->area = (struct dt_sum){0};
    m->angles = (struct dt_angles){0};
}

enum dt_status dt_measure_begin(const struct dt *t, const struct dt_view *view,
                                struct dt_measure **out)
{
    struct dt_measure *m = *out = calloc(1, sizeof *m);
    if (m == NULL)
        return DT_NOMEM;
    for (int k = 0; k < DT_ANGLE_BINS; k++)
        m->cosine2[k] = dt_cosine2(k * DT_ANGLE_BIN);
    begin_to_count(m);
    enum dt_status s = dt_pass_begin(&m->pass, t, view);
    if (s != DT_OK) {
        free(m);
        *out = NULL;
    }
    return s;
}

enum dt_status dt_measure_inside(struct dt_measure *m, const struct dt *t, uint32_t number)
{
    return dt_pass_inside(&m->pass, t, number);
}

/* ---- triangles ---- */

/* The bin of the least angle. Doubles pass the bins that are certainly too low; then it is decided exactly. */
static int bin_of(const struct dt_measure *m, const struct dt_shape *s)
{
    const double sure = 1 - 0x1p-30;
    double dot = (s->p.x - s->r.x) * (s->q.x - s->r.x) + (s->p.y - s->r.y) * (s->q.y - s->r.y);
    double square = dot * dot, sides = s->qr * s->rp * sure;
    int bin = 0;
    for (int k = 1; k < DT_ANGLE_BINS; k++) /* without a branch, which would be unpredictable */
        bin += square < m->cosine2[k] * sides;
    while (bin + 1 < DT_ANGLE_BINS && !dt_is_sharp(m->cosine2[bin + 1], s))
        bin++;
    return bin;
}

static void add_triangle(struct dt_measure *m, const struct dt_point p[3])
{
    struct dt_shape s;
    dt_shape_of(p[0], p[1], p[2], &s);
    double longest = s.qr > s.rp ? s.qr : s.rp;
    m->out.triangles++;
    m->out.count[bin_of(m, &s)]++;
    m->out.shortest = s.pq < m->out.shortest ? s.pq : m->out.shortest;
    m->out.longest = longest > m->out.longest ? longest : m->out.longest;
    dt_angles_add(&m->angles, &s);
}

static bool counts(const struct dt_measure *m, const struct dt_mesh *mesh, uint32_t h)
{
    return !dt_is_ghost(mesh, h) && dt_pass_counts(&m->pass, mesh, h);
}

static void read_mesh(const struct dt *t, struct dt_measure *m, bool *done)
{
    const struct dt_mesh *mesh = &t->mesh;
    const struct dt_point *xy = t->points.xy;
    dt_pass_piece(&m->pass, mesh);
    for (uint32_t h; dt_pass_next(&m->pass, mesh, &h);) {
        const uint32_t *v = mesh->half + h;
        const struct dt_point p[] = {xy[v[0]], xy[v[1]], xy[v[2]], xy[v[0]]};
        add_triangle(m, p);
        for (uint32_t k = 0; k < 3; k++)
            if (!counts(m, mesh, dt_twin(mesh, h + k)))
                dt_sum_cross(&m->area, p[k], p[k + 1]);
    }
    *done = m->pass.record == mesh->tri_end;
}

static enum dt_status read_table(const struct dt *t, struct dt_measure *m, bool *done)
{
    enum dt_status s = dt_pass_read(&m->pass, t, done);
    for (const uint32_t *row; s == DT_OK && (row = dt_pass_row(&m->pass)) != NULL;) {
        struct dt_point p[4];
        for (size_t k = 0; k < 4; k++)
            p[k] = dt_view_place(t, m->pass.view, row[k % 3]);
        add_triangle(m, p);
        for (size_t k = 0; k < 3; k++)
            dt_sum_cross(&m->area, p[k], p[k + 1]);
    }
    return s;
}

enum dt_status dt_measure_read(const struct dt *t, struct dt_measure *m, bool *done)
{
    enum dt_status s = dt_pass_check(&m->pass, t);
    *done = false;
    if (s != DT_OK)
        return s;
    if (dt_pass_is_late(&m->pass, t))
        begin_to_count(m);
    if (m->pass.tabled)
        return read_table(t, m, done);
    read_mesh(t, m, done);
    return DT_OK;
}

void dt_measure_end(struct dt_measure *m, struct dt_shapes *out)
{
    bool any = m->angles.any;
    *out = m->out;
    out->area = dt_sum_half(&m->area);
    out->least = any ? dt_degrees(m->angles.least) : (double)NAN;
    out->largest = any ? dt_degrees(m->angles.largest) : (double)NAN;
    out->shortest = any ? sqrt(m->out.shortest) : (double)NAN;
    out->longest = any ? sqrt(m->out.longest) : (double)NAN;
}
