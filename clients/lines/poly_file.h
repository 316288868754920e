/* poly_file.h - the .poly files of Shewchuk's Triangle: points with attributes, segments with markers, and places in holes and regions. */
#pragma once

#include "clients/points/points_file.h"
#include "clients/points/table_fields.h"

struct poly_notes {
    uint64_t negative; /* markers of segments below 0, which become 0 */
    /* regions whose attribute is no number that a border can have; they get their place in the file */
    uint64_t unnamed;
    uint64_t areas; /* regions with a greatest area, which is not used */
};

/* Reads the points of `text`, or, if it has none, of `node`, which may be NULL. Points keep their places. A segment is a
 * line whose number is its marker; attributes of points are fields a1, a2, ...; holes and regions become seeds. False with a fault. */
bool poly_text_read(struct points_file *f, const char *text, size_t n, const char *node,
                    size_t node_n, struct table_fields *t, struct poly_notes *notes);

/* Reads the .node file beside the .poly file into *text, which is the caller's to free; NULL if there is none. False with a fault. */
bool poly_read_node(struct points_file *f, const char *path, char **text, size_t *n);
