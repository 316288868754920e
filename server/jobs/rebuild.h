/* rebuild.h - sets that were read from the disk are triangulated again, the smallest one first. Each may
 * be used as soon as it is. */
#ifndef SERVER_REBUILD_H
#define SERVER_REBUILD_H

#include "server/jobs/server.h"

/* durable_on_event, and begins when that has read the sets. False: the directory cannot be used; the
 * reason is on standard error. */
bool rebuild_on_durable_event(struct server *s);

/* The error for a set that is still loading. */
void rebuild_refuse(const struct server *s, struct answer *a, const struct dataset *set);

void rebuild_free(struct server *s);

#endif
