/* view_rows.h - the rows that points had at the moment of a view, NULL for now: their places, and whose aliases they
 * were. */
#pragma once

#include "core/set/set.h"

/* DT_OK if the view can be read, with its triangulation if rings. */
enum dt_status dt_view_readable(const struct dt *t, const struct dt_view *v, bool rings);

/* DT_OK if the triangulation can be read, and has no constraints: DT_NOTDELAUNAY. */
enum dt_status dt_view_readable_delaunay(const struct dt *t, const struct dt_view *v);

/* v, or NULL if all that it reads is as it is now. */
const struct dt_view *dt_view_if_changed(const struct dt *t, const struct dt_view *v);

/* The row that the id had; false: there was no such id. */
bool dt_view_row(const struct dt *t, const struct dt_view *v, uint32_t id, struct dt_row *row);

/* The place of an id that there was. */
struct dt_point dt_view_place(const struct dt *t, const struct dt_view *v, uint32_t id);

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
    /* the group that it is part of, DT_NONE for a root; a root's representative */
    DT_FAMILY_WORDS = 2
};

void dt_view_save_row(const struct dt *t, uint32_t id, uint32_t *image);
void dt_view_save_family(const struct dt *t, uint32_t group, uint32_t *image);
