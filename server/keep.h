/* keep.h - the pages that large arrays of sets and of loads have left behind (dt_pages): how many the
 * server keeps to use them again, and when they go back to the system.
 *
 * What is kept and what is in use together stay below --max-memory; and when nothing has been taken or
 * given for a while, all that is kept goes back, by a worker, a piece at a time. */
#ifndef SERVER_KEEP_H
#define SERVER_KEEP_H

#include "server/server.h"

/* To be called when s->sets.memory or s->loading has changed: sets the limit of what may be kept. */
void keep_account(struct server *s);

/* Once a second. */
void keep_tick(struct server *s);

#endif
