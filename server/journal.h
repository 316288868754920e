/* journal.h - what an edit writes into the log. Each function is called once the edit has
 * succeeded, in the order of the edits of its set, and returns the lsn that must be durable before
 * the edit is acknowledged; without --data it does nothing and returns 0. */
#ifndef SERVER_JOURNAL_H
#define SERVER_JOURNAL_H

#include "server/server.h"

uint64_t journal_create(struct server *s, struct dataset *set, double tolerance);
uint64_t journal_drop(struct server *s, struct dataset *set);

/* Takes over p (from malloc), whose n points got the ids from `first` on. */
uint64_t journal_add(struct server *s, struct dataset *set, uint32_t first, struct dt_point *p,
                     size_t n);
uint64_t journal_delete(struct server *s, struct dataset *set, const uint32_t *ids, size_t n);
uint64_t journal_move(struct server *s, struct dataset *set, uint32_t id, struct dt_point to);
uint64_t journal_triangulate(struct server *s, struct dataset *set);

#endif
