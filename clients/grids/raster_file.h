/* raster_file.h - rasters of other formats, GeoTIFF for instance, through GDAL's program gdal_translate: the centres of their cells. */
#pragma once

#include "clients/grids/asc_grid.h"

/* Whether the name ends as those of rasters do, and whether a file begins as a TIFF does; n bytes of it are known. */
bool raster_is_name(const char *name);
bool raster_begins(const char *head, size_t n);

/* Reads the raster of one band at the path, or the member of this name of the zip archive there; member "": it is no archive. Values are
 * exact, after the scale and the offset of the band. Points and fields as asc_text_read makes them. False with a fault. */
bool raster_file_read(struct points_file *f, const char *path, const char *member,
                      struct table_fields *t, struct grid_notes *notes);
