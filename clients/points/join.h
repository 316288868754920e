/* join.h - lines that meet have a common point, and steps and rings that say nothing are left out. */
#ifndef CLIENTS_JOIN_H
#define CLIENTS_JOIN_H

#include "clients/points/points_file.h"

/* Corners of paths that have the place and all values of an earlier corner become that point, unless paths.given is set. Points
 * that no path has as a corner stay as they are. Then it leaves out steps of no length, rings of fewer than three corners, and
 * rings that their polygon has already, and counts the rest. False with a fault when out of memory. Cost: O(n log n). */
bool paths_join(struct points_file *f);

/* A segment: what is 2 k for a line of number k, 2 k + 1 for a border; a < b are places of points. */
struct segment {
    uint32_t what, a, b;
};

/* Returns the segments of all paths, sorted and each once; the caller frees them. A common side of two rings of a polygon is no
 * border between inside and outside: sides that a border has an even number of times are left out. NULL when out of memory. */
struct segment *paths_segments(const struct paths *p, size_t *n);

void segments_sort(struct segment *segment, size_t n);

#endif
