/* las_file.h - point clouds in LAS 1.0 to 1.4 [ASPRS, LAS Specification 1.4 - R15]. Compressed ones (LAZ) have the same header; their
 * points are read by another program. */
#pragma once

#include "clients/points/points_file.h"
#include "clients/points/table_fields.h"

enum { LAS_HEADER = 375 }; /* bytes of the longest one that is known, 1.4 */

struct las_header {
    unsigned major, minor, format; /* of points */
    bool compressed;
    uint32_t data;   /* offset of the points */
    uint16_t record; /* bytes of a point */
    uint64_t points;
    double scale[3], offset[3];
    int digits; /* decimal places of the coordinates that the scales leave; -1: they are not decimal */
};

/* Reads the header from the first n bytes of a file. NULL, or what is wrong with it. */
const char *las_read_header(struct las_header *h, const unsigned char *bytes, size_t n);

/* Whether the points of the open file are compressed. It must be a regular file, or else is taken as not compressed. False with a
 * fault if the header is wrong. */
bool las_is_compressed(struct points_file *f, int fd, bool *compressed);

struct las_notes {
    uint64_t withheld; /* points that are marked so: they are loaded */
    /* whole points for which there is room behind the last one: the header may count too few */
    uint64_t behind;
    uint64_t noise; /* points of the classes 7 and 18: they are loaded */
};

/* Reads the points from fd, at the beginning of the file. z becomes the field z; with t->all intensity and classification become fields,
 * too. Adds the fields to *t. */
bool las_file_read(struct points_file *f, int fd, struct table_fields *t, struct las_notes *notes);
