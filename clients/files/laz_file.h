/* laz_file.h - compressed point clouds (LAZ), read through PDAL's program pdal or LAStools' las2txt. */
#pragma once

#include "clients/points/points_file.h"
#include "clients/points/table_fields.h"

/* Reads the file at `path`, which is open as fd, too. Its z becomes the field z of *t. */
bool laz_file_read(struct points_file *f, const char *path, int fd, struct table_fields *t);
