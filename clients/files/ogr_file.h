/* ogr_file.h - files of points, lines and polygons that OGR (GDAL) knows: Shapefiles, GeoPackages, FlatGeobuf. Its program ogr2ogr makes
 * GeoJSON of them, in their own reference system. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

extern const char ogr_program[], ogr_hint[]; /* its name, and what may help where it fails */

/* Whether a name ends as these files do. */
bool ogr_is_name(const char *path);

/* Starts the program; *out gets the GeoJSON. False with a sentence in why[room], and then *pid is 0 and *out is -1. */
bool ogr_start(const char *path, pid_t *pid, int *out, char *why, size_t room);
