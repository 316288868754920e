/* digest.h - the content of sets as a number: equal for equal sets, and almost certainly different
 * otherwise. */
#ifndef TESTS_SERVER_DIGEST_H
#define TESTS_SERVER_DIGEST_H

#include "server/sets/dataset.h"

/* Covers points, ids, representatives, values of fields, next id, tolerance, whether the set is
 * triangulated, and when it expires; never 0. */
uint64_t digest_set(const struct dataset *set);

/* The same for a triangulation that is not a set of a server. */
uint64_t digest_dt(const struct dt *dt, bool triangulated);

/* Continues a digest with another number. */
uint64_t digest_mix(uint64_t h, const void *bytes, size_t n);

/* All sets and their names, independent of their order. */
uint64_t digest_sets(const struct registry *sets);

#endif
