/* ahead.h - reading ahead in a pipeline: where several requests have come at once, what the queries
 * and the edits of single points among them will look at is fetched into the caches for all of them
 * together, before the first is carried out (core/ahead.c). It has no other effect, and whatever it
 * does not understand it leaves to those who carry it out. */
#ifndef SERVER_AHEAD_H
#define SERVER_AHEAD_H

#include "server/server.h"

/* Looks at the requests at the front of bytes[n]. Returns how many requests need no second look; at
 * least 1. Cost: as much as reading the requests. */
unsigned ahead_look(struct server *s, const char *bytes, size_t n);

#endif
