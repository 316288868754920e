/* volume.c - volumes between the linear surface and a level, or another linear surface.
 *
 * h is the height of the surface over the other one: a number at each corner, linear in a triangle. If the heights of a
 * triangle have one sign, the volume is a third of their sum times the area. Otherwise one corner is alone on its side:
 *
 *              lone              The tip between the lone corner and the line h = 0 has the height of its corner, and
 *              /  \              shares h / (h - h1) and h / (h - h2) of two edges, so of the area. The volume on the
 *         h = 0 -- -- -          other side of the line is what the tip has too much beside the whole triangle:
 *          /        \
 *         1 -------- 2           6 tip = twice the area * h * h / (h - h1) * h / (h - h2)
 *                                6 rest = 6 tip - twice the area * (h + h1 + h2), if h > 0
 *
 * All factors are positive, so their relative errors add up. The numbers of a triangle are rounded, and depend on the triangle
 * alone. Their sums are exact, so the order of the triangles does not matter.
 *
 * Errors, with u = 2^-53:
 *
 *     a height                     u
 *     the sum of three heights     2 u of the sum of their magnitudes; both volumes have at least a sixth of that sum together
 *     a tip                        9 u
 *     a rest                       that of the tip, and 12 u of both volumes
 *     twice the area               64 u (twice_area)
 *     a product of area and sum    2 u
 *
 * Together that is less than 2^-46.
 */
#include "core/exact/box.h"
#include "core/exact/sum.h"
#include "core/exact/vectors.h"
#include "core/query/query.h"
#include "core/set/view_rows.h"
#include "core/triangle/clip.h"
#include "core/triangle/pass.h"

#include "core/delaunay_surface.h"

#include <math.h>
#include <stdlib.h>

enum {
    PIECE = 16384, /* heights */
    SOME = 256     /* heights whose ids are on the stack */
};

enum stage { HEIGHTS, TRIANGLES, READ };

struct dt_volume {
    struct dt_pass pass;
    const struct dt_field *field, *minus; /* borrows; minus: NULL for the level */
    double level, scale;                  /* of values, so that no difference is infinite */
    bool clipped;
    struct dt_point lo, hi; /* of the box, if clipped */
    enum stage stage;
    double *height; /* owns `room`: scaled; by vertex, but by id for the table */
    uint32_t ids, room, from;
    struct dt_wide_sum above, below, area; /* six times the volumes, scaled; twice the area */
};

void dt_volume_free(struct dt_volume *v)
{
    if (v == NULL)
        return;
    free(v->height);
    free(v);
}

/* 2^-8 if there are values from 2^1000 on. Heights lose bits by this factor only where they are too small to matter beside such
 * values. */
static double scale_for(const struct dt_field *field, const struct dt_field *minus, double level)
{
    struct dt_field_summary sum;
    double most = fabs(level);
    for (int k = 0; k < 2; k++) {
        const struct dt_field *f = k == 0 ? field : minus;
        if (f == NULL)
            continue;
        dt_field_summary(f, &sum);
        most = fmax(most, fmax(-sum.least, sum.most));
    }
    return most >= 0x1p1000 ? 0x1p-8 : 1;
}

enum dt_status dt_volume_begin(const struct dt *t, const struct dt_view *view,
                               const struct dt_field *field, const struct dt_field *minus,
                               double level, struct dt_volume **out)
{
    struct dt_volume *v = *out = calloc(1, sizeof *v);
    if (v == NULL)
        return DT_NOMEM;
    v->field = field;
    v->minus = minus;
    v->scale = scale_for(field, minus, level);
    v->level = level * v->scale;
    v->ids = view == NULL ? t->points.next_id : dt_view_next_id(view);
    /* points that were taken back have given their ids back, but not their vertices */
    v->room = t->points.end > v->ids ? t->points.end : v->ids;
    v->height = malloc(v->room * sizeof *v->height + 1);
    enum dt_status s = v->height == NULL ? DT_NOMEM : dt_pass_begin(&v->pass, t, view);
    if (s != DT_OK) {
        dt_volume_free(v);
        *out = NULL;
    }
    return s;
}

size_t dt_volume_memory(const struct dt_volume *v)
{
    return sizeof *v + v->room * sizeof *v->height;
}

void dt_volume_clip(struct dt_volume *v, struct dt_point lo, struct dt_point hi)
{
    v->clipped = true;
    v->lo = lo;
    v->hi = hi;
}

enum dt_status dt_volume_inside(struct dt_volume *v, const struct dt *t, uint32_t number)
{
    return dt_pass_inside(&v->pass, t, number);
}

/* ---- heights ---- */

/* Of n ids, from `height` number `from` on. */
static void read_some(struct dt_volume *v, const uint32_t *id, uint32_t n)
{
    double *height = v->height + v->from, low[SOME];
    dt_field_values(v->field, v->pass.view, id, n, height);
    if (v->minus != NULL)
        dt_field_values(v->minus, v->pass.view, id, n, low);
    for (uint32_t i = 0; i < n; i++)
        height[i] = height[i] * v->scale - (v->minus == NULL ? v->level : low[i] * v->scale);
    v->from += n;
}

static void read_heights(const struct dt *t, struct dt_volume *v)
{
    bool by_id = v->pass.tabled;
    uint32_t all = by_id ? v->ids : t->points.end, id[SOME];
    for (uint32_t done = 0; done < PIECE && v->from < all; done += SOME) {
        uint32_t n = all - v->from < SOME ? all - v->from : SOME;
        for (uint32_t i = 0; i < n; i++)
            id[i] = by_id ? v->from + i : t->points.id[v->from + i];
        read_some(v, id, n);
    }
    if (v->from == all)
        v->stage = TRIANGLES;
}

/* ---- triangles ---- */

/* Twice the area of a triangle that is not flat, in double words; *size: of the two products. */
static double area_in_double_words(const struct dt_point p[3], double *size)
{
    struct dt_bounded2 area =
        dt_vector2_cross(dt_vector2_of(p[0], p[1]), dt_vector2_of(p[0], p[2]));
    *size = area.size;
    return area.value.hi;
}

/* Twice the area of a counterclockwise triangle, with an error below 64 u. In doubles the difference of the products errs by 3 u of
 * their sizes. These are at most 16 times the difference where doubles are used. In double words the error is 2^-100 of the
 * sizes, which are at most 2^50 times the difference. */
static double twice_area(const struct dt_point p[3])
{
    double ax = p[1].x - p[0].x, ay = p[1].y - p[0].y;
    double bx = p[2].x - p[0].x, by = p[2].y - p[0].y;
    double plus = ax * by, minus = ay * bx, size = fabs(plus) + fabs(minus);
    double area = plus - minus;
    if (area * 16 >= size)
        return area;
    area = area_in_double_words(p, &size);
    if (area * 0x1p50 >= size)
        return area;
    struct dt_sum sum = {0};
    for (int k = 0; k < 3; k++)
        dt_sum_cross(&sum, p[k], p[(k + 1) % 3]);
    return 2 * dt_sum_half(&sum);
}

/* Six times what is on both sides, for twice the area 1: of the corner that is alone, with h > 0, and of the others. */
static double tip_of(double h, double h1, double h2)
{
    return h * (h / (h - h1)) * (h / (h - h2));
}

static double rest_of(double tip, double whole)
{
    return tip > whole ? tip - whole : 0;
}

/* A triangle with heights on both sides, times 2^exponent, given twice its area. */
static void add_both_sides(struct dt_volume *v, double area, const double h[3], int exponent)
{
    int lone = 0, above = (h[0] > 0) + (h[1] > 0) + (h[2] > 0);
    double sign = above == 1 ? 1 : -1;
    while (!(sign * h[lone] > 0))
        lone++;
    double tip = tip_of(sign * h[lone], sign * h[(lone + 1) % 3], sign * h[(lone + 2) % 3]);
    double rest = rest_of(tip, sign * (h[0] + h[1] + h[2]));
    dt_wide_sum_add_any(&v->above, area, above == 1 ? tip : rest, exponent);
    dt_wide_sum_add_any(&v->below, area, above == 1 ? rest : tip, exponent);
}

/* The same where products of heights would lose bits. */
static void add_small(struct dt_volume *v, double area, const double h[3])
{
    enum { MORE = 200 };
    double larger[3];
    for (int k = 0; k < 3; k++)
        larger[k] = ldexp(h[k], MORE);
    add_both_sides(v, area, larger, -MORE);
}

static void add_triangle(struct dt_volume *v, const struct dt_point p[3], const double h[3])
{
    double area = twice_area(p), whole = h[0] + h[1] + h[2];
    double least = dt_lesser(dt_lesser(h[0], h[1]), h[2]),
           most = dt_greater(dt_greater(h[0], h[1]), h[2]);
    dt_wide_sum_add(&v->area, area, 1);
    if (least >= 0)
        dt_wide_sum_add(&v->above, area, whole);
    else if (most <= 0)
        dt_wide_sum_add(&v->below, area, -whole);
    else if (most < 0x1p-900 && least > -0x1p-900)
        add_small(v, area, h);
    else
        add_both_sides(v, area, h, 0);
}

/* ---- in the box ---- */

static bool is_within(const struct dt_volume *v, struct dt_point p)
{
    return p.x >= v->lo.x && p.x <= v->hi.x && p.y >= v->lo.y && p.y <= v->hi.y;
}

/* Whether all of it is beyond one side of the box. */
static bool is_beside(const struct dt_volume *v, const struct dt_point p[3])
{
    return (p[0].x < v->lo.x && p[1].x < v->lo.x && p[2].x < v->lo.x) ||
           (p[0].x > v->hi.x && p[1].x > v->hi.x && p[2].x > v->hi.x) ||
           (p[0].y < v->lo.y && p[1].y < v->lo.y && p[2].y < v->lo.y) ||
           (p[0].y > v->hi.y && p[1].y > v->hi.y && p[2].y > v->hi.y);
}

/* What is below 2^-1450 is less than the least double, also if there are 2^30 of them. */
static void add_scaled(struct dt_wide_sum *sum, const struct dt_scaled *part)
{
    if (part->exponent > -1450)
        dt_wide_sum_add_any(sum, part->value, 1, part->exponent);
}

/* Heights are exact here: the part in the box may be where they are much smaller than at the corners. */
static void add_part(struct dt_volume *v, const struct dt_point p[3], const uint32_t id[3])
{
    struct dt_slab slab = {.p = {p[0], p[1], p[2]}};
    dt_field_values(v->field, v->pass.view, id, 3, slab.top);
    if (v->minus != NULL)
        dt_field_values(v->minus, v->pass.view, id, 3, slab.base);
    for (int k = 0; k < 3; k++) {
        slab.top[k] *= v->scale;
        slab.base[k] = v->minus == NULL ? v->level : slab.base[k] * v->scale;
    }
    struct dt_slab_parts part = dt_slab_clip(&slab, v->lo, v->hi);
    add_scaled(&v->above, &part.above);
    add_scaled(&v->below, &part.below);
    add_scaled(&v->area, &part.area);
}

static void add_in_box(struct dt_volume *v, const struct dt_point p[3], const double h[3],
                       const uint32_t id[3])
{
    if (!v->clipped || (is_within(v, p[0]) && is_within(v, p[1]) && is_within(v, p[2])))
        add_triangle(v, p, h);
    else if (!is_beside(v, p))
        add_part(v, p, id);
}

/* ---- in pieces ---- */

static void read_record(const struct dt *t, struct dt_volume *v, const uint32_t *corner)
{
    static const uint32_t next[] = {1, 2, 0, 1};
    const uint32_t *id = t->points.id;
    uint32_t least;
    uint32_t k = dt_least_of_three(id[corner[0]], id[corner[1]], id[corner[2]], &least);
    const uint32_t vertex[] = {corner[k], corner[next[k]], corner[next[k + 1]]};
    const struct dt_point *xy = t->points.xy, p[] = {xy[vertex[0]], xy[vertex[1]], xy[vertex[2]]};
    const double h[] = {v->height[vertex[0]], v->height[vertex[1]], v->height[vertex[2]]};
    const uint32_t row[] = {id[vertex[0]], id[vertex[1]], id[vertex[2]]};
    if (!isnan(h[0] + h[1] + h[2]))
        add_in_box(v, p, h, row);
}

static void read_mesh(const struct dt *t, struct dt_volume *v, bool *done)
{
    dt_pass_piece(&v->pass, &t->mesh);
    for (uint32_t h; dt_pass_next(&v->pass, &t->mesh, &h);)
        read_record(t, v, t->mesh.half + h);
    *done = v->pass.record == t->mesh.tri_end;
}

static enum dt_status read_table(const struct dt *t, struct dt_volume *v, bool *done)
{
    enum dt_status s = dt_pass_read(&v->pass, t, done);
    for (const uint32_t *row; s == DT_OK && (row = dt_pass_row(&v->pass)) != NULL;) {
        struct dt_point p[3];
        double h[3];
        for (size_t k = 0; k < 3; k++) {
            p[k] = dt_view_place(t, v->pass.view, row[k]);
            h[k] = v->height[row[k]];
        }
        if (!isnan(h[0] + h[1] + h[2]))
            add_in_box(v, p, h, row);
    }
    return s;
}

static enum dt_status read_triangles(const struct dt *t, struct dt_volume *v)
{
    bool done;
    enum dt_status s = DT_OK;
    if (v->pass.tabled)
        s = read_table(t, v, &done);
    else
        read_mesh(t, v, &done);
    if (s == DT_OK && done)
        v->stage = READ;
    return s;
}

/* Begins again, with what the view has saved. */
static void begin_again(struct dt_volume *v)
{
    v->stage = HEIGHTS;
    v->from = 0;
    v->above = v->below = v->area = (struct dt_wide_sum){0};
}

enum dt_status dt_volume_read(const struct dt *t, struct dt_volume *v, bool *done)
{
    enum dt_status s = dt_pass_check(&v->pass, t);
    if (s == DT_OK && v->stage != READ && dt_pass_is_late(&v->pass, t))
        begin_again(v);
    if (s == DT_OK && v->stage == HEIGHTS)
        read_heights(t, v);
    else if (s == DT_OK && v->stage == TRIANGLES)
        s = read_triangles(t, v);
    *done = s == DT_OK && v->stage == READ;
    return s;
}

void dt_volume_end(const struct dt_volume *v, struct dt_volumes *out)
{
    out->above = dt_wide_sum_over(&v->above, 6) / v->scale;
    out->below = dt_wide_sum_over(&v->below, 6) / v->scale;
    out->area = dt_wide_sum_over(&v->area, 2);
}
