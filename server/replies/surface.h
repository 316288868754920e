/* surface.h - surfaces between points: values at places and at the cells of a raster, contours, profiles and volumes.
 *
 * Everything is of one state of the set. Values are rows that are made as they are sent (rows/surface_rows.h). Jobs trace contours
 * (contour.c), follow profiles (profile.c), add up volumes (volume.c), and mark the cells that CLIP keeps (raster_clip.c). */
#pragma once

#include "core/delaunay_surface.h"
#include "server/jobs/server.h"
#include "server/rows/rows.h"

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
    /* SURFACE_PLACES, SURFACE_PROFILE; SURFACE_RASTER: the cells that are kept */
    struct places places;
    struct dt_raster raster;
    /* SURFACE_CONTOUR; owns `levels`, ascending; NULL: every `step` from `base` on */
    double *level;
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

/* Answers SURFACE_PLACES, and SURFACE_RASTER without CLIP; what *q owns moves here. The version has the field. */
void surface_answer(struct server *s, struct answer *a, struct version *v, struct surface *q);

/* Answers a SURFACE_CONTOUR; what *q owns moves here. The source has the field. */
void contour_answer(struct server *s, struct answer *a, const struct surface_source *from,
                    struct surface *q);

/* The same for a SURFACE_PROFILE. A short way is followed at once, others by a worker, while edits of the set wait. The rows are in memory
 * before they are sent. */
void profile_answer(struct server *s, struct answer *a, const struct surface_source *from,
                    struct surface *q);

/* Frees what it owns. */
void surface_clear(struct surface *q);

/* ---- RASTER ... CLIP: only cells whose centres are inside a border of another set ----
 *
 * A worker marks them, a bit for each cell, before the reply begins. Edits of the other set wait meanwhile. The values are read
 * afterwards, as the raster's set was when the request came, so no worker reads both sets at a time. */

/* Whether the set `other` can clip: its regions are known, and one of its borders is closed. If not, the request waits, or the ERR
 * line has been written. */
bool raster_clip_ready(struct server *s, struct answer *a, struct dataset *other);

/* Answers with the raster of the version, clipped by q->clip; what *q owns moves here. */
void raster_clip_answer(struct server *s, struct answer *a, struct version *v, struct surface *q);

/* ---- VOLUME: between a surface and a level, or another surface ---- */

struct volume {
    const struct dt_field *field, *minus; /* of the set now; minus: NULL for the level */
    double level;
    struct inside inside;   /* regions_ready */
    bool skip;              /* MISSING skip */
    struct dt_point box[2]; /* its lower left and upper right corner; -HUGE_VAL: everywhere */
};

/* Answers with the volumes above and below, and the area of the surface: `OK 0 above= below= area=`. All of one state of
 * the set; a worker reads it in pieces of a few milliseconds. With INSIDE edits of the set wait until it has. */
void volume_answer(struct server *s, struct answer *a, const struct surface_source *from,
                   const struct volume *volume);
