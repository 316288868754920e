/* wkt_lines.h - lines and polygons in well-known text, as columns of tables have them. */
#pragma once

#include "clients/points/points_file.h"
#include "clients/reading/row.h"

/* The name that a table gives a geometry beside it. */
struct wkt_name {
    bool named; /* the kind of its lines, and the number of all its parts, are given */
    bool border;
    uint32_t number;
};

/* Appends the points and paths of any geometry of points, lines and polygons. z: where f->row has the third coordinate of a point, which
 * is set before each point; NULL if no field has it. Polygons are borders; every line and polygon has the next number unless
 * name->named. False with a fault, and nothing appended. */
bool wkt_lines_read(struct points_file *f, struct value v, const struct wkt_name *name, double *z);
