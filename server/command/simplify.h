/* simplify.h - a new set of few points, whose surface is near all points of another one. */
#pragma once

#include "server/changes/name.h"
#include "server/jobs/server.h"

struct simplify {
    const struct dt_field *field; /* of the set now */
    struct name other;            /* the new set */
    struct name ids;              /* its field with the ids of the set; len 0: none */
    double error;
    uint32_t most; /* points */
};

/* Whether there is no set of that name; else the ERR line has been written. */
bool simplify_is_new(struct server *s, struct answer *a, const struct name *other);

/* Makes the set, which is logged as if its points had been loaded, and answers `OK 0 points= constraints= error=` and its version.
 * All of one state of the set. A worker reads the set in pieces of a few milliseconds, and thins its points out without it. */
void simplify_answer(struct server *s, struct answer *a, struct dataset *set,
                     const struct simplify *simplify);
