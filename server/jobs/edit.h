/* edit.h - the jobs that change the points of a set: add, delete, move. */
#ifndef SERVER_EDIT_H
#define SERVER_EDIT_H

#include "server/jobs/job.h"

/* Whether the set, NULL for a new one, may grow by n points, for which `memory` is reserved if they are
 * many. False: a says why not, or to wait. */
bool edit_may_add(struct server *s, struct answer *a, const struct dataset *set, size_t n,
                  struct reservation *memory);

/* Points to add. */
struct arrival {
    struct dt_point *p; /* from dt_pages_grow; may be NULL if n is 0 */
    size_t n;
    struct reservation memory; /* of edit_may_add, and of the points themselves */
    size_t expected;           /* bytes that are expected to be wanted (keep.h) */
};

/* Adds points, which it takes over, to the set of that name, which is created if it is missing. The
 * set must be free: registry_find(...)->writer == NULL. Answers `OK 0 first= added= coincident=`. */
void edit_add(struct server *s, struct answer *a, const struct word *name, struct arrival *points);

/* Deletes n ids, all or none; takes over ids. Answers `OK 0 deleted=`. */
void edit_delete(struct server *s, struct answer *a, struct dataset *set, uint32_t *ids, size_t n);

/* Moves a point. Answers `OK 0`. */
void edit_move(struct server *s, struct answer *a, struct dataset *set, uint32_t id,
               struct dt_point to);

/* A new, empty, unborn set; NULL: the error has been told. */
struct dataset *edit_create(struct server *s, struct answer *a, const struct word *name,
                            double tolerance);

#endif
