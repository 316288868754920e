/* model_paths.h - the constraints of a set as paths, as a file of lines has them. */
#pragma once

#include "clients/meshes/model.h"
#include "clients/points/paths.h"

/* Joins the constraints of each kind and number to long paths, those with the smallest id first. Borders whose points all have an even
 * number of them become rings, which touch at points at most: each outer ring is followed by its holes. Paths begin at the point of the
 * smallest id from which that is possible, and continue to the point of the smaller id. *p must be zeroed. False when out of memory.
 * Cost: O(m log m) for m constraints, besides nesting.h. */
bool model_paths(const struct model *m, struct paths *p);
