/* upkeep.h - jobs that change how a set is stored, and not what is in it: so they have no record in the log, and the version
 * that clients see stays.
 *
 *     the triangulation   edits of many points leave it for later: a job updates it before the next query
 *     the regions         that borders enclose: found before the first query that needs them, and again when borders have changed
 *     the grid            for searches: built before the first one, and again when edits have degraded it */
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
