/* surface.h - values between points: at places, at the cells of a raster, and contours.
 *
 * Everything is of one state of the set. Values are rows that are made as they are sent (sets/surface_rows.h). Contours
 * are traced by a worker, which visits the set for a piece of a few milliseconds at a time and reads through a view;
 * the result is in memory before it is sent. */
#ifndef SERVER_SURFACE_H
#define SERVER_SURFACE_H

#include "core/delaunay_surface.h"
#include "server/jobs/server.h"
#include "server/sets/rows.h"

enum surface_kind { SURFACE_PLACES, SURFACE_RASTER, SURFACE_CONTOUR, SURFACE_PROFILE };

struct surface {
    enum surface_kind kind;
    bool binary;
    char field[DT_FIELD_NAME];
    size_t field_len;
    enum dt_interpolation how;
    double max_edge;      /* HUGE_VAL: any */
    struct inside inside; /* regions_ready */
    bool beyond;          /* OUTSIDE nearest */
    struct places places; /* SURFACE_PLACES, SURFACE_PROFILE */
    struct dt_raster raster;
    double
        *level; /* SURFACE_CONTOUR; owns `levels`, ascending; NULL: every `step` from `base` on */
    uint32_t levels;
    double step, base;
};

/* Answers, except SURFACE_PROFILE (profile.h); what *q owns moves here. The set has the field. */
void surface_answer(struct server *s, struct answer *a, struct dataset *set, struct surface *q);

/* Frees what it owns. */
void surface_clear(struct surface *q);

#endif
