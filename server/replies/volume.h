/* volume.h - the volumes between a surface and a level, or another surface. */
#ifndef SERVER_VOLUME_H
#define SERVER_VOLUME_H

#include "server/jobs/server.h"

struct volume {
    const struct dt_field *field, *minus; /* of the set now; minus: NULL for the level */
    double level;
};

/* Answers with the volumes above and below, and the area of the surface: `OK 0 above= below= area=`. All of one state of
 * the set; a worker reads it in pieces of a few milliseconds. */
void volume_answer(struct server *s, struct answer *a, struct dataset *set,
                   const struct volume *volume);

#endif
