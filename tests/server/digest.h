/* digest.h - the content of sets as a number (server/sets/digest.h). */
#pragma once

#include "server/sets/dataset.h"

/* Returns the digest that DIGEST answers. */
uint64_t digest_now(const struct dataset *set);

/* The digest without the version; never 0. */
uint64_t digest_set(const struct dataset *set);

/* The same for a triangulation that is not a set of a server. */
uint64_t digest_dt(struct dt *dt, bool triangulated);

/* All sets and their names, independent of their order. */
uint64_t digest_sets(const struct registry *sets);
