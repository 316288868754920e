/* animation.h - the schedule of the animation of a trace; animation.c makes it, animation_draw.c draws it.
 *
 * Items that change are numbered: first the points, then the edges in the order in which they come
 * up, then the triangles, then the kinds of steps in the legend. */
#pragma once

#include <stdio.h>

#include "clients/pictures/steps.h"

struct animation_options {
    double seconds; /* 0: as long as it takes to follow */
    bool numbers;   /* ids beside the points */
};

/* Writes the trace as an SVG that plays in a loop, without a script; where animations are not played, it shows
 * the triangulation. `title` contains no markup. False when out of memory; ferror() reports failed writes. */
bool animation_write(FILE *out, const struct steps *t, const char *title,
                     const struct animation_options *options);

/* ---- for animation.c and animation_draw.c ---- */

enum ink {
    INK_NONE,
    INK_GRID, /* a point in the grid */
    INK_LEAVES,
    INK_GONE,
    INK_FRONT,
    INK_WAITS, /* an edge before a cave */
    INK_INSIDE,
    INK_BORDER,
    INK_HULL,
    INK_POINT,
    INK_RIGHT,
    INK_LEFT,
    INK_TRIANGLE,
    INK_DIM,
    INK_LIT
};

struct change {
    uint32_t item;
    enum ink ink;
    double at; /* beats */
};

struct animation {
    FILE *out;
    const struct steps *t;
    const struct model *m;
    double *start, *end;   /* own; of each step, in beats */
    double beats, seconds; /* of the whole */
    struct change *change; /* owns; later sorted by item and time */
    size_t changes;
    uint32_t *edge; /* owns 2 * edges places, a < b */
    size_t edges;
    uint32_t *triangle; /* owns: the steps that made them */
    size_t triangles;
    double x0, y1, scale, width, height; /* left, upper edge; units per unit */
};

/* The items of edge e, of a triangle, of a kind of step. */
static inline size_t animation_edge(const struct animation *f, size_t e)
{
    return f->m->n + e;
}

/* The other items have numbers beyond those of all edges that a planar graph can have. */
static inline size_t animation_triangle(const struct animation *f, size_t triangle)
{
    return 4 * f->m->n + triangle;
}

static inline size_t animation_legend(const struct animation *f, enum step_kind kind)
{
    return 6 * f->m->n + kind;
}

/* The changes of an item, *n of them, by time. Cost: O(log changes). */
const struct change *animation_changes(const struct animation *f, size_t item, size_t *n);

/* Draws the animation as planned. */
void animation_draw(struct animation *f, const char *title, bool numbers);
