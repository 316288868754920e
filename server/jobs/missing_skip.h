/* missing_skip.h - MISSING skip: a set as if the points without a value of a field had been deleted, which a job builds and the set
 * keeps (skip_copy.h). */
#pragma once

#include "server/jobs/server.h"

/* Whether there is such a version of the set, in *out: the set's own if no value is missing. If not, a worker builds it, while edits
 * of the set go on, and the request waits; or the ERR line has been written. Requests that come meanwhile wait for the same build,
 * unless the set or the field was edited. Nobody edits the version. *out is borrowed for the request. */
bool missing_skip_ready(struct server *s, struct answer *a, struct dataset *set,
                        const struct dt_field *f, struct version **out);
