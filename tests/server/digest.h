/* digest.h - the content of sets as a number: equal for equal sets, and almost certainly different
 * otherwise. */
#ifndef TESTS_SERVER_DIGEST_H
#define TESTS_SERVER_DIGEST_H

#include "server/sets/dataset.h"

/* Points, ids, representatives, values of fields, next id, tolerance, whether it is triangulated,
 * when it is dropped; never 0. */
uint64_t digest_set(const struct dataset *set);

/* The same of points that are no set of a server's. */
uint64_t digest_dt(const struct dt *dt, bool triangulated);

/* Continues a digest with another number. */
uint64_t digest_mix(uint64_t h, const void *bytes, size_t n);

/* All sets and their names, in whatever order they come. */
uint64_t digest_sets(const struct registry *sets);

#endif
