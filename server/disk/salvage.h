/* salvage.h - what --repair does about a damaged snapshot. See salvage.c. */
#ifndef SERVER_SALVAGE_H
#define SERVER_SALVAGE_H

#include "server/disk/datadir.h"

/* Makes the directory good again, whose newest snapshot is damaged, and tells on standard output
 * what was lost. False, with a sentence there: it cannot. */
bool salvage(const struct datadir *dir);

#endif
