/* renew.h - a set's grid of hints made by a worker: when a search first wants one, and anew when edits
 * have aged it. Neither the I/O thread nor those who read the set wait for that; its edits do. */
#ifndef SERVER_RENEW_H
#define SERVER_RENEW_H

#include "server/jobs/server.h"

/* Whether searches of the set's triangulation find a grid, or have to do without. If not, one is being
 * made, and whoever asks waits for the set. */
bool renew_has_grid(struct server *s, struct dataset *set);

/* To be called when an edit of the set is done. */
void renew_if_aged(struct server *s, struct dataset *set);

#endif
