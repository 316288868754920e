/* trace.h - the steps of the shelling algorithm, as TRACE tells them, and their film. */
#ifndef CLIENTS_TRACE_H
#define CLIENTS_TRACE_H

#include <stdio.h>

#include "clients/model.h"

/* The words that rows begin with; PROTOCOL.md says what each means. */
enum step_kind {
    STEP_GRID,
    STEP_START,
    STEP_SEARCH,
    STEP_FIRST,
    STEP_POINT,
    STEP_RIGHT,
    STEP_LEFT,
    STEP_CAVE,
    STEP_BORDER,
    STEP_REMOVE,
    STEP_HULL
};

struct step {
    enum step_kind kind;
    uint32_t v[3]; /* the places of its points in a model; STEP_GRID: columns and rows */
    double x, y;   /* STEP_GRID: lower left corner; STEP_SEARCH: the circle's centre */
    double size;   /* side of a cell; radius, HUGE_VAL for the half plane */
};

struct trace {
    const struct model *m; /* borrows: the points */
    struct step *step;     /* owns n, room for cap */
    size_t n, cap;
    const char *fault; /* why trace_take returned false: a static sentence */
};

/* Takes a row of TRACE's reply. */
bool trace_take(struct trace *t, const char *row, size_t len);
void trace_free(struct trace *t);

struct film_options {
    double seconds; /* 0: as long as it takes to follow */
    bool numbers;   /* ids beside the points */
};

/* Writes the trace as an SVG that plays by itself, over and over, without a script; where
 * animations are not played, it shows the triangulation. `title` holds no markup. False when out of
 * memory; ferror() tells the rest. */
bool film_write(FILE *out, const struct trace *t, const char *title,
                const struct film_options *options);

#endif
