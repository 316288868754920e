/* rows.h - the rows of a reply, from a table of a set, from a list of ids or from a list of places, written a piece at a time.
 *
 * A plain value with a position in the rows. Its memory does not grow with the reply, except for the ids
 * or places of a list and for a long row of a table while it is written. */
#pragma once

#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "proto/reply.h"
#include "server/rows/pace.h"
#include "server/rows/row_memory.h"
#include "server/rows/surface_rows.h"
#include "server/sets/dataset.h"

enum row_form {
    ROW_IDS,       /* `width` ids from the list */
    ROW_POINT,     /* id x y */
    ROW_NEIGHBOUR, /* id x y distance from `from` */
    ROW_RING,      /* id and its ring */
    ROW_CELL,      /* id, the number of corners, and x y of each, */
    ROW_AREA,      /* or the area: of all cells, or those of the list */
    ROW_SURFACE,   /* values of a surface */
    ROW_WORDS,     /* words of the list, as a format says (reply_row) */
    ROW_TRIANGLE,  /* binary, of a place: the corners of its triangle, */
    ROW_NEAREST    /* and the `width` points nearest to it */
};

/* An id and a value. */
#define ROW_VALUE "id"
enum { ROW_VALUE_WORDS = 3 };
void row_value_put(uint32_t word[ROW_VALUE_WORDS], uint32_t id, double value);

/* A line of a contour: its level, whether it is closed, and its places, which follow these words. */
#define ROW_LINE "dcD"
enum { ROW_LINE_WORDS = 4 };
void row_line_put(uint32_t word[ROW_LINE_WORDS], double level, bool closed, uint32_t places);

/* A ring of a band: both levels, the number, whether it is a hole, and its places, which follow these words. */
#define ROW_BAND "ddihD"
enum { ROW_BAND_WORDS = 7 };
void row_band_put(uint32_t word[ROW_BAND_WORDS], const struct dt_band_ring *ring);

/* A constraint: its ends and what it is. */
#define ROW_CONSTRAINT "iib"
enum { ROW_CONSTRAINT_WORDS = 3 };

/* A region: its number, whether it is closed, its triangles and its area. */
#define ROW_REGION "icid"
enum { ROW_REGION_WORDS = 5 };
void row_region_put(uint32_t word[ROW_REGION_WORDS], const struct dt_region *region);

/* Whether rows of this form are made from the list alone, without the set. */
static inline bool row_is_of_list(enum row_form form)
{
    return form == ROW_IDS || form == ROW_WORDS;
}

/* Places that are asked about. */
struct places {
    struct dt_point *p; /* owns, from dt_pages_grow; may be NULL if n is 0 */
    size_t n;
    uint8_t *kept; /* owns, the same; of a raster, bits of the cells that are kept; NULL: all */
    struct reservation memory; /* of both */
};

static inline bool row_is_of_place(enum row_form form)
{
    return form == ROW_TRIANGLE || form == ROW_NEAREST;
}

static inline bool row_is_of_cell(enum row_form form)
{
    return form == ROW_CELL || form == ROW_AREA;
}

/* Whether rows of this form are searched or computed, and not only read. */
static inline bool row_is_computed(enum row_form form)
{
    return form == ROW_SURFACE || row_is_of_place(form) || row_is_of_cell(form);
}

struct rows {
    struct version *version; /* borrows: the owner of the rows pins it */
    struct dt_view *view;    /* borrows: the moment that is read; NULL: now */
    bool heavy;              /* workers make them, even if they are few */
    bool table;              /* rows of the cursor's table, else rows of the ids */
    bool binary;             /* tables and numbers only */
    struct dt_cursor cursor;
    struct dt_cells cells;      /* ROW_CELL, ROW_AREA */
    struct dt_cells_made *made; /* owns, a part borrows: all of them, if the cursor reads from it */
    struct surface_rows surface; /* ROW_SURFACE; its set and moment are those of the rows */
    enum row_form form;
    const char *format; /* ROW_WORDS */
    size_t width;       /* words of the list or of the reply in a row; 1 if they differ */
    bool cw;            /* ROW_RING */
    /* DT_POINTS: borrows; fields whose values follow the coordinates, `fields` */
    const struct dt_field **field;
    size_t fields;
    struct dt_point from;         /* ROW_NEIGHBOUR */
    struct dt_ids ids;            /* the list; a part borrows it */
    const struct dt_point *place; /* the list of places; borrows */
    size_t places;
    struct pace pace;           /* of the next rows_fill */
    struct reservation *memory; /* borrows: covers out and long rows; NULL: nothing does */
    size_t at;                  /* ids or places of the list whose rows have been written */
    struct dt_ids ring;         /* owns: workspace */
    bool done;
    enum dt_status status; /* not DT_OK: the rows cannot be completed */
};

/* The number of all rows; of ROW_SURFACE, of values. */
size_t rows_count(const struct rows *r);

/* Appends rows until out holds `limit` bytes or more, r->done is set, r->status is not DT_OK, or the bound of r->pace is
 * reached, which may be before the first row. Then r->pace.slow says that the next row exceeds the bound by itself; the
 * next call makes that row. DT_CANCELLED: the flag of the pace was seen. Uses only *r, its version's set (const) and out, so
 * that a worker may call it as a visitor of the version. */
void rows_fill(struct rows *r, struct buf *out, size_t limit);

/* Splits off the next rows of *r as *part, about 30 KiB of text; *r continues behind them. A part may be
 * empty, and it may be large: the hull is one part, and rings can be long. Parts are filled independently
 * of each other; the ids of a list stay *r's. False: no rows are left. */
bool rows_cut(struct rows *r, struct rows *part);

/* The bytes that a piece of rows takes, its workspace included, where none is long: `usual` ones, or those of a surface. */
size_t rows_piece(const struct rows *r, size_t usual);

/* The bytes of the workspace. */
size_t rows_memory(const struct rows *r);

/* Frees the workspace. */
void rows_clear(struct rows *r);
