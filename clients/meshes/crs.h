/* crs.h - the coordinate reference system that the user names for a file. It is written into the file; coordinates stay as they are. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

enum { CRS_PART = 20 };

/* Start with {0}: not given. */
struct crs {
    char authority[CRS_PART + 1]; /* EPSG, ESRI, OGC; letters in upper case */
    char code[CRS_PART + 1];      /* 32629, CRS84 */
};

/* Reads `EPSG:32629`, `OGC:CRS84`, `CRS84`, or the URN `urn:ogc:def:crs:EPSG::32629` [OGC 09-048r5, section 7], in upper or lower case.
 * False if it is none of these, *crs unchanged. Whether there is such a system is not known. */
bool crs_read(const char *text, struct crs *crs);

static inline bool crs_is_given(const struct crs *crs)
{
    return crs != NULL && crs->code[0] != '\0';
}

/* Begins a FeatureCollection up to its first feature; with the member crs [The GeoJSON Format Specification, 2008, section 3] if it is
 * given. RFC 7946 has no such member: there, coordinates are longitudes and latitudes. */
void crs_begin_geojson(FILE *out, const struct crs *crs);
