/* animation_draw.c - an SVG that plays the shelling algorithm. See animation.h.
 *
 * Every element has one animation as long as the whole of it, which steps through a few values at the moments when
 * the element changes. No animation depends on the end of another one, so a
 * viewer may begin anywhere. Without animation an element has its last value. */
#include "clients/pictures/animation.h"

#include "clients/meshes/bounds.h"
#include "clients/pictures/labels.h"

#include <math.h>

#define SIDE 1000.0 /* of the drawing, in its units */
#define MARGIN 40.0
#define LEGEND 90.0
#define LETTER 20.0 /* height of letters */

#define SEARCH                                                                                     \
    "visibility=\"hidden\" fill=\"#e8871e\" fill-opacity=\".13\" stroke=\"#e8871e\" "              \
    "stroke-width=\"2\" "                                                                          \
    "stroke-dasharray=\"6 6\""
#define LETTERS "font-family=\"sans-serif\" font-size=\"20\" fill=\"#17324f\""

static const char *const value[] = {
    [INK_NONE] = "transparent", [INK_GRID] = "#17324f",   [INK_LEAVES] = "#d1495b",
    [INK_GONE] = "#b5c7d9",     [INK_FRONT] = "#e8871e",  [INK_WAITS] = "#a05cb8",
    [INK_INSIDE] = "#9db7d5",   [INK_BORDER] = "#7a5c58", [INK_HULL] = "#d1495b",
    [INK_POINT] = "#bfe3b4",    [INK_RIGHT] = "#f7d774",  [INK_LEFT] = "#8fd6e0",
    [INK_TRIANGLE] = "#e9f1fa", [INK_DIM] = ".35",        [INK_LIT] = "1",
};

/* ---- animations ---- */

/* A moment as a part of the whole, without the 0 before the point. */
static void put_moment(const struct animation *f, double at)
{
    char text[16];
    int n = snprintf(text, sizeof text, "%.5f", at / f->beats);
    while (n > 2 && text[n - 1] == '0')
        text[--n] = '\0';
    fprintf(f->out, ";%s", text[0] == '0' && n > 2 ? text + 1 : text);
}

static void end_animation(const struct animation *f)
{
    fprintf(f->out, "\" calcMode=\"discrete\" dur=\"%.4gs\" repeatCount=\"indefinite\"/>",
            f->seconds);
}

/* Animates the attribute of the element that is open: `first`, then the item's changes. */
static void animate(const struct animation *f, const char *attribute, enum ink first, size_t item)
{
    size_t n;
    const struct change *c = animation_changes(f, item, &n);
    fprintf(f->out, "<animate attributeName=\"%s\" values=\"%s", attribute, value[first]);
    for (size_t i = 0; i < n; i++)
        if (i + 1 == n || c[i + 1].at > c[i].at)
            fprintf(f->out, ";%s", value[c[i].ink]);
    fputs("\" keyTimes=\"0", f->out);
    for (size_t i = 0; i < n; i++)
        if (i + 1 == n || c[i + 1].at > c[i].at)
            put_moment(f, c[i].at);
    end_animation(f);
}

static enum ink last_ink(const struct animation *f, size_t item, enum ink first)
{
    size_t n;
    const struct change *c = animation_changes(f, item, &n);
    return n > 0 ? c[n - 1].ink : first;
}

/* Shows the element that is open, which is hidden, from one moment to another. */
static void show(const struct animation *f, double from, double to)
{
    fputs("<animate attributeName=\"visibility\" values=\"hidden;visible;hidden\" keyTimes=\"0",
          f->out);
    put_moment(f, from);
    put_moment(f, to);
    end_animation(f);
}

/* ---- places ---- */

static double place_x(const struct animation *f, double x)
{
    return (x - f->x0) * f->scale;
}

static double place_y(const struct animation *f, double y)
{
    return (f->y1 - y) * f->scale;
}

static long point_x(const struct animation *f, uint32_t p)
{
    return lround(place_x(f, f->m->xy[2 * (size_t)p]));
}

static long point_y(const struct animation *f, uint32_t p)
{
    return lround(place_y(f, f->m->xy[2 * (size_t)p + 1]));
}

/* The box of the points and of the grid fits into the drawing. */
static void fit(struct animation *f)
{
    double box[4] = {0};
    bounds_of(f->m->xy, f->m->n, box);
    double x0 = box[0], y0 = box[1], x1 = box[2], y1 = box[3];
    if (f->t->n > 0 && f->t->step[0].kind == STEP_GRID) {
        const struct step *g = &f->t->step[0];
        x1 = fmax(x1, g->x + g->size * g->v[0]);
        y1 = fmax(y1, g->y + g->size * g->v[1]);
    }
    double side = fmax(x1 - x0, y1 - y0);
    f->scale = side > 0 ? SIDE / side : 1;
    f->width = fmax((x1 - x0) * f->scale, 400);
    f->height = fmax((y1 - y0) * f->scale, 100);
    f->x0 = x0 - (f->width / f->scale - (x1 - x0)) / 2;
    f->y1 = y1 + (f->height / f->scale - (y1 - y0)) / 2;
}

/* ---- drawing ---- */

static void draw_grids(const struct animation *f)
{
    for (size_t i = 0; i < f->t->n && f->t->step[i].kind == STEP_GRID; i++) {
        const struct step *g = &f->t->step[i];
        double x = place_x(f, g->x), y = place_y(f, g->y), side = g->size * f->scale;
        double wide = side * g->v[0], high = side * g->v[1];
        if (side < 2 || g->v[0] > SIDE || g->v[1] > SIDE)
            continue; /* one could not see it */
        fputs("<path class=\"g\" stroke=\"#dde3ea\" stroke-width=\"1.5\" d=\"", f->out);
        for (uint32_t k = 0; k <= g->v[0]; k++)
            fprintf(f->out, "M%.1f %.1fv%.1f", x + k * side, y, -high);
        for (uint32_t k = 0; k <= g->v[1]; k++)
            fprintf(f->out, "M%.1f %.1fh%.1f", x, y - k * side, wide);
        fputs("\"/>\n", f->out);
    }
}

static void draw_triangles(const struct animation *f)
{
    for (size_t i = 0; i < f->triangles; i++) {
        const uint32_t *v = f->t->step[f->triangle[i]].v;
        fprintf(f->out, "<path fill=\"%s\" d=\"M%ld %ldL%ld %ld %ld %ldz\">", value[INK_TRIANGLE],
                point_x(f, v[0]), point_y(f, v[0]), point_x(f, v[1]), point_y(f, v[1]),
                point_x(f, v[2]), point_y(f, v[2]));
        animate(f, "fill", INK_NONE, animation_triangle(f, i));
        fputs("</path>\n", f->out);
    }
}

static void draw_edges(const struct animation *f)
{
    for (size_t e = 0; e < f->edges; e++) {
        uint32_t a = f->edge[2 * e], b = f->edge[2 * e + 1];
        size_t item = animation_edge(f, e);
        fprintf(f->out, "<path stroke=\"%s\" d=\"M%ld %ldL%ld %ld\">",
                value[last_ink(f, item, INK_NONE)], point_x(f, a), point_y(f, a), point_x(f, b),
                point_y(f, b));
        animate(f, "stroke", INK_NONE, item);
        fputs("</path>\n", f->out);
    }
}

/* Draws the ids beside their points, smaller where there is little room, and none over another. */
static void draw_numbers(const struct animation *f)
{
    struct labels l;
    struct label_box box;
    char text[16];
    if (!labels_init(&l, f->width + 2 * MARGIN, f->height + 2 * MARGIN, 3 * LETTER, f->m->n))
        return;
    for (uint32_t i = 0; i < f->m->n; i++) {
        int n = snprintf(text, sizeof text, "%u", f->m->id[i]);
        double x = (double)point_x(f, i) + MARGIN, y = (double)point_y(f, i) + MARGIN,
               size = LETTER;
        while (size > LETTER / 20 && !labels_place(&l, x, y, 12, 0.6 * size * n, 0.8 * size, &box))
            size *= 0.7;
        if (size > LETTER / 20)
            fprintf(
                f->out,
                "<text font-family=\"sans-serif\" font-size=\"%.3g\" fill=\"#17324f\" x=\"%.1f\" "
                "y=\"%.1f\">%s</text>\n",
                size, box.x0 - MARGIN, box.y1 - MARGIN, text);
    }
    labels_free(&l);
}

static void draw_points(const struct animation *f, bool numbers)
{
    for (uint32_t i = 0; i < f->m->n; i++) {
        size_t n;
        animation_changes(f, i, &n);
        fprintf(f->out, "<circle cx=\"%ld\" cy=\"%ld\" r=\"%d\" fill=\"%s\"", point_x(f, i),
                point_y(f, i), f->m->n <= 200 ? 8 : 4, value[last_ink(f, i, INK_GRID)]);
        fputs(n > 0 ? ">" : "/>\n", f->out);
        if (n > 0) {
            animate(f, "fill", INK_GRID, i);
            fputs("</circle>\n", f->out);
        }
    }
    if (numbers)
        draw_numbers(f);
}

/* The part of the circle on the left of a->b: the chord, then the arc back, counterclockwise; a very large one
 * counts as a half plane or as nothing. */
static void draw_search(const struct animation *f, const struct step *s)
{
    double ax = place_x(f, f->m->xy[2 * (size_t)s->v[0]]),
           ay = place_y(f, f->m->xy[2 * (size_t)s->v[0] + 1]),
           bx = place_x(f, f->m->xy[2 * (size_t)s->v[1]]),
           by = place_y(f, f->m->xy[2 * (size_t)s->v[1] + 1]);
    double dx = bx - ax, dy = by - ay, length = hypot(dx, dy), r = s->size * f->scale;
    bool large =
        !(s->size < HUGE_VAL) ||
        dx * (place_y(f, s->y) - ay) - dy * (place_x(f, s->x) - ax) < 0; /* y points down */
    if (length == 0)
        return;
    if (r < 50 * SIDE) {
        fprintf(f->out,
                "<path class=\"s\" " SEARCH
                " d=\"M%.1f %.1fL%.1f %.1fA%.1f %.1f 0 %d 0 %.1f %.1fz\">",
                ax, ay, bx, by, r, r, large, ax, ay);
    } else {
        double far = large ? 3 * SIDE / length : 0;
        fprintf(f->out,
                "<path class=\"s\" " SEARCH " d=\"M%.0f %.0fL%.0f %.0fl%.0f %.0fL%.0f %.0fz\">",
                ax - far * dx, ay - far * dy, bx + far * dx, by + far * dy, far * dy, -far * dx,
                ax - far * dx + far * dy, ay - far * dy - far * dx);
    }
}

static bool same_search(const struct step *a, const struct step *b)
{
    return a->kind == b->kind && a->v[0] == b->v[0] && a->v[1] == b->v[1] && a->x == b->x &&
           a->y == b->y && !(a->size < b->size || a->size > b->size);
}

static void draw_searches(const struct animation *f)
{
    for (size_t i = 0; i < f->t->n; i++) {
        const struct step *s = &f->t->step[i];
        size_t first = i;
        if (s->kind != STEP_SEARCH)
            continue;
        while (i + 1 < f->t->n && same_search(s, s + (i + 1 - first)))
            i++;
        draw_search(f, s);
        show(f, f->start[first], f->end[i]);
        fputs("</path>\n", f->out);
    }
}

/* The current edge, for as long as it is current; and the triangle that would enclose a cave. */
static void draw_looks(const struct animation *f)
{
    for (size_t i = 0, first; i < f->t->n; i++) {
        const struct step *s = &f->t->step[i];
        first = i;
        if (s->kind < STEP_SEARCH || s->kind > STEP_BORDER)
            continue;
        while (f->t->step[i].kind == STEP_SEARCH && i + 1 < f->t->n &&
               s->v[0] == f->t->step[i + 1].v[0] && s->v[1] == f->t->step[i + 1].v[1])
            i++;
        const uint32_t *v = s->v, *c = f->t->step[i].v;
        fprintf(f->out,
                "<path class=\"e\" visibility=\"hidden\" stroke=\"#17324f\" stroke-width=\"6\" "
                "marker-end=\"url(#arrow)\" d=\"M%ld %ldL%ld %ld\">",
                point_x(f, v[0]), point_y(f, v[0]), point_x(f, v[1]), point_y(f, v[1]));
        show(f, f->start[first], f->end[i]);
        fputs("</path>\n", f->out);
        if (f->t->step[i].kind != STEP_CAVE)
            continue;
        fprintf(f->out,
                "<path class=\"c\" visibility=\"hidden\" stroke=\"#a05cb8\" stroke-dasharray=\"10 "
                "8\" d=\"M%ld %ldL%ld %ld %ld %ldz\">",
                point_x(f, c[0]), point_y(f, c[0]), point_x(f, c[1]), point_y(f, c[1]),
                point_x(f, c[2]), point_y(f, c[2]));
        show(f, f->start[i], f->end[i]);
        fputs("</path>\n", f->out);
    }
}

static void draw_legend(const struct animation *f)
{
    static const struct {
        enum step_kind kind;
        enum ink ink;
        const char *text;
    } line[] = {{STEP_SEARCH, INK_FRONT, "search"},     {STEP_POINT, INK_POINT, "new point"},
                {STEP_RIGHT, INK_RIGHT, "right touch"}, {STEP_LEFT, INK_LEFT, "left touch"},
                {STEP_CAVE, INK_WAITS, "cave"},         {STEP_BORDER, INK_BORDER, "no point"},
                {STEP_HULL, INK_HULL, "hull"}};
    double step = f->width / 7;
    for (unsigned i = 0; i < sizeof line / sizeof line[0]; i++) {
        size_t n;
        animation_changes(f, animation_legend(f, line[i].kind), &n);
        fprintf(f->out,
                "<g><rect x=\"%.0f\" y=\"%.0f\" width=\"18\" height=\"18\" fill=\"%s\"/>"
                "<text " LETTERS " x=\"%.0f\" y=\"%.0f\">%s</text>",
                MARGIN + i * step, f->height + 2 * MARGIN, value[line[i].ink],
                MARGIN + i * step + 24, f->height + 2 * MARGIN + 16, line[i].text);
        if (n > 0)
            animate(f, "opacity", INK_DIM, animation_legend(f, line[i].kind));
        fputs("</g>\n", f->out);
    }
    fprintf(f->out,
            "<rect x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"6\" fill=\"#9db7d5\">"
            "<animate attributeName=\"width\" from=\"0\" to=\"%.0f\" dur=\"%.4gs\" "
            "repeatCount=\"indefinite\"/></rect>\n",
            MARGIN, f->height + 2 * MARGIN + 40, f->width, f->width, f->seconds);
}

static const char arrow[] =
    "<marker id=\"arrow\" viewBox=\"0 0 10 10\" refX=\"9\" refY=\"5\" markerWidth=\"4\" "
    "markerHeight=\"4\" orient=\"auto\"><path d=\"M0 0L10 5 0 10z\" fill=\"#17324f\" "
    "stroke=\"none\"/></marker>\n";

void animation_draw(struct animation *f, const char *title, bool numbers)
{
    fit(f);
    double wide = f->width + 2 * MARGIN, high = f->height + 2 * MARGIN + LEGEND;
    fprintf(
        f->out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" "
        "height=\"%.0f\">\n<title>%s</title>\n%s"
        "<rect width=\"%.0f\" height=\"%.0f\" fill=\"#fff\"/>\n"
        "<clipPath id=\"view\"><rect x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" "
        "height=\"%.0f\"/></clipPath>\n"
        "<g fill=\"none\" stroke-width=\"4\" stroke-linecap=\"round\" stroke-linejoin=\"round\" "
        "clip-path=\"url(#view)\" transform=\"translate(%.0f %.0f)\">\n",
        wide, high, wide * 0.7, high * 0.7, title, arrow, wide, high, -MARGIN, -MARGIN, wide,
        f->height + 2 * MARGIN, MARGIN, MARGIN);
    draw_triangles(f);
    draw_grids(f);
    draw_searches(f);
    draw_edges(f);
    draw_looks(f);
    draw_points(f, numbers);
    fputs("</g>\n", f->out);
    draw_legend(f);
    fputs("</svg>\n", f->out);
}
