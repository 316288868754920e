/* profile.h - a surface along a way of straight pieces, as rows. */
#ifndef SERVER_PROFILE_H
#define SERVER_PROFILE_H

#include "server/replies/surface.h"

/* Answers a surface of SURFACE_PROFILE; what *q owns moves here. The source has the field. A short way is followed at once, others by
 * a worker, while edits of the set wait. The rows are in memory before they are sent. */
void profile_answer(struct server *s, struct answer *a, const struct surface_source *from,
                    struct surface *q);

#endif
