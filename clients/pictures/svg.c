/* svg.c - the drawing. The longer side of the points' box is 16,000 units, so that whole numbers are precise
 * enough and a triangle takes about 20 bytes. Triangles and points share paths, a few hundred at a time: an
 * element for each would make viewers slow, and one path for all of them slower still. */
#include "clients/pictures/svg.h"

#include "clients/pictures/labels.h"

#include <math.h>
#include <string.h>

#define SIDE 16000.0
#define MARGIN 400.0
#define FOOTER 700.0 /* a row below the drawing */
#define TEXT 320.0   /* height of its letters */
#define SWATCH 300.0
#define PIXEL 10.0 /* of a picture that is made of the drawing */
#define PATH_MAX_ITEMS 500
#define LABELS_MAX 100

#define INK "#17324f" /* of texts, points and the scale */

/* The look of each class of paths, as attributes, which all programs understand. The class is there for a reader's own style sheet. */
static const struct {
    const char *class, *fill, *stroke;
} looks[] = {{"t", "#e9f1fa", "#6d94bf"},
             {"h", NULL, "#d1495b"},
             {"c", NULL, "#1f1f1f"},
             {"b", NULL, "#7b2d8b"},
             {"p", NULL, INK},
             {"o", "#fbfbfb", "#e4e4e4"},
             {"r0", "#e9f1fa", "#6d94bf"},
             {"r1", "#fdeed3", "#d1a054"},
             {"r2", "#e3f4e1", "#75b06f"},
             {"r3", "#fbe3e6", "#d58590"},
             {"r4", "#ece6f6", "#9a83c4"},
             {"r5", "#dff4f3", "#62b1ad"},
             {"r6", "#f4f3d0", "#aba84e"},
             {"r7", "#f3e5dc", "#b58a6c"},
             {"k", NULL, "#5b3a1e"},
             {"l", NULL, "#3c2410"},
             {"f", NULL, "#b5c7d9"},
             {"s", NULL, INK},
             {"q0", "#67001f", "#fff"},
             {"q1", "#b2182b", "#fff"},
             {"q2", "#d6604d", "#fff"},
             {"q3", "#f4a582", "#fff"},
             {"q4", "#fddbc7", "#fff"},
             {"q5", "#e8eef2", "#fff"},
             {"q6", "#d1e5f0", "#fff"},
             {"q7", "#92c5de", "#fff"},
             {"q8", "#4393c3", "#fff"},
             {"q9", "#2166ac", "#fff"}};

/* Opens a path of that class, or of the colour #rrggbb, with edges in that colour or in white. */
static void open_path(const struct svg *s, const char *class, bool white_edges, double width)
{
    const char *fill = class, *stroke = white_edges ? "#fff" : class;
    fputs("<path", s->out);
    for (size_t i = 0; i < sizeof looks / sizeof looks[0]; i++)
        if (strcmp(looks[i].class, class) == 0) {
            fprintf(s->out, " class=\"%s\"", class);
            fill = looks[i].fill;
            stroke = looks[i].stroke;
        }
    if (fill != NULL)
        fprintf(s->out, " fill=\"%s\"", fill);
    fprintf(s->out, " stroke=\"%s\" stroke-width=\"%.4g\" d=\"", stroke, width);
}

static double clamp(double v, double lo, double hi)
{
    return v < lo ? lo : v > hi ? hi : v;
}

/* The width of lines and dots follows from the distance that n evenly spread points would have. */
static void choose_widths(struct svg *s, double w, double h, size_t n)
{
    double spacing = sqrt((w + MARGIN) * (h + MARGIN) / (double)n);
    s->line = clamp(0.02 * spacing, 1.2, 24);
    s->dot = clamp(0.12 * spacing, 4, 180);
}

/* The width of a text, about: digits and small letters of a sans-serif font. */
static double text_width(size_t letters, double size)
{
    return 0.58 * size * (double)letters;
}

/* The letters of UTF-8. */
static size_t letters_of(const char *text)
{
    size_t n = 0;
    for (; *text != '\0'; text++)
        n += ((unsigned char)*text & 0xC0) != 0x80;
    return n;
}

/* A round length of at most a third of the visible width, except in a narrow drawing. */
static double scale_length(const struct svg *s)
{
    double most = fmax(s->wide, 0.3 * s->high) / 3 / s->scale, step = pow(10, floor(log10(most)));
    return most >= 5 * step ? 5 * step : most >= 2 * step ? 2 * step : step;
}

static void draw_scale(const struct svg *s, const char *unit)
{
    double length = scale_length(s), y = s->high + 2 * MARGIN + 0.4 * FOOTER;
    open_path(s, "s", false, 24);
    fprintf(s->out,
            "M%.0f %.0fv120h%.0fv-120\"/>\n"
            "<text fill=\"" INK "\" font-size=\"%.0f\" x=\"%.0f\" y=\"%.0f\">%g%s%s</text>\n",
            MARGIN, y - 120, length * s->scale, TEXT, 1.4 * MARGIN + length * s->scale, y, length,
            unit[0] != '\0' ? " " : "", unit);
}

const char *svg_colour_look(char look[8], uint32_t rgb)
{
    snprintf(look, 8, "#%06x", (unsigned)(rgb & 0xFFFFFF));
    return look;
}

/* The width of the bar; the height of the legend with its texts. */
static double bar_width(const struct svg_legend *legend)
{
    return (legend->ticks > 0 ? 2 : 1) * SVG_SHADES * SWATCH;
}

static double legend_height(const struct svg_legend *legend)
{
    return FOOTER + (legend->ticks > 0 ? 0.6 * FOOTER : 0);
}

/* Half of the longest text below the bar: the text may reach that far beyond an end. */
static double overhang(const struct svg_legend *legend)
{
    double most = 0;
    for (size_t i = 0; i < legend->ticks; i++)
        most = fmax(most, text_width(letters_of(legend->tick[i].text), TEXT) / 2);
    return most;
}

static void draw_text(const struct svg *s, double x, double y, const char *text)
{
    if (text[0] != '\0')
        fprintf(s->out,
                "<text fill=\"" INK "\" font-size=\"%.0f\" x=\"%.0f\" y=\"%.0f\">%s</text>\n", TEXT,
                x, y, text);
}

/* Texts below the bar that begins at x, y, each with a mark. */
static void draw_ticks(const struct svg *s, const struct svg_legend *legend, double x, double y)
{
    const double mark = 90;
    double free = -HUGE_VAL;
    for (size_t i = 0; i < legend->ticks; i++) {
        const struct svg_tick *tick = &legend->tick[i];
        double at = x + tick->at * bar_width(legend),
               wide = text_width(letters_of(tick->text), TEXT);
        if (at - wide / 2 < free)
            continue;
        free = at + wide / 2 + TEXT / 2;
        open_path(s, "s", false, 24);
        fprintf(s->out, "M%.0f %.0fv%.0f\"/>\n", at, y, mark);
        draw_text(s, at - wide / 2, y + mark + 0.9 * TEXT, tick->text);
    }
}

static void draw_legend(const struct svg *s, const struct svg_legend *legend)
{
    double y = s->height - legend_height(legend) + 0.5 * FOOTER, over = overhang(legend);
    double x = 1.3 * MARGIN + fmax(text_width(strlen(legend->low), TEXT), over - MARGIN);
    size_t n = legend->colour != NULL ? legend->colours : SVG_SHADES;
    double wide = bar_width(legend) / (double)n;
    draw_text(s, MARGIN, y, legend->low);
    for (size_t i = 0; i < n; i++) {
        char class[8] = {'q', (char)('0' + i % SVG_SHADES), 0};
        if (legend->colour != NULL)
            svg_colour_look(class, legend->colour[i]);
        open_path(s, class, !legend->seamless, 12);
        fprintf(s->out, "M%.0f %.0fH%.0fv-%.0fH%.0fz\"/>\n", x + (double)i * wide, y + 30,
                x + (double)(i + 1) * wide, SWATCH, x + (double)i * wide);
    }
    draw_text(s, x + bar_width(legend) + 0.3 * MARGIN, y, legend->high);
    draw_ticks(s, legend, x, y + 30);
}

static double legend_width(const struct svg_legend *legend)
{
    double over = overhang(legend);
    return fmax(text_width(strlen(legend->low), TEXT), over) + bar_width(legend) +
           fmax(text_width(strlen(legend->high), TEXT), over) + 1.6 * MARGIN;
}

/* The frame around what is drawn: wide enough for the scale, the longest id and the legend. */
static void choose_frame(struct svg *s, bool scale, const struct svg_legend *legend)
{
    double least = fmax(scale ? 0.3 * s->high / 3 + 8 * TEXT : 0, text_width(10, 400));
    if (legend != NULL)
        least = fmax(least, legend_width(legend));
    double inner = fmax(s->wide, least);
    s->width = inner + 2 * MARGIN;
    s->left = MARGIN + (inner - s->wide) / 2;
    s->height =
        s->high + 2 * MARGIN + (scale ? FOOTER : 0) + (legend != NULL ? legend_height(legend) : 0);
    s->width = ceil(s->width / PIXEL) * PIXEL; /* whole pixels */
    s->height = ceil(s->height / PIXEL) * PIXEL;
}

/* Everything that is drawn from here on is cut off at the edges of the box. */
static void begin_clip(const struct svg *s)
{
    fprintf(s->out,
            "<clipPath id=\"box\"><path d=\"M%.0f %.0fh%.0fv%.0fh-%.0fz\"/></clipPath>\n"
            "<g clip-path=\"url(#box)\">\n",
            s->left, MARGIN, s->wide, s->high, s->wide);
}

static void end_clip(const struct svg *s)
{
    fputs("</g>\n", s->out);
    open_path(s, "f", false, 16);
    fprintf(s->out, "M%.0f %.0fh%.0fv%.0fh-%.0fz\"/>\n", s->left, MARGIN, s->wide, s->high,
            s->wide);
}

void svg_begin(struct svg *s, FILE *out, const char *title, const double *box, size_t n, bool clip,
               const struct svg_legend *legend, const char *unit)
{
    double side = fmax(box[2] - box[0], box[3] - box[1]);
    double scale = side > 0 ? SIDE / side : 1;
    *s = (struct svg){.out = out, .x0 = box[0], .y1 = box[3], .scale = scale};
    s->wide = (box[2] - box[0]) * scale;
    s->high = (box[3] - box[1]) * scale;
    choose_frame(s, side > 0, legend);
    choose_widths(s, s->wide, s->high, n > 0 ? n : 1);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" "
            "height=\"%.0f\">\n"
            "<title>%s</title>\n"
            "<rect width=\"%.0f\" height=\"%.0f\" fill=\"#fff\"/>\n"
            "<g fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" "
            "font-family=\"sans-serif\">\n",
            s->width, s->height, s->width / PIXEL, s->height / PIXEL, title, s->width, s->height);
    if (side > 0)
        draw_scale(s, unit);
    if (legend != NULL)
        draw_legend(s, legend);
    s->clip = clip ? box : NULL;
    if (clip)
        begin_clip(s);
}

static long place_x(const struct svg *s, const double *p)
{
    return lround((p[0] - s->x0) * s->scale + s->left);
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
static void path_item(struct svg *s, const char *class, bool white_edges, double width)
{
    if (s->in_path == PATH_MAX_ITEMS || strcmp(s->class, class) != 0)
        path_end(s);
    snprintf(s->class, sizeof s->class, "%s", class);
    if (s->in_path++ > 0)
        return;
    open_path(s, class, white_edges, width);
}

/* ---- cutting off: Sutherland and Hodgman, Reentrant polygon clipping, CACM 17(1), 1974 ---- */

enum { MOST_CORNERS = 16 }; /* 7, plus room for rounding at nearly equal corners */

/* Keeps the part on one side of a vertical (axis 0) or horizontal line: v >= limit, or with sign -1 v <= limit. */
static size_t cut(double (*to)[2], double (*from)[2], size_t n, int axis, double limit, double sign)
{
    size_t kept = 0;
    for (size_t i = 0; i < n && kept + 2 <= MOST_CORNERS; i++) {
        const double *p = from[i], *q = from[(i + 1) % n];
        double dp = sign * (p[axis] - limit), dq = sign * (q[axis] - limit);
        if (dp >= 0) {
            to[kept][0] = p[0];
            to[kept++][1] = p[1];
        }
        if ((dp >= 0) != (dq >= 0)) {
            double t = dp / (dp - dq);
            to[kept][axis] = limit;
            to[kept][1 - axis] = p[1 - axis] + t * (q[1 - axis] - p[1 - axis]);
            kept++;
        }
    }
    return kept;
}

/* Cuts a polygon of n corners at a box that is somewhat larger than the one shown, so that the new edges are
 * not seen. Returns the number of corners left. */
static size_t cut_polygon(const struct svg *s, double (*polygon)[2], size_t n)
{
    double other[MOST_CORNERS][2],
        wide = 0.1 * fmax(s->clip[2] - s->clip[0], s->clip[3] - s->clip[1]);
    n = cut(other, polygon, n, 0, s->clip[0] - wide, 1);
    n = cut(polygon, other, n, 1, s->clip[1] - wide, 1);
    n = cut(other, polygon, n, 0, s->clip[2] + wide, -1);
    return cut(polygon, other, n, 1, s->clip[3] + wide, -1);
}

void svg_triangle(struct svg *s, const char *look, bool white_edges, const double *xy,
                  const uint32_t v[3])
{
    const double *a = xy + 2 * (size_t)v[0], *b = xy + 2 * (size_t)v[1], *c = xy + 2 * (size_t)v[2];
    double polygon[MOST_CORNERS][2] = {{a[0], a[1]}, {b[0], b[1]}, {c[0], c[1]}};
    size_t n = s->clip != NULL ? cut_polygon(s, polygon, 3) : 3;
    if (n == 0)
        return;
    path_item(s, look, white_edges, s->line);
    long x = place_x(s, polygon[0]), y = place_y(s, polygon[0]);
    fprintf(s->out, "M%ld %ld", x, y);
    for (size_t i = 1; i < n; i++) {
        long next_x = place_x(s, polygon[i]), next_y = place_y(s, polygon[i]);
        fprintf(s->out, "%s%ld %ld", i == 1 ? "l" : " ", next_x - x, next_y - y);
        x = next_x;
        y = next_y;
    }
    fputs("z", s->out);
    s->triangles++;
}

/* From the first place to the others, in whole units; those at the same place are left out. */
static void draw_places(struct svg *s, const double *xy, size_t n)
{
    long x = place_x(s, xy), y = place_y(s, xy);
    fprintf(s->out, "M%ld %ld", x, y);
    for (size_t i = 1, drawn = 0; i < n; i++) {
        long next_x = place_x(s, xy + 2 * i), next_y = place_y(s, xy + 2 * i);
        if (next_x == x && next_y == y)
            continue;
        fprintf(s->out, "%s%ld %ld", drawn++ == 0 ? "l" : " ", next_x - x, next_y - y);
        x = next_x;
        y = next_y;
    }
}

void svg_polygon(struct svg *s, uint32_t rgb, const double *xy, size_t n)
{
    char class[8] = "t";
    if (rgb != SVG_NO_COLOUR)
        svg_colour_look(class, rgb);
    path_item(s, class, true, s->line);
    draw_places(s, xy, n);
    fputs("z", s->out);
}

void svg_hole(struct svg *s, const double *xy, size_t n)
{
    draw_places(s, xy, n);
    fputs("z", s->out);
}

void svg_line(struct svg *s, bool heavy, const double *xy, size_t n, bool closed)
{
    path_item(s, heavy ? "l" : "k", false, heavy ? 30 : 14);
    draw_places(s, xy, n);
    if (closed)
        fputs("z", s->out);
}

void svg_drawn(const struct svg *s, const double *p, double *drawn)
{
    drawn[0] = (double)place_x(s, p);
    drawn[1] = (double)place_y(s, p);
}

void svg_frame(const struct svg *s, double *low, double *high)
{
    low[0] = s->left;
    low[1] = MARGIN;
    high[0] = s->left + s->wide;
    high[1] = MARGIN + s->high;
}

void svg_numbers_begin(struct svg *s, double size, double halo)
{
    path_end(s);
    fprintf(s->out, "<g font-size=\"%.0f\" text-anchor=\"middle\"", size);
    if (halo > 0)
        fprintf(s->out, " stroke=\"#fff\" stroke-opacity=\"0.8\" stroke-width=\"%.0f\">\n", halo);
    else
        fputs(" fill=\"#3c2410\">\n", s->out);
}

void svg_number(struct svg *s, double x, double y, double degrees, double size, const char *text)
{
    fprintf(s->out, "<text x=\"%.0f\" y=\"%.0f\" transform=\"rotate(%.1f %.0f %.0f)\">%s</text>\n",
            x, y + 0.36 * size, degrees, x, y, text);
}

void svg_numbers_end(struct svg *s)
{
    fputs("</g>\n", s->out);
}

/* A segment, only the part near the box. */
static void draw_segment(struct svg *s, const char *class, double width, const double *p,
                         const double *q)
{
    double line[MOST_CORNERS][2] = {{p[0], p[1]}, {q[0], q[1]}};
    if (s->clip != NULL && cut_polygon(s, line, 2) < 2)
        return;
    path_item(s, class, false, width);
    fprintf(s->out, "M%ld %ldL%ld %ld", place_x(s, line[0]), place_y(s, line[0]),
            place_x(s, line[1]), place_y(s, line[1]));
}

/* Borders are wider than lines. */
void svg_constraint(struct svg *s, bool border, const double *p, const double *q)
{
    draw_segment(s, border ? "b" : "c", clamp((border ? 5 : 4) * s->line, border ? 24 : 18, 80), p,
                 q);
}

/* A hull without a triangle runs along a line and is not closed. */
void svg_hull(struct svg *s, const double *xy, const uint32_t *place, size_t n)
{
    const double width = clamp(3 * s->line, 14, 60);
    path_end(s);
    for (size_t i = n > 2 ? 0 : 1; s->clip != NULL && i < n; i++)
        draw_segment(s, "h", width, xy + 2 * (size_t)place[i > 0 ? i - 1 : n - 1],
                     xy + 2 * (size_t)place[i]);
    if (s->clip == NULL && n > 0) {
        open_path(s, "h", false, width);
        for (size_t i = 0; i < n; i++) {
            const double *p = xy + 2 * (size_t)place[i];
            fprintf(s->out, "%s%ld %ld",
                    i == 0        ? "M"
                    : i % 12 == 0 ? "\n"
                                  : " ",
                    place_x(s, p), place_y(s, p));
        }
        fputs(s->triangles > 0 ? "z\"/>\n" : "\"/>\n", s->out);
    }
    path_end(s);
}

/* Draws an id beside its point, smaller where there is little room; false if there is none. */
static bool draw_label(struct svg *s, struct labels *l, const double *p, uint32_t id, double size)
{
    char text[16];
    size_t n = (size_t)snprintf(text, sizeof text, "%u", id);
    double x = (double)place_x(s, p), y = (double)place_y(s, p), away = 0.7 * s->dot;
    for (double smaller = size; smaller > size / 50; smaller *= 0.7) {
        struct label_box box;
        double high = 0.8 * smaller;
        if (!labels_place(l, x, y, away, text_width(n, smaller), high, &box))
            continue;
        fprintf(s->out, "<text x=\"%.1f\" y=\"%.1f\"", box.x0, box.y1);
        if (smaller < size)
            fprintf(s->out, " font-size=\"%.1f\"", smaller);
        fprintf(s->out, ">%s</text>\n", text);
        return true;
    }
    return false;
}

static void draw_labels(struct svg *s, const double *xy, const uint32_t *id, size_t n)
{
    double size = clamp(2.2 * s->dot, 150, 400);
    struct labels l;
    if (!labels_init(&l, s->width, s->height, 3 * size, n))
        return;
    fprintf(s->out, "<g fill=\"" INK "\" font-size=\"%.0f\">\n", size);
    for (size_t i = 0; i < n; i++)
        s->unlabelled += !draw_label(s, &l, xy + 2 * i, id[i], size);
    fputs("</g>\n", s->out);
    labels_free(&l);
}

void svg_points(struct svg *s, const double *xy, const uint32_t *id, size_t n)
{
    path_end(s);
    for (size_t i = 0; i < n; i++) {
        path_item(s, "p", false, s->dot); /* a line of no length with round caps is a dot */
        fprintf(s->out, "M%ld %ldh0", place_x(s, xy + 2 * i), place_y(s, xy + 2 * i));
    }
    path_end(s);
    if (s->clip != NULL)
        end_clip(s);
    if (n <= LABELS_MAX || s->numbers)
        draw_labels(s, xy, id, n);
}

void svg_end(struct svg *s)
{
    path_end(s);
    fputs("</g>\n</svg>\n", s->out);
}

void svg_place(const struct svg *s, double *x, double *y, double *pixel)
{
    *x = s->x0 - s->left / s->scale;
    *y = s->y1 + MARGIN / s->scale;
    *pixel = PIXEL / s->scale;
}
