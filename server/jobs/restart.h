/* restart.h - the order in which sets become usable after a restart. Sets come from the disk without their triangulations.
 * When all have been read, the smallest one is triangulated first, and each can be used as soon as it is. Until then,
 * commands that need the set are refused with LOADING. */
#pragma once

#include "server/jobs/server.h"

/* Calls durable_on_event, and begins to triangulate when the sets have been read. False: the directory cannot be used; the
 * reason is on standard error. */
bool restart_on_durable_event(struct server *s);

/* Writes the error for a set that is still to be triangulated. */
void restart_refuse(struct answer *a, const struct dataset *set);
