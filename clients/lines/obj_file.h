/* obj_file.h - points and lines of Wavefront OBJ: `v x y z`, and `l` with the numbers of points. */
#pragma once

#include "clients/points/points_file.h"
#include "clients/points/table_fields.h"

struct obj_notes {
    bool heights;    /* a third coordinate is not 0, so they are the field z */
    uint64_t faces;  /* elements `f`, which are not used */
    uint64_t others; /* lines of other kinds, which are not used */
};

/* Every `l` is a line with the next number, unless it is in a group or object called line_7 or border_7, as
 * our own files name them. Points keep their places: a line's corners are those that the file numbers. False with a fault. */
bool obj_text_read(struct points_file *f, const char *text, size_t n, struct table_fields *t,
                   struct obj_notes *notes);
