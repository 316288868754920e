/* renew.h - a set's grid of hints made anew by a worker, when edits have aged it: neither the I/O thread
 * nor those who query the set wait for that; its edits do. */
#ifndef SERVER_RENEW_H
#define SERVER_RENEW_H

#include "server/server.h"

/* To be called when an edit of the set is done. */
void renew_if_aged(struct server *s, struct dataset *set);

#endif
