/* view.h - readers of earlier moments of a set, and what edits save for them; for the files of core/ only.
 *
 * Three things are saved (core/images.h), each under its key:
 *
 *      rows       id -> its place, and of which group of aliases it is one
 *      families   group of aliases -> the group that it is part of, or its representative: so that a family
 *                 that gets another one is not many rows, whose images name the group
 *      rings      id of a representative -> whether it is on the hull, and its star in ids (core/star.h)
 *
 * What has no image is as it is now. Whether an id was a representative is a matter of its row; only then may
 * its ring be asked for.
 *
 * An edit learns from the views which moments are read (dt_views_edit_begin) and is called back for what it is
 * about to change (core/changes.h). */
#ifndef DT_VIEW_H
#define DT_VIEW_H

#include "core/changes.h"
#include "core/images.h"

/* What has ended is freed by an edit, or another view begins in it. One that is about to begin is not
 * yet to be looked at: its thread, which keeps edits out, fills it in. */
enum dt_view_state { DT_VIEW_ENDED, DT_VIEW_BEGINNING, DT_VIEW_OPEN };

struct dt_view {
    struct dt_view *next; /* in the list of its set */
    atomic_int state;     /* enum dt_view_state */
    bool with_rings;      /* it reads the triangulation */
    bool line;            /* all points are on one line, or there are fewer than three */
    uint32_t on_hull;     /* with rings: a point on the hull, DT_NONE if there is none */
    uint32_t next_id;
    uint64_t serial;                /* views are numbered as they begin */
    uint64_t rows, families, rings; /* the moment */
    struct dt_summary sum;
};

struct dt_views {
    _Atomic(struct dt_view *) list; /* owns; edits alone take out of it */
    atomic_uint_least64_t serial;   /* of the view that began last */
    uint64_t lost;       /* of the last view that cannot be read any more: out of memory */
    uint64_t rings_lost; /* of the last one whose triangulation cannot be read any more */
    struct dt_images rows, families, rings;
    bool saved;                /* there may be images */
    struct dt_changes changes; /* calls back here */
    /* For the edit under way: the latest moments that are read, and the ids that there were by then. */
    uint64_t rows_since, families_since, rings_since;
    uint32_t row_ids, ring_ids; /* 0: none is read */
};

/* All views have ended. */
void dt_views_clear(struct dt *t);
size_t dt_views_memory(const struct dt_views *w);

/* To be called at the beginning of every edit. */
void dt_views_edit_begin(struct dt *t);

/* The triangulation has changed, and the stars have not been saved. */
void dt_views_lose_rings(struct dt *t);

/* ---- reading; v may be NULL: now ---- */

/* DT_OK if the view can be read, with its triangulation if rings. */
enum dt_status dt_view_readable(const struct dt *t, const struct dt_view *v, bool rings);

/* v, or NULL if all that it reads is as it is now. */
const struct dt_view *dt_view_if_changed(const struct dt *t, const struct dt_view *v);

/* The row that the id had; false: there was no such id. */
bool dt_view_row(const struct dt *t, const struct dt_view *v, uint32_t id, struct dt_row *row);

/* The representative of the id; DT_NONE if there was no such id. */
uint32_t dt_view_representative(const struct dt *t, const struct dt_view *v, uint32_t id);

/* Walks the ids that there were, ascending. */
struct dt_view_ids {
    const struct dt *t;
    const struct dt_view *v; /* NULL: they are those of now, below `end` */
    uint32_t end;
    uint32_t saved; /* the next id of which there is an image */
};

/* From the id `from` on. */
struct dt_view_ids dt_view_ids_begin(const struct dt *t, const struct dt_view *v, uint32_t from);

/* The smallest id >= from, which does not decrease from call to call; DT_NONE if there is none. */
uint32_t dt_view_ids_next(struct dt_view_ids *w, uint32_t from);

/* As dt_idmap_after: about n ids from `from` on. */
uint32_t dt_view_ids_after(const struct dt *t, const struct dt_view *v, uint32_t from, uint32_t n);

/* ---- how rows and families are saved ---- */

enum {
    DT_ROW_WORDS = 5, /* of an image: group of aliases or DT_NONE, x, y */
    DT_FAMILY_WORDS =
        2 /* the group that it is part of, DT_NONE for a root; a root's representative */
};

void dt_view_save_row(const struct dt *t, uint32_t id, uint32_t *image);
void dt_view_save_family(const struct dt *t, uint32_t group, uint32_t *image);

#endif
