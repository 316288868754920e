/* png_file.h - writes a PNG, so that pictures need no library. */
#pragma once

#include <stdint.h>
#include <stdio.h>

/* Writes rgba[4 * width * height], rows from the top, compressed by gzip, or as they are where there is no such program. width and height
 * are at least 1 and below 2^31. Needs as much room for temporary files. Returns NULL, or a static sentence; ferror() shows whether
 * writing failed. */
const char *png_write(FILE *out, const unsigned char *rgba, uint32_t width, uint32_t height);
