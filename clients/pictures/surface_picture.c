/* surface_picture.c - see surface_picture.h. Triangles are drawn by colour, so that those of one colour share paths;
 * colours are rounded to few enough. */
#include "clients/pictures/surface_picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/meshes/bounds.h"
#include "clients/pictures/legend.h"
#include "clients/pictures/line_labels.h"

static const double *corner(const struct model *m, size_t t, size_t k)
{
    return m->xy + 2 * (size_t)m->triangle[3 * t + k];
}

static double height(const struct model *m, int field, size_t t, size_t k)
{
    return model_value(m, field, m->triangle[3 * t + k]);
}

/* The slope of the plane through a triangle's corners; false if a height is missing or it has no area. */
static bool find_slope(const struct model *m, int field, size_t t, double *dx, double *dy)
{
    const double *a = corner(m, t, 0), *b = corner(m, t, 1), *c = corner(m, t, 2);
    double ux = b[0] - a[0], uy = b[1] - a[1], vx = c[0] - a[0], vy = c[1] - a[1];
    double z = height(m, field, t, 0), up = height(m, field, t, 1) - z,
           vp = height(m, field, t, 2) - z, area = ux * vy - uy * vx;
    *dx = (up * vy - vp * uy) / area;
    *dy = (vp * ux - up * vx) / area;
    return isfinite(*dx) && isfinite(*dy);
}

static void widen(struct relief *r, double z)
{
    r->low = fmin(r->low, z);
    r->high = fmax(r->high, z);
}

/* Slopes are weighted by area: thin triangles may be steep. */
void surface_fit(struct relief *r, const struct model *m, int field)
{
    double sum = 0, areas = 0;
    r->low = HUGE_VAL;
    r->high = -HUGE_VAL;
    for (size_t i = 0; i < m->n && !m->regions; i++)
        widen(r, model_value(m, field, i));
    for (size_t t = 0; t < m->triangles; t++) {
        if (model_is_outside(m, t))
            continue;
        for (size_t k = 0; k < 3; k++)
            widen(r, height(m, field, t, k));
        const double *a = corner(m, t, 0), *b = corner(m, t, 1), *c = corner(m, t, 2);
        double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]), dx, dy;
        if (!find_slope(m, field, t, &dx, &dy))
            continue;
        sum += area * hypot(dx, dy);
        areas += area;
    }
    r->steepness = areas > 0 ? relief_steepness(sum / areas) : 0;
}

struct painted {
    uint32_t rgb, triangle;
};

static int by_colour(const void *a, const void *b)
{
    const struct painted *p = a, *q = b;
    if (p->rgb != q->rgb)
        return p->rgb < q->rgb ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

/* To multiples of 8 in each channel. */
static uint32_t rounded(uint32_t rgb)
{
    return (rgb & 0xF8F8F8) | (rgb >> 5 & 0x070707);
}

bool surface_draw_ground(struct svg *s, const struct model *m, int field, const struct relief *r)
{
    struct painted *p = malloc((m->triangles + 1) * sizeof p[0]);
    size_t n = 0;
    if (p == NULL)
        return false;
    for (size_t t = 0; t < m->triangles; t++) {
        double dx, dy, z = 0;
        if (model_is_outside(m, t))
            svg_triangle(s, "o", false, m->xy, m->triangle + 3 * t);
        if (model_is_outside(m, t) || !find_slope(m, field, t, &dx, &dy))
            continue;
        for (size_t k = 0; k < 3; k++)
            z += height(m, field, t, k) / 3;
        p[n++] = (struct painted){rounded(relief_colour(r, z, dx, dy)), (uint32_t)t};
    }
    qsort(p, n, sizeof p[0], by_colour);
    for (size_t i = 0; i < n; i++) {
        char look[8];
        svg_triangle(s, svg_colour_look(look, p[i].rgb), false, m->xy,
                     m->triangle + 3 * (size_t)p[i].triangle);
    }
    free(p);
    return true;
}

/* ---- constraints ---- */

/* The ends of the constraint before it, of the same kind, need no second line. */
static bool repeats(const struct model *m, size_t i)
{
    const uint32_t *c = m->constraint + 3 * i;
    return i > 0 && c[0] == c[-3] && c[1] == c[-2] &&
           model_is_border(m, i) == model_is_border(m, i - 1);
}

void surface_draw_constraints(struct svg *s, const struct model *m)
{
    for (size_t i = 0; i < m->constraints; i++)
        if (!repeats(m, i))
            svg_constraint(s, model_is_border(m, i), m->xy + 2 * (size_t)m->constraint[3 * i],
                           m->xy + 2 * (size_t)m->constraint[3 * i + 1]);
}

/* ---- contours ---- */

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The levels, ascending, each once. NULL when out of memory. */
static double *find_levels(const struct shapes *lines, size_t *n)
{
    double *level = malloc((lines->n + 1) * sizeof level[0]);
    *n = 0;
    if (level == NULL)
        return NULL;
    for (size_t i = 0; i < lines->n; i++)
        level[i] = lines->shape[i].key;
    qsort(level, lines->n, sizeof level[0], by_value);
    for (size_t i = 0; i < lines->n; i++)
        if (i == 0 || level[i] != level[i - 1])
            level[(*n)++] = level[i];
    return level;
}

/* The levels of the lines, ascending. If there are more than five, each fifth is heavy: the multiples of five steps, as 250 and 500 of
 * a step of 50. */
struct levels {
    const double *v;
    size_t n;
    double step; /* 0: they are no multiples of a step */
};

/* The least difference of two levels; 0 unless all levels are its multiples. */
static double find_step(const double *v, size_t n)
{
    double step = HUGE_VAL;
    for (size_t i = 1; i < n; i++)
        step = fmin(step, v[i] - v[i - 1]);
    for (size_t i = 0; i < n; i++) {
        double times = v[i] / step;
        if (!(fabs(times) < 1e6) || fabs(times - round(times)) > 1e-6)
            return 0;
    }
    return step;
}

static bool is_heavy(const struct levels *levels, double level)
{
    if (levels->n <= 5)
        return false;
    if (levels->step > 0)
        return fmod(round(level / levels->step), 5) == 0;
    const double *at = bsearch(&level, levels->v, levels->n, sizeof *at, by_value);
    return at != NULL && (at - levels->v) % 5 == 4;
}

/* Heavy lines have numbers; if there are none, all lines. */
static bool is_labelled(const void *ctx, const struct shape *line)
{
    const struct levels *levels = ctx;
    bool any = false;
    for (size_t i = 0; i < levels->n && !any; i++)
        any = is_heavy(levels, levels->v[i]);
    return !any || is_heavy(levels, line->key);
}

static void draw_lines(struct svg *s, const struct shapes *lines, const struct levels *levels)
{
    for (size_t pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < lines->n; i++) {
            const struct shape *l = &lines->shape[i];
            bool heavy = is_heavy(levels, l->key);
            if (heavy == (pass == 1))
                svg_line(s, heavy, lines->xy + 2 * l->first, l->n, l->closed);
        }
}

bool surface_write_contours(FILE *out, const char *title, const struct shapes *lines,
                            const struct model *m, int field, const double *box, const char *unit,
                            bool numbers)
{
    double around[4] = {0, 0, 1, 1};
    struct svg s;
    struct relief r = {.style = RELIEF_BOTH};
    struct legend legend;
    struct levels levels;
    double *level = find_levels(lines, &levels.n);
    levels.v = level;
    levels.step = level != NULL ? find_step(level, levels.n) : 0;
    surface_fit(&r, m, field);
    bool ok = legend_of_heights(&legend, &r, m->field[field]) && level != NULL;
    if (!ok) {
        legend_free(&legend);
        free(level);
        return false;
    }
    bounds_of(m->xy, m->n, around);
    svg_begin(&s, out, title, box != NULL ? box : around, m->n, box != NULL,
              m->triangles > 0 ? legend_shown(&legend) : NULL, unit);
    ok = surface_draw_ground(&s, m, field, &r);
    draw_lines(&s, lines, &levels);
    surface_draw_constraints(&s, m);
    ok = (!numbers || line_labels_draw(&s, lines, is_labelled, &levels)) && ok;
    svg_points(&s, NULL, NULL, 0);
    svg_end(&s);
    legend_free(&legend);
    free(level);
    return ok;
}

/* ---- bands ---- */

/* Bands, or without colours the rings of an alpha shape. */
static void draw_polygons(struct svg *s, const struct relief *colours, const struct shapes *shapes)
{
    for (size_t i = 0; i < shapes->n; i++) {
        const struct shape *shape = &shapes->shape[i];
        const double *xy = shapes->xy + 2 * shape->first;
        if (shape->hole)
            svg_hole(s, xy, shape->n);
        else
            svg_polygon(s,
                        colours != NULL ? relief_colour(colours, legend_band_height(shape), 0, 0)
                                        : SVG_NO_COLOUR,
                        xy, shape->n);
    }
}

bool surface_write_bands(FILE *out, const char *title, const struct shapes *bands,
                         const struct model *m, const double *box, const char *unit)
{
    struct relief r = {.style = RELIEF_HEIGHT};
    double around[4] = {0, 0, 1, 1};
    struct legend legend;
    struct svg s;
    if (bands->n > 0) {
        r.low = legend_band_height(bands->shape);
        r.high = legend_band_height(bands->shape + bands->n - 1);
    }
    if (!legend_of_bands(&legend, &r, bands)) {
        legend_free(&legend);
        return false;
    }
    bounds_of(bands->xy, bands->corners, around);
    svg_begin(&s, out, title, box != NULL ? box : around, bands->n, box != NULL,
              legend_shown(&legend), unit);
    draw_polygons(&s, &r, bands);
    surface_draw_constraints(&s, m);
    svg_points(&s, NULL, NULL, 0);
    svg_end(&s);
    legend_free(&legend);
    return true;
}

/* ---- cells ---- */

size_t surface_cut_points(struct model *m, const double *box)
{
    size_t n = 0;
    for (size_t i = 0; i < m->n; i++) {
        const double *p = m->xy + 2 * i;
        if (p[0] < box[0] || p[1] < box[1] || p[0] > box[2] || p[1] > box[3])
            continue;
        memmove(m->xy + 2 * n, p, 2 * sizeof p[0]);
        m->id[n++] = m->id[i];
    }
    return n;
}

bool surface_write_cells(FILE *out, const char *title, const struct shapes *cells, struct model *m,
                         int field, const char *unit)
{
    struct relief r = {.style = RELIEF_HEIGHT};
    struct legend legend = {.colour = NULL};
    double box[4] = {0, 0, 1, 1};
    struct svg s;
    uint32_t place;
    if (field >= 0)
        surface_fit(&r, m, field);
    if (field >= 0 && !legend_of_heights(&legend, &r, m->field[field])) {
        legend_free(&legend);
        return false;
    }
    bounds_of(cells->xy, cells->corners, box);
    svg_begin(&s, out, title, box, cells->n, false, legend_shown(&legend), unit);
    for (size_t i = 0; i < cells->n; i++) {
        const struct shape *c = &cells->shape[i];
        bool known = field >= 0 && model_find(m, (uint32_t)c->key, &place) &&
                     !isnan(model_value(m, field, place));
        uint32_t rgb =
            known ? relief_colour(&r, model_value(m, field, place), 0, 0) : SVG_NO_COLOUR;
        svg_polygon(&s, rgb, cells->xy + 2 * c->first, c->n);
    }
    svg_points(&s, m->xy, m->id, surface_cut_points(m, box));
    svg_end(&s);
    legend_free(&legend);
    return true;
}

/* ---- an alpha shape ---- */

bool surface_write_rings(FILE *out, const char *title, const struct shapes *rings, struct model *m,
                         const double *box, const char *unit)
{
    double around[4] = {0, 0, 1, 1};
    struct svg s;
    bounds_of(m->xy, m->n, around);
    if (box != NULL)
        memcpy(around, box, sizeof around);
    svg_begin(&s, out, title, around, m->n, box != NULL, NULL, unit);
    draw_polygons(&s, NULL, rings);
    svg_points(&s, m->xy, m->id, surface_cut_points(m, around));
    svg_end(&s);
    return true;
}
