/* renew.h - a worker builds a set's grid for searches, when the first search needs it, and rebuilds it when
 * edits have degraded it. The I/O thread and readers of the set do not wait for that; edits do. */
#ifndef SERVER_RENEW_H
#define SERVER_RENEW_H

#include "server/jobs/server.h"

/* Whether searches of the set can begin: the grid exists, or there is no memory for one. If not, it is being
 * built, and the request waits for the set. */
bool renew_has_grid(struct server *s, struct dataset *set);

/* Rebuilds the grid if edits have degraded it; to be called after an edit of the set. */
void renew_if_due(struct server *s, struct dataset *set);

#endif
