/* salvage.h - repair of a damaged snapshot for --repair. See salvage.c. */
#pragma once

#include "server/disk/datadir.h"

/* Repairs the directory, whose newest snapshot is damaged, and reports on standard output what was lost. False:
 * it cannot; the reason is on standard output. */
bool salvage(struct datadir *dir);
