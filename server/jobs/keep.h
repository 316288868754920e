/* keep.h - the pages that large arrays of sets and of loads have left behind (dt_pages): how many the
 * server keeps to use them again, and when they go back to the system.
 *
 * What is kept is free memory in the budget (budget.h): it goes back when it is reserved for something
 * else; and when nothing has been taken or
 * given for a while, all that is kept goes back, by a worker, a piece at a time.
 *
 * A set that is being loaded will want pages as soon as it is there, and fresh ones are slow to come by.
 * So while its points arrive, a worker has them made ready, as many as what has arrived will take. */
#ifndef SERVER_KEEP_H
#define SERVER_KEEP_H

#include "server/jobs/server.h"

/* What is being received will want `more` bytes of large arrays, or `less` than was told before: workers
 * make pages ready meanwhile. */
void keep_expect(struct server *s, size_t more, size_t less);

/* Once a second. */
void keep_tick(struct server *s);

/* At the end of each turn of the loop: gives back what is kept beyond its limit. */
void keep_turn_end(struct server *s);

#endif
