/* vrt_frame.h - where the cells of a raster lie, from GDAL's description of it [gdal.org/drivers/raster/vrt.html]. The description has all
 * digits, which GDAL's header of an ASCII grid has not. */
#pragma once

#include "clients/grids/asc_grid.h"

/* Reads the text of a VRT. NULL, or what is wrong, a static sentence: it is not a raster of one band that lies somewhere. */
const char *vrt_read_frame(const char *text, size_t n, struct grid_frame *g);
