/* png_file.h - writes a PNG, so that pictures need no library. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Writes rgba[4 * width * height], rows from the top. width and height are at least 1 and below 2^31. False when out of memory;
 * ferror() shows whether writing failed. */
bool png_write(FILE *out, const unsigned char *rgba, uint32_t width, uint32_t height);
