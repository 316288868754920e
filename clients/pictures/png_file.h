/* png_file.h - writes a PNG, so that pictures need no library. */
#pragma once

#include <stdint.h>
#include <stdio.h>

/* Writes rgba[4 * width * height], rows from the top. gzip compresses them; without that program they are not compressed. width and height
 * are at least 1 and below 2^31. A temporary file has about as many bytes as rgba. Returns NULL, or a static sentence; ferror() shows
 * whether writing failed. */
const char *png_write(FILE *out, const unsigned char *rgba, uint32_t width, uint32_t height);
