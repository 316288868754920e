/* picture.c - see picture.h. */
#include "clients/picture.h"

#include <math.h>
#include <stdlib.h>

#include "clients/svg.h"

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

/* The shade of every triangle, from 0; NULL when out of memory. */
static unsigned char *shades(const struct model *m, enum picture_colour colour)
{
    unsigned char *shade = malloc(m->triangles + 1);
    uint32_t *degree = calloc(m->n + 1, sizeof *degree);
    for (size_t i = 0; degree != NULL && i < 3 * m->triangles; i++)
        degree[m->triangle[i]]++;
    for (size_t t = 0; shade != NULL && degree != NULL && t < m->triangles; t++) {
        const uint32_t *v = m->triangle + 3 * t;
        double s = colour == COLOUR_QUALITY
                       ? SVG_SHADES * quality(point(m, v[0]), point(m, v[1]), point(m, v[2]))
                       : (degree[v[0]] + degree[v[1]] + degree[v[2]]) / 3.0 - 1;
        shade[t] = (unsigned char)(s < 0 ? 0 : s >= SVG_SHADES ? SVG_SHADES - 1 : s);
    }
    free(degree);
    return degree != NULL ? shade : NULL;
}

/* Whether some part of the triangle may be seen. */
static bool in_view(const struct picture *e, const struct model *m, const uint32_t *v)
{
    bool out[4] = {true, true, true, true};
    for (int k = 0; k < 3; k++) {
        const double *p = point(m, v[k]);
        out[0] &= p[0] < e->box[0];
        out[1] &= p[1] < e->box[1];
        out[2] &= p[0] > e->box[2];
        out[3] &= p[1] > e->box[3];
    }
    return !e->has_box || !(out[0] || out[1] || out[2] || out[3]);
}

static bool draw_triangles(struct svg *s, const struct picture *e, const struct model *m)
{
    unsigned char *shade = e->colour != COLOUR_NONE ? shades(m, e->colour) : NULL;
    if (e->colour != COLOUR_NONE && shade == NULL)
        return false;
    for (unsigned pass = 0; pass < (shade != NULL ? SVG_SHADES : 1); pass++) {
        for (size_t t = 0; t < m->triangles; t++) {
            const uint32_t *v = m->triangle + 3 * t;
            if (!in_view(e, m, v) || (shade != NULL && shade[t] != pass))
                continue;
            if (shade != NULL)
                svg_shaded_triangle(s, pass, point(m, v[0]), point(m, v[1]), point(m, v[2]));
            else
                svg_triangle(s, point(m, v[0]), point(m, v[1]), point(m, v[2]));
        }
    }
    free(shade);
    return true;
}

/* Moves the points that are seen to the front; returns their number. */
static size_t cut_points(const struct picture *e, struct model *m)
{
    size_t n = 0;
    for (size_t i = 0; i < m->n; i++) {
        const double *p = point(m, i);
        if (e->has_box &&
            (p[0] < e->box[0] || p[1] < e->box[1] || p[0] > e->box[2] || p[1] > e->box[3]))
            continue;
        m->xy[2 * n] = p[0];
        m->xy[2 * n + 1] = p[1];
        m->id[n++] = m->id[i];
    }
    return n;
}

bool picture_write(FILE *out, const struct picture *e, const char *name, struct model *m)
{
    char title[160];
    struct svg s;
    snprintf(title, sizeof title, "%.100s: Delaunay triangulation of %zu points", name, m->n);
    if (e->has_box)
        svg_begin_box(&s, out, title, e->box, m->n);
    else
        svg_begin(&s, out, title, m->xy, m->n);
    s.numbers = e->numbers;
    if (!draw_triangles(&s, e, m))
        return false;
    svg_hull_begin(&s);
    for (size_t i = 0; i < m->hull_n; i++)
        svg_hull_point(&s, point(m, m->hull[i]));
    svg_hull_end(&s);
    svg_points(&s, m->xy, m->id, cut_points(e, m));
    svg_end(&s);
    return true;
}
