/* edit.h - the jobs that change the points of a set, and their values: add, delete, move, set. */
#ifndef SERVER_EDIT_H
#define SERVER_EDIT_H

#include "server/disk/log.h"
#include "server/jobs/job.h"

/* Whether n points with values of this number of fields may be added to the set, NULL for a new one; if they are many,
 * `memory` is reserved for them. False: the ERR line has been written, or the request waits. */
bool edit_may_add(struct server *s, struct answer *a, const struct dataset *set, size_t n,
                  size_t columns, struct reservation *memory);

/* Points to add. */
struct arrival {
    double *rows; /* x, y, and the values of a point; from dt_pages_grow; may be NULL if n is 0 */
    size_t n;
    struct columns *
        values; /* the names of the fields; NULL: there are none. If it has the values, too, they are
                                  not in the rows */
    struct reservation memory; /* from edit_may_add, and for the points themselves */
    size_t expected;           /* bytes that are prepared for them (keep.h) */
};

/* Adds points, which move here, to the set of that name, which is created if it does not exist. The set must
 * have no writer. Answers `OK 0 first= added= coincident= version=`. */
void edit_add(struct server *s, struct answer *a, const struct word *name, struct arrival *points);

/* Deletes n ids, all or none; ids moves here. Answers `OK 0 deleted= version=`. */
void edit_delete(struct server *s, struct answer *a, struct dataset *set, uint32_t *ids, size_t n);

/* Moves a point. Answers `OK 0 version=`. */
void edit_move(struct server *s, struct answer *a, struct dataset *set, uint32_t id,
               struct dt_point to);

/* Sets n values of a field, all or none; v moves here. Answers `OK 0 version=`. */
void edit_set_values(struct server *s, struct answer *a, struct dataset *set,
                     const struct word *field, struct record_value *v, size_t n);

/* The same for n ids from first on. v, from dt_pages_grow, moves here, and what is reserved for it. */
void edit_set_run(struct server *s, struct answer *a, struct dataset *set, const struct word *field,
                  uint32_t first, double *v, size_t n, struct reservation *memory);

/* Whether there is memory to set n values from an id on; it is reserved. False: the ERR line has been written, or the
 * request waits. */
bool edit_may_set_run(struct server *s, struct answer *a, size_t n, struct reservation *memory);

/* Drops a field. Answers `OK 0 version=`. */
void edit_drop_field(struct server *s, struct answer *a, struct dataset *set,
                     const struct word *field);

/* A new, empty, unborn set; NULL: the ERR line has been written. */
struct dataset *edit_create(struct server *s, struct answer *a, const struct word *name,
                            double tolerance);

#endif
