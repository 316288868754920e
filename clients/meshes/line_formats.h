/* line_formats.h - writes the constraints of a set, and its other points, as the lines and polygons of other programs' formats.
 *
 * Lines and polygons have their kind and number, so that `load` makes the same constraints of the file. Points have a third
 * coordinate where the model's field z has a value. */
#pragma once

#include "clients/meshes/formats.h"

extern const struct format line_formats[];
extern const size_t line_format_count;

/* The format of that name, NULL if there is none. */
const struct format *line_format_find(const char *name);

enum { FORMATS_LIST = 300 };

/* Writes the names of all formats of pictures, meshes and lines, each once, with the text between them; FORMATS_LIST bytes are enough. */
void formats_list(char *to, size_t room, const char *between);
