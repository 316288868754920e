/* past.h - the rows of a set as they were at one moment, read bit by bit while the set is edited.
 *
 * A row is an id, its place and its representative. Nothing is copied at the beginning. Whoever is
 * about to change the row of a live id puts it aside first (dt_past_keep), unless it has been read
 * already or came later; the reader takes what was put aside from there, all else from the set:
 *
 *     ids   0 ........ at ............................ end .......... next_id
 *           read       unread: kept, or as they were   came later
 *
 * A family of aliases that gets another representative would be many rows; for it the family is
 * noted once (dt_past_rename), and whoever joins or leaves one has a row of its own to keep. */
#ifndef DT_PAST_H
#define DT_PAST_H

#include "core/idmap.h"

struct dt_points;

struct dt_past {
    uint32_t at, end; /* equal: nothing is read, nothing is kept */
    bool failed;      /* a row could not be kept: out of memory */
    uint32_t n, cap;
    struct dt_row *row;       /* owns cap: what was put aside */
    struct dt_idmap kept;     /* id -> its place in row */
    struct dt_idmap families; /* group of aliases -> its representative at that moment */
};

/* The functions of core/delaunay.h. */
uint32_t dt_points_past_begin(struct dt_points *p);
enum dt_status dt_points_past_read(struct dt_points *p, struct dt_row *row, size_t room, size_t *n);
void dt_points_past_end(struct dt_points *p);
size_t dt_past_memory(const struct dt_past *past);

/* The row of the live id is about to change. Cost: constant. */
void dt_past_keep(struct dt_points *p, uint32_t id);

/* The aliases of the representative, if it has any, are about to get another one. */
void dt_past_rename(struct dt_points *p, uint32_t representative);

#endif
