/* upkeep.h - jobs that change how a set is stored, and not what is in it: so they have no record in the log, and the version
 * that clients see stays.
 *
 *     the triangulation   edits of many points leave it for later: a job updates it before the next query
 *     the regions         that borders enclose: found before the first query that needs them, and again when borders have changed
 *     the grid            for searches: built before the first one, and again when edits have degraded it
 *     after a start       sets come from the disk without their triangulations: the smallest one is built first, and each
 *                         set can be used as soon as its own is there */
#pragma once

#include "server/jobs/server.h"

/* Whether the triangulation of the set, if it has one, is current. If not, the request waits for the set or for the job that
 * updates it, or the error has been written. */
bool upkeep_refresh(struct server *s, struct answer *a, struct dataset *set);

/* Whether the regions of the set, which is triangulated, are known; otherwise as upkeep_refresh. */
bool upkeep_survey(struct server *s, struct answer *a, struct dataset *set);

/* Whether searches of the set can begin: the grid exists, or there is no memory for one. If not, it is being built, while
 * others read the set, and the request waits for the set. */
bool upkeep_prepare(struct server *s, struct answer *a, struct dataset *set);

/* To be called after an edit of the set: rebuilds the grid if edits have degraded it. */
void upkeep_after_edit(struct server *s, struct dataset *set);

/* Calls durable_on_event, and begins to triangulate when the sets have been read. False: the directory cannot be used; the
 * reason is on standard error. */
bool upkeep_on_durable_event(struct server *s);

/* Writes the error for a set that is still to be triangulated after the start. */
void upkeep_refuse(struct answer *a, const struct dataset *set);
