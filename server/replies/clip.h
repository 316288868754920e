/* clip.h - RASTER ... CLIP: only cells whose centres are inside a border of another set.
 *
 * A worker marks them, a bit for each cell, before the reply begins. Edits of the other set wait meanwhile. The values are read
 * afterwards, as the raster's set was when the request came, so no worker reads both sets at a time. */
#ifndef SERVER_CLIP_H
#define SERVER_CLIP_H

#include "server/replies/surface.h"

/* Whether the set `other` can clip: its regions are known, and one of its borders is closed. If not, the request waits, or the ERR
 * line has been written. */
bool clip_ready(struct server *s, struct answer *a, struct dataset *other);

/* Answers with the raster of the version, clipped by q->clip; what *q owns moves here. */
void clip_answer(struct server *s, struct answer *a, struct version *v, struct surface *q);

#endif
