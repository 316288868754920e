/* steps.h - the steps of the shelling algorithm, as the rows of TRACE report them. */
#pragma once

#include "clients/meshes/model.h"

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

struct steps {
    const struct model *m; /* borrows: the points */
    struct step *step;     /* owns n, room for cap */
    size_t n, cap;
    const char *fault; /* why steps_take returned false: a static sentence */
};

/* Takes a row of TRACE's reply. */
bool steps_take(struct steps *t, const char *row, size_t len);
void steps_free(struct steps *t);
