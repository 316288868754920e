/* geojson_file.h - the points, lines and polygons of a GeoJSON file [RFC 7946]: one value, or several after one another
 * (newline-delimited features). Only geometries count, in order, that are the geometry of a feature, in a collection, or alone.
 * Properties and other members that look like a geometry do not count. Every line and every polygon has the next number, unless the
 * properties of its feature are those that our files have, {"kind":"border","number":7}. */
#pragma once

#include "clients/points/points_file.h"
#include "clients/points/table_fields.h"

struct geojson_notes {
    bool projected; /* a member crs names another system than longitudes and latitudes */
    bool heights;   /* there are third coordinates */
    char property[FIELDS_NAME]; /* the property that has the heights instead; "": none */
    uint64_t nowhere;           /* features and geometries without a place */
    uint64_t more;              /* positions of more than three numbers */
    char unused[400];           /* the names of properties that are not used, between commas */
};

/* Reads the text twice: first to learn which fields there are. Third coordinates become the field z,
 * or else a property whose name says that it is a height; with t->all all properties become fields that are more often numbers
 * than something else. Adds the fields to *t and counts what is missing. *notes is filled in. */
bool geojson_text_read(struct points_file *f, const char *text, size_t n, struct table_fields *t,
                       struct geojson_notes *notes);
