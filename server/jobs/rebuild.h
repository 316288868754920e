/* rebuild.h - triangulates the sets that were read at the start again, the smallest one first. Each can be used
 * as soon as it is triangulated. */
#ifndef SERVER_REBUILD_H
#define SERVER_REBUILD_H

#include "server/jobs/server.h"

/* Calls durable_on_event, and begins when the sets have been read. False: the directory cannot be used; the reason
 * is on standard error. */
bool rebuild_on_durable_event(struct server *s);

/* Writes the error for a set that is not triangulated yet. */
void rebuild_refuse(const struct server *s, struct answer *a, const struct dataset *set);

void rebuild_free(struct server *s);

#endif
