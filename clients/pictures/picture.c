/* picture.c - see picture.h. */
#include "clients/pictures/picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/meshes/bounds.h"
#include "clients/pictures/legend.h"
#include "clients/pictures/surface_picture.h"
#include "clients/pictures/svg.h"

static const double *point(const struct model *m, size_t place)
{
    return m->xy + 2 * place;
}

/* Twice the inscribed by the circumscribed circle's radius: 1 for an equilateral triangle, near 0
 * for a flat one. */
static double quality(const double *p, const double *q, const double *r)
{
    double a = hypot(p[0] - q[0], p[1] - q[1]), b = hypot(q[0] - r[0], q[1] - r[1]),
           c = hypot(r[0] - p[0], r[1] - p[1]);
    double product = a * b * c;
    return product > 0 ? (b + c - a) * (c + a - b) * (a + b - c) / product : 0;
}

static unsigned shades_of(enum picture_colour colour)
{
    return colour == COLOUR_NONE ? 1 : colour == COLOUR_ANGLE ? LEGEND_ANGLES : SVG_SHADES;
}

/* The number of triangles at each point. NULL when out of memory. */
static uint32_t *degrees_of(const struct model *m)
{
    uint32_t *degree = calloc(m->n + 1, sizeof *degree);
    for (size_t i = 0; degree != NULL && i < 3 * m->triangles; i++)
        degree[m->triangle[i]]++;
    return degree;
}

/* The shade of every triangle, from 0; NULL when out of memory. */
static unsigned char *shades(const struct model *m, enum picture_colour colour)
{
    unsigned char *shade = malloc(m->triangles + 1);
    uint32_t *degree = degrees_of(m);
    for (size_t t = 0; shade != NULL && degree != NULL && t < m->triangles; t++) {
        const uint32_t *v = m->triangle + 3 * t;
        const double *p = point(m, v[0]), *q = point(m, v[1]), *r = point(m, v[2]);
        double s = colour == COLOUR_ANGLE ? legend_angle(p, q, r)
                   : colour == COLOUR_QUALITY
                       ? SVG_SHADES * quality(p, q, r)
                       : (degree[v[0]] + degree[v[1]] + degree[v[2]]) / 3.0 - 1;
        shade[t] = (unsigned char)(s < 0 ? 0 : fmin(s, shades_of(colour) - 1));
    }
    free(degree);
    return degree != NULL ? shade : NULL;
}

/* Outside pale, so that it is below; then each colour by itself, since a path has one. */
static void draw_regions(struct svg *s, const struct model *m)
{
    char look[3] = "r0";
    for (int64_t colour = MODEL_OUTSIDE; colour < 8; colour++) {
        look[1] = (char)('0' + colour);
        for (size_t t = 0; t < m->triangles; t++) {
            const uint32_t *v = m->triangle + 3 * t;
            int64_t region = m->region[t];
            if (region == MODEL_OUTSIDE ? colour == MODEL_OUTSIDE : region % 8 == colour)
                svg_triangle(s, colour == MODEL_OUTSIDE ? "o" : look, false, m->xy, v);
        }
    }
}

static bool draw_triangles(struct svg *s, const struct picture *e, const struct model *m)
{
    if (e->colour == COLOUR_RELIEF)
        return surface_draw_ground(s, m, m->z, &e->relief);
    if (e->colour == COLOUR_NONE && m->regions) {
        draw_regions(s, m);
        return true;
    }
    unsigned char *shade = e->colour != COLOUR_NONE ? shades(m, e->colour) : NULL;
    if (e->colour != COLOUR_NONE && shade == NULL)
        return false;
    for (unsigned pass = 0; pass < shades_of(e->colour); pass++) {
        const bool coloured = e->colour == COLOUR_ANGLE;
        char look[8] = "t";
        if (coloured)
            svg_colour_look(look, legend_angle_colour(pass));
        else if (shade != NULL)
            snprintf(look, sizeof look, "q%u", pass % SVG_SHADES);
        for (size_t t = 0; t < m->triangles; t++)
            if (shade == NULL || shade[t] == pass)
                svg_triangle(s, model_is_outside(m, t) ? "o" : look, coloured, m->xy,
                             m->triangle + 3 * t);
    }
    free(shade);
    return true;
}

static bool is_shown(const struct picture *e, const double *p)
{
    return !e->has_box ||
           (p[0] >= e->box[0] && p[1] >= e->box[1] && p[0] <= e->box[2] && p[1] <= e->box[3]);
}

static size_t count_shown(const struct picture *e, const struct model *m)
{
    size_t n = 0;
    for (size_t i = 0; i < m->n; i++)
        n += is_shown(e, point(m, i));
    return n;
}

/* Everything, or what the box holds. */
static void choose_box(const struct picture *e, const struct model *m, double *box)
{
    if (e->has_box)
        memcpy(box, e->box, sizeof e->box);
    else
        bounds_of(m->xy, m->n, box);
}

/* Explains the colours of the picture. False when out of memory. */
static bool choose_legend(struct picture *e, const struct model *m, struct legend *l)
{
    static const struct svg_legend shades[] = {
        [COLOUR_QUALITY] = {.low = "flat", .high = "equilateral", .colours = SVG_SHADES},
        [COLOUR_DEGREE] = {.low = "degree 1", .high = "10 or more", .colours = SVG_SHADES}};
    *l = (struct legend){.colour = NULL};
    if (e->colour == COLOUR_ANGLE)
        return legend_of_angles(l);
    if (e->colour == COLOUR_RELIEF) {
        surface_fit(&e->relief, m, m->z);
        return legend_of_heights(l, &e->relief, m->field[m->z]);
    }
    if (e->colour != COLOUR_NONE)
        l->svg = shades[e->colour];
    return true;
}

bool picture_write(FILE *out, struct picture *e, const char *name, struct model *m)
{
    char title[200], part[40] = "";
    double box[4];
    struct svg s;
    struct legend legend;
    if (e->geographic) {
        map_projection_project(&e->projection, m->xy, m->n);
        map_projection_project(&e->projection, e->box, 2);
    }
    e->shown = count_shown(e, m);
    if (e->shown < m->n)
        snprintf(part, sizeof part, "%zu of ", e->shown);
    snprintf(title, sizeof title, "%.100s: Delaunay triangulation of %s%zu points", name, part,
             m->n);
    choose_box(e, m, box);
    bool ok = choose_legend(e, m, &legend);
    if (ok) {
        svg_begin(&s, out, title, box, e->shown, e->has_box, legend_shown(&legend),
                  e->geographic ? "km" : "");
        s.numbers = e->numbers;
        ok = draw_triangles(&s, e, m);
    }
    legend_free(&legend);
    if (!ok)
        return false;
    svg_hull(&s, m->xy, m->hull, m->hull_n);
    surface_draw_constraints(&s, m);
    if (e->has_box)
        surface_cut_points(m, e->box);
    svg_points(&s, m->xy, m->id, e->colour == COLOUR_RELIEF ? 0 : e->shown);
    e->unlabelled = s.unlabelled;
    svg_place(&s, &e->left, &e->top, &e->pixel);
    svg_end(&s);
    return true;
}
