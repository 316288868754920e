/* pass.h - a pass over all triangles of a moment, a piece at a time, for results that do not depend on their order. They are
 * read as they lie in memory. If an edit changes the mesh, they are read again, from the table of the view. */
#pragma once

#include "core/mesh/fixed.h"
#include "core/set/set.h"

enum {
    DT_PASS_ROWS = 2048,   /* of the table, in a piece */
    DT_PASS_RECORDS = 8192 /* triangles as they lie in memory, in a piece */
};

struct dt_pass {
    const struct dt_view *view;    /* borrows; NULL: now */
    bool inside;                   /* only triangles inside borders count */
    struct dt_enclosure enclosure; /* then: of these */
    bool tabled;                   /* the table is read */
    uint32_t record, end;          /* of the mesh: the next one, and the end of the piece */
    struct dt_cursor cursor;
    uint32_t row[3 * DT_PASS_ROWS]; /* of the table: up to `words`, and `at` is next */
    size_t at, words;
};

/* *p is zeroed. Errors of dt_view_readable. */
enum dt_status dt_pass_begin(struct dt_pass *p, const struct dt *t, const struct dt_view *v);

/* Only triangles inside the border of the number count, or inside any border if it is DT_NONE. DT_UNSURVEYED: the set has been edited.
 * Errors of dt_region_check. */
enum dt_status dt_pass_inside(struct dt_pass *p, const struct dt *t, uint32_t number);

/* DT_OK if the next piece can be read. DT_UNSURVEYED: the set has been edited, and only triangles inside borders count. */
enum dt_status dt_pass_check(const struct dt_pass *p, const struct dt *t);

/* Whether the mesh is not that of the moment any more, for the first time: from now on the table is read, from its beginning. */
bool dt_pass_is_late(struct dt_pass *p, const struct dt *t);

/* Whether a triangle of the mesh counts, which is no ghost. */
static inline bool dt_pass_counts(const struct dt_pass *p, const struct dt_mesh *m, uint32_t h)
{
    return !p->inside || dt_encloses(&p->enclosure, dt_face(m, h));
}

/* Begins a piece of the mesh. */
static inline void dt_pass_piece(struct dt_pass *p, const struct dt_mesh *m)
{
    p->end = m->tri_end - p->record < DT_PASS_RECORDS ? m->tri_end : p->record + DT_PASS_RECORDS;
}

/* The first half edge of the next triangle of the piece that counts; false: there is none. */
static inline bool dt_pass_next(struct dt_pass *p, const struct dt_mesh *m, uint32_t *h)
{
    while (p->record < p->end) {
        *h = 8 * p->record++;
        if (m->half[*h + 2] < DT_DEAD && dt_pass_counts(p, m, *h)) /* no ghost either */
            return true;
    }
    return false;
}

/* Reads rows of the table, unless some are left. *done: there are none any more. Errors of dt_table_read. */
enum dt_status dt_pass_read(struct dt_pass *p, const struct dt *t, bool *done);

/* The next row that has been read: ids, the smallest first; NULL: there is none. */
static inline const uint32_t *dt_pass_row(struct dt_pass *p)
{
    p->at += 3;
    return p->at <= p->words ? &p->row[p->at - 3] : NULL;
}
