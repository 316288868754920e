/* svg.c - the drawing. The longer side of the points' box is 16,000 units, so that whole numbers
 * are fine enough and a triangle takes some 20 bytes. Triangles and points share paths, a few
 * hundred at a time: an element for each would make viewers slow, and one path for all of them
 * slower still. */
#include "clients/svg.h"

#include <math.h>
#include <string.h>

#define SIDE 16000.0
#define MARGIN 400.0
#define PATH_MAX_ITEMS 500
#define LABELS_MAX 100

static const char style[] = "<style>\n"
                            "path { fill: none; stroke-linejoin: round; stroke-linecap: round }\n"
                            ".t { fill: #e9f1fa; stroke: #6d94bf }\n"
                            ".h { stroke: #d1495b }\n"
                            ".p { stroke: #17324f }\n"
                            ".q0 { fill: #67001f } .q1 { fill: #b2182b } .q2 { fill: #d6604d }\n"
                            ".q3 { fill: #f4a582 } .q4 { fill: #fddbc7 } .q5 { fill: #e8eef2 }\n"
                            ".q6 { fill: #d1e5f0 } .q7 { fill: #92c5de } .q8 { fill: #4393c3 }\n"
                            ".q9 { fill: #2166ac }\n"
                            ".q0, .q1, .q2, .q3, .q4, .q5, .q6, .q7, .q8, .q9 { stroke: #fff }\n"
                            "text { font-family: sans-serif; fill: #17324f }\n"
                            "</style>\n";

static double clamp(double v, double lo, double hi)
{
    return v < lo ? lo : v > hi ? hi : v;
}

struct box {
    double x0, y0, x1, y1;
};

static struct box box_of(const double *xy, size_t n)
{
    struct box b = {xy[0], xy[1], xy[0], xy[1]};
    for (size_t i = 1; i < n; i++) {
        b.x0 = fmin(b.x0, xy[2 * i]);
        b.x1 = fmax(b.x1, xy[2 * i]);
        b.y0 = fmin(b.y0, xy[2 * i + 1]);
        b.y1 = fmax(b.y1, xy[2 * i + 1]);
    }
    return b;
}

/* Lines and dots are as wide as suits the distance that n points evenly spread would have. */
static void choose_widths(struct svg *s, double w, double h, size_t n)
{
    double spacing = sqrt((w + MARGIN) * (h + MARGIN) / (double)n);
    s->line = clamp(0.02 * spacing, 1.2, 24);
    s->dot = clamp(0.12 * spacing, 4, 180);
}

void svg_begin(struct svg *s, FILE *out, const char *title, const double *xy, size_t n)
{
    struct box b = box_of(xy, n);
    svg_begin_box(s, out, title, (const double[4]){b.x0, b.y0, b.x1, b.y1}, n);
}

void svg_begin_box(struct svg *s, FILE *out, const char *title, const double *box, size_t n)
{
    struct box b = {box[0], box[1], box[2], box[3]};
    double side = fmax(b.x1 - b.x0, b.y1 - b.y0);
    double scale = side > 0 ? SIDE / side : 1;
    double w = (b.x1 - b.x0) * scale, h = (b.y1 - b.y0) * scale;
    *s = (struct svg){.out = out, .x0 = b.x0, .y1 = b.y1, .scale = scale};
    s->width = w + 2 * MARGIN;
    s->height = h + 2 * MARGIN;
    choose_widths(s, w, h, n > 0 ? n : 1);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" "
            "height=\"%.0f\">\n"
            "<title>%s</title>\n%s"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            s->width, s->height, ceil(s->width / 10), ceil(s->height / 10), title, style);
}

static long place_x(const struct svg *s, const double *p)
{
    return lround((p[0] - s->x0) * s->scale + MARGIN);
}

static long place_y(const struct svg *s, const double *p)
{
    return lround((s->y1 - p[1]) * s->scale + MARGIN);
}

static void path_end(struct svg *s)
{
    if (s->in_path > 0)
        fputs("\"/>\n", s->out);
    s->in_path = 0;
}

/* Opens a path of the given class unless one is open, and ends it every few hundred items. */
static void path_item(struct svg *s, const char *class, double width)
{
    if (s->in_path == PATH_MAX_ITEMS || strcmp(s->class, class) != 0)
        path_end(s);
    snprintf(s->class, sizeof s->class, "%s", class);
    if (s->in_path++ == 0)
        fprintf(s->out, "<path class=\"%s\" stroke-width=\"%.4g\" d=\"", class, width);
}

static void draw_triangle(struct svg *s, const char *class, const double *a, const double *b,
                          const double *c)
{
    long ax = place_x(s, a), ay = place_y(s, a), bx = place_x(s, b), by = place_y(s, b);
    path_item(s, class, s->line);
    fprintf(s->out, "M%ld %ldl%ld %ld %ld %ldz", ax, ay, bx - ax, by - ay, place_x(s, c) - bx,
            place_y(s, c) - by);
    s->triangles++;
}

void svg_triangle(struct svg *s, const double *a, const double *b, const double *c)
{
    draw_triangle(s, "t", a, b, c);
}

void svg_shaded_triangle(struct svg *s, unsigned shade, const double *a, const double *b,
                         const double *c)
{
    draw_triangle(s, (const char[]){'q', (char)('0' + shade % SVG_SHADES), 0}, a, b, c);
}

void svg_hull_begin(struct svg *s)
{
    path_end(s);
}

void svg_hull_point(struct svg *s, const double *p)
{
    if (s->hull == 0)
        fprintf(s->out, "<path class=\"h\" stroke-width=\"%.4g\" d=\"M",
                clamp(3 * s->line, 14, 60));
    fprintf(s->out, "%s%ld %ld",
            s->hull == 0        ? ""
            : s->hull % 12 == 0 ? "\n"
                                : " ",
            place_x(s, p), place_y(s, p));
    s->hull++;
}

/* A hull without a triangle runs along a line and does not come back. */
void svg_hull_end(struct svg *s)
{
    if (s->hull > 0)
        fputs(s->triangles > 0 ? "z\"/>\n" : "\"/>\n", s->out);
}

static void labels(struct svg *s, const double *xy, const uint32_t *id, size_t n)
{
    fprintf(s->out, "<g font-size=\"%.0f\">\n", clamp(2.2 * s->dot, 150, 400));
    for (size_t i = 0; i < n; i++)
        fprintf(s->out, "<text x=\"%.0f\" y=\"%.0f\">%u</text>\n",
                (double)place_x(s, xy + 2 * i) + 0.7 * s->dot,
                (double)place_y(s, xy + 2 * i) - 0.7 * s->dot, id[i]);
    fputs("</g>\n", s->out);
}

void svg_points(struct svg *s, const double *xy, const uint32_t *id, size_t n)
{
    path_end(s);
    for (size_t i = 0; i < n; i++) {
        path_item(s, "p", s->dot); /* a line of no length with round caps is a dot */
        fprintf(s->out, "M%ld %ldh0", place_x(s, xy + 2 * i), place_y(s, xy + 2 * i));
    }
    path_end(s);
    if (n <= LABELS_MAX || s->numbers)
        labels(s, xy, id, n);
}

void svg_end(struct svg *s)
{
    path_end(s);
    fputs("</svg>\n", s->out);
}
