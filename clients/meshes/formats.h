/* formats.h - writes a triangulation in the formats of other programs.
 *
 * Points are numbered by their place: 0, 1, 2, ... in the order of their ids. In OBJ and 2DM, whose readers expect it, numbers
 * begin at 1. The number is the id itself as long as no point has been deleted.
 * Aliases are points without a triangle. In OBJ, PLY, OFF and 2DM points have the height of the model's field z, or 0 if there
 * is no such field. No height may be missing (model_drop_missing). .node has all fields as attributes. */
#pragma once

#include "clients/meshes/model.h"

#include <stdio.h>

struct format {
    const char *name; /* also the ending of file names */
    unsigned parts;   /* of the model that it needs (enum model_parts) */
    bool (*write)(FILE *out, const struct model *m); /* false when out of memory */
    const char *what;
    bool heights; /* every point needs one */
};

extern const struct format formats[];
extern const size_t format_count;

/* Writes the shortest text that is read as v. */
void formats_put_number(FILE *out, double v);

/* Triangle's .node. False when out of memory. */
bool formats_write_node(FILE *out, const struct model *m);

/* The format of that name, NULL if there is none. */
const struct format *format_find(const char *name);
