/* rows.h - the rows of a reply, from a table of a set or from a list of ids, made a piece at a time.
 *
 * A plain value that keeps its place in the rows; what it holds does not grow with the reply, but for
 * the ids of a list and, while it is written, one row of a table that is longer than usual. */
#ifndef SERVER_ROWS_H
#define SERVER_ROWS_H

#include "proto/reply.h"
#include "server/sets/dataset.h"

enum row_form {
    ROW_IDS,       /* `width` ids from the list */
    ROW_POINT,     /* id x y */
    ROW_NEIGHBOUR, /* id x y distance from `from` */
    ROW_RING       /* id and its ring */
};

struct rows {
    struct version *version; /* borrows: whoever has the rows pins it */
    struct dt_view *view;    /* borrows: the moment whose rows they are; NULL: now */
    bool heavy;              /* workers make them, however few they are */
    bool table;              /* rows of cursor's table, else rows made from ids */
    bool binary;             /* table only */
    struct dt_cursor cursor;
    enum row_form form;
    size_t width;         /* ROW_IDS: ids in a row */
    bool cw;              /* ROW_RING */
    struct dt_point from; /* ROW_NEIGHBOUR */
    struct dt_ids ids;    /* of a list; borrowed by a part */
    size_t at;            /* how many of them have been written */
    struct dt_ids ring;   /* owns: workspace */
    bool done;
    enum dt_status status; /* not DT_OK: the rows cannot be continued */
};

/* How many rows there are in all. */
size_t rows_count(const struct rows *r);

/* Appends rows until out holds `limit` bytes or more, or r->done, or r->status is not DT_OK.
 * Touches nothing but *r, its version's set (const) and out, so that a worker may do it, under the
 * version's lock. */
void rows_fill(struct rows *r, struct buf *out, size_t limit);

/* Cuts off a part, of about 30 KiB, but maybe empty, maybe (along the hull, or at points with many
 * neighbours) as long as all. *r goes on behind it. *part, whose workspace is its own, is filled on its own, while *r keeps the
 * ids of its list. False: nothing is left. */
bool rows_cut(struct rows *r, struct rows *part);

/* Frees the workspace. */
void rows_clear(struct rows *r);

#endif
