/* journal.h - the records of edits in the log. Each function is called after the edit has succeeded,
 * in the order of the edits of its set, and gives the set its new version; without --data, and for a temporary set,
 * there is no record. */
#ifndef SERVER_JOURNAL_H
#define SERVER_JOURNAL_H

#include "proto/records/record.h"
#include "server/disk/log.h"
#include "server/jobs/server.h"

void journal_create(struct server *s, struct dataset *set, double tolerance);
void journal_drop(struct server *s, struct dataset *set);

/* p, from dt_pages_grow, moves here; its n points have the ids from `first` on. */
void journal_add(struct server *s, struct dataset *set, uint32_t first, struct dt_point *p,
                 size_t n);
void journal_delete(struct server *s, struct dataset *set, const uint32_t *ids, size_t n);
void journal_move(struct server *s, struct dataset *set, uint32_t id, struct dt_point to);
void journal_expire(struct server *s, struct dataset *set);
/* Values of n ids of a field; and that it has been dropped. */
void journal_set_values(struct server *s, struct dataset *set, const struct word *field,
                        const struct record_value *v, size_t n);
/* A column of values, which moves here. */
void journal_set_run(struct server *s, struct dataset *set, struct columns *v);
/* As journal_add, with values of fields, which move here, too; p is NULL if n is 0. */
void journal_add_values(struct server *s, struct dataset *set, uint32_t first, struct dt_point *p,
                        size_t n, struct columns *v);
void journal_drop_field(struct server *s, struct dataset *set, const struct word *field);
void journal_triangulate(struct server *s, struct dataset *set);

/* The lsn of the last change of the set, of the last DROP (set NULL), or of the last change of all: a reply that
 * acknowledges or shows it waits until it is durable. 0: none. */
uint64_t journal_of(const struct server *s, const struct dataset *set);
uint64_t journal_of_all(const struct server *s);

#endif
