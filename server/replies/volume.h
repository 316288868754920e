/* volume.h - the volumes between a surface and a level, or another surface. */
#ifndef SERVER_VOLUME_H
#define SERVER_VOLUME_H

#include "server/jobs/server.h"
#include "server/sets/surface_rows.h"

struct volume {
    const struct dt_field *field, *minus; /* of the set now; minus: NULL for the level */
    double level;
    bool based;           /* the level or the other field has been read */
    struct inside inside; /* regions_ready */
    bool skip;            /* MISSING skip */
    bool clipped;
    struct dt_point lo, hi; /* of the box, if clipped */
};

/* Answers with the volumes above and below, and the area of the surface: `OK 0 above= below= area=`. All of one state of
 * the set; a worker reads it in pieces of a few milliseconds. With INSIDE edits of the set wait until it has. */
void volume_answer(struct server *s, struct answer *a, const struct surface_source *from,
                   const struct volume *volume);

#endif
