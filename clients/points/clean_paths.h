/* clean_paths.h - paths as they are sent: corners of lines that meet become one point. Steps of no length, flat rings and repeated rings
 * are left out. model_paths.h joins constraints to lines again. */
#pragma once

#include "clients/points/points_file.h"

/* Corners of paths that have the place and all values of an earlier corner become that point, unless paths.given is set. Points
 * that no path has as a corner stay as they are. Then it leaves out steps of no length, rings of fewer than three corners, and
 * rings that their polygon has already, and counts the rest. False with a fault when out of memory. Cost: O(n log n). */
bool paths_clean(struct points_file *f);

/* A hash table of places of points; the first point at a place stands for the place. */
struct place_table {
    const struct points_file *f;
    uint32_t *place; /* owns cap */
    size_t cap;
};

/* For n points. False when out of memory; place_table_free in any case. */
bool place_table_init(struct place_table *t, const struct points_file *f, size_t n);
void place_table_free(struct place_table *t);

/* The first point at the place of point i, with equal values if `values` is true, that this was asked of; i itself if there is none. */
uint32_t place_table_find(struct place_table *t, size_t i, bool values);

/* The first field in which two points differ; f->fields if there is none. Nan equals nan. */
size_t points_difference(const struct points_file *f, size_t a, size_t b);

/* A segment: what is 2 k for a line of number k, 2 k + 1 for a border; a < b are places of points. */
struct segment {
    uint32_t what, a, b;
};

/* Returns the segments of all paths, sorted and each once; the caller frees them. A common side of two rings of a polygon is no
 * border between inside and outside: sides that a border has an even number of times are left out. NULL when out of memory. */
struct segment *paths_segments(const struct paths *p, size_t *n);

void segments_sort(struct segment *segment, size_t n);
