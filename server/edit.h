/* edit.h - the jobs that change the points of a set: add, delete, move. */
#ifndef SERVER_EDIT_H
#define SERVER_EDIT_H

#include "server/job.h"

/* Adds n points to the set of that name, which is created if it is missing; takes over p (from
 * dt_pages_grow; may be NULL if n is 0), and the caller's word that `expected` bytes will be wanted
 * (keep.h), which is over with the job. The set must be free: registry_find(...)->writer == NULL.
 * Answers `OK 0 first= added= coincident=`. */
void edit_add(struct server *s, struct answer *a, const struct word *name, struct dt_point *p,
              size_t n, size_t expected);

/* Deletes n ids, all or none; takes over ids. Answers `OK 0 deleted=`. */
void edit_delete(struct server *s, struct answer *a, struct dataset *set, uint32_t *ids, size_t n);

/* Moves a point. Answers `OK 0`. */
void edit_move(struct server *s, struct answer *a, struct dataset *set, uint32_t id,
               struct dt_point to);

/* A new, empty, unborn set; NULL: the error has been told. */
struct dataset *edit_create(struct server *s, struct answer *a, const struct word *name,
                            double tolerance);

#endif
