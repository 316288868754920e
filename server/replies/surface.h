/* surface.h - values between points: at places, at the cells of a raster, and contours.
 *
 * Everything is of one state of the set. Values are rows that are made as they are sent (sets/surface_rows.h). Contours
 * are traced by a job (contour.c). */
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
    const struct dt_field *fields
        [DT_MAX_FIELDS]; /* SURFACE_PLACES, SURFACE_RASTER: of the source; `n_fields`, the first of that name */
    size_t n_fields;
    enum dt_interpolation how;
    double max_edge;      /* HUGE_VAL: any */
    struct inside inside; /* regions_ready */
    bool beyond;          /* OUTSIDE nearest */
    bool skip;            /* MISSING skip */
    enum dt_quantity quantity;
    struct places
        places; /* SURFACE_PLACES, SURFACE_PROFILE; SURFACE_RASTER: the cells that are kept */
    struct dt_raster raster;
    double
        *level; /* SURFACE_CONTOUR; owns `levels`, ascending; NULL: every `step` from `base` on */
    uint32_t levels;
    double step, base;
    bool bands;               /* SURFACE_CONTOUR: polygons between neighbouring levels, not lines */
    const struct word *other; /* CLIP: the name of a set; NULL: none */
    struct dataset *clip;     /* borrows, for the request; SURFACE_RASTER: CLIP; NULL: none */
};

/* The moment of a surface. */
struct surface_moment {
    struct version *version; /* borrows */
    struct dt_view *view;    /* NULL: now */
};

/* Answers with values; what *q and *m own moves here. */
void surface_answer_values(struct server *s, struct answer *a, const struct surface_moment *m,
                           struct surface *q);

/* Answers, except SURFACE_CONTOUR, SURFACE_PROFILE (profile.h) and CLIP (clip.h); what *q owns moves here. The version has the
 * field. */
void surface_answer(struct server *s, struct answer *a, struct version *v, struct surface *q);

/* Answers a SURFACE_CONTOUR; what *q owns moves here. The source has the field (contour.c). */
void contour_answer(struct server *s, struct answer *a, const struct surface_source *from,
                    struct surface *q);

/* Frees what it owns. */
void surface_clear(struct surface *q);

#endif
