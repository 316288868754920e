/* sets.h - sets of points for tests that read triangulations, each with its brute-force twin. */
#pragma once

#include "core/delaunay.h"
#include "tests/oracle/brute.h"

/* A triangulated set of n points. */
struct dt *set_of(const struct dt_point *p, uint32_t n);

/* The same points, triangulated before they are added, one by one: other vertices, other half edges. */
struct dt *set_of_each(const struct dt_point *p, uint32_t n);

/* A triangulated set and its expected answers. */
struct pair {
    struct dt *t;
    struct brute *b;
};

struct pair pair_of(const struct dt_point *p, uint32_t n);
void pair_free(struct pair *pair);

/* Calls test for small sets of every family, with and without deleted ids. */
void for_each_pair(void (*test)(const struct pair *pair));

/* By enum dt_table. */
extern const char *const table_names[6];

/* Appends n words. */
void append_ids(struct dt_ids *ids, const uint32_t *v, size_t n);

/* Fails with both rows in the message unless the arrays are equal. */
void check_equal_ids(const char *what, const struct dt_ids *got, const struct dt_ids *want);

/* A place that is interesting for the set: a point, the middle of two, one beside a point, or
 * anywhere in its box. */
struct dt_point random_place(const struct brute *b);
