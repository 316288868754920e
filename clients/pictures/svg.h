/* svg.h - draws a triangulation: triangles, hull, points, and ids while there are few; below it a scale and, if
 * wanted, what the colours mean. Nothing lies outside of the frame.
 *
 * Call in this order: svg_begin, svg_triangle for each triangle, svg_hull, svg_constraint for each constraint, svg_points, svg_end.
 * Polygons and lines may be among them before svg_points. Everything is written directly to the file; ferror() reports failed writes. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct svg {
    FILE *out;            /* borrows until svg_end */
    double x0, y1, scale; /* left edge, upper edge, and drawing units per unit */
    double left;          /* where the left edge is drawn */
    double width, height; /* of the frame, in drawing units */
    double wide, high;    /* of what is drawn within its margin */
    const double *clip;   /* borrows the box that is shown; NULL: all of the plane */
    double line, dot;     /* width of a line and diameter of a point, in drawing units */
    size_t in_path, triangles;
    char class[8];     /* of the path that is open, or its colour #rrggbb */
    bool numbers;      /* ids are always drawn */
    size_t unlabelled; /* points for whose ids there was no room */
};

enum { SVG_SHADES = 10 };

/* A number below the bar of a legend; at: 0 at its left end, 1 at its right end. */
struct svg_tick {
    double at;
    char text[32];
};

/* A bar of colours with texts beside and below it. Ticks are ascending; a tick whose text has no room is left out. */
struct svg_legend {
    const char *low, *high; /* may be "" */
    const uint32_t *colour; /* borrows `colours` of 0xRRGGBB; NULL: the shades */
    size_t colours;
    bool seamless;               /* there are no gaps between colours */
    const struct svg_tick *tick; /* borrows `ticks` */
    size_t ticks;
};

/* Starts the drawing, with a plain-text title (no markup), of box = {left, lower, right, upper}, in
 * which about n points lie. The box is borrowed until svg_end. With clip, the drawing is larger than the box, and is
 * cut off at its edges. legend: NULL if there are no shades. unit: of the scale, "" if unknown. */
void svg_begin(struct svg *s, FILE *out, const char *title, const double *box, size_t n, bool clip,
               const struct svg_legend *legend, const char *unit);

/* A triangle of the places v in xy. `look`: "t", a plain one; "o", outside of borders; "r0" to "r7", in regions; "q0" (dark) to "q9", in
 * shades; or a colour "#rrggbb". Only with white_edges does a triangle of a colour have edges of its own. */
void svg_triangle(struct svg *s, const char *look, bool white_edges, const double *xy,
                  const uint32_t v[3]);

/* Writes the look of a colour 0xRRGGBB, and returns it. */
const char *svg_colour_look(char look[8], uint32_t rgb);

/* A polygon of n corners within the frame, in that colour and with white edges; with SVG_NO_COLOUR as triangles are. */
enum { SVG_NO_COLOUR = 1 << 24 };
void svg_polygon(struct svg *s, uint32_t rgb, const double *xy, size_t n);

/* A hole in the polygon that was drawn last; its corners run in the other direction. */
void svg_hole(struct svg *s, const double *xy, size_t n);

/* A line through n places, which is cut off at the frame if there is a clip; back to its start if it is closed. */
void svg_line(struct svg *s, bool heavy, const double *xy, size_t n, bool closed);

/* The hull through n places in xy, in their order. */
void svg_hull(struct svg *s, const double *xy, const uint32_t *place, size_t n);

/* A constraint, bold; only the part near the box if there is a clip. Begins where the hull has ended. */
void svg_constraint(struct svg *s, bool border, const double *p, const double *q);

/* A place as it is drawn, and the corners of what is shown: upper left, lower right. */
void svg_drawn(const struct svg *s, const double *p, double *drawn);
void svg_frame(const struct svg *s, double *low, double *high);

/* Numbers of lines: svg_number for each, with its middle at a drawn place, turned clockwise by degrees; their height is `size`. With halo
 * above 0, only the white lines of that width around them. Polygons and lines end where they begin. */
void svg_numbers_begin(struct svg *s, double size, double halo);
void svg_number(struct svg *s, double x, double y, double degrees, double size, const char *text);
void svg_numbers_end(struct svg *s);

/* The points, each a dot, and their ids beside them if there are at most 100 or
 * s->numbers is set; no id covers another, and s->unlabelled counts those without room. */
void svg_points(struct svg *s, const double *xy, const uint32_t *id, size_t n);

void svg_end(struct svg *s);

/* The place of the upper left corner of the drawing, and the side of a pixel, if a pixel is 10 drawing units, as in PNG pictures. */
void svg_place(const struct svg *s, double *x, double *y, double *pixel);
