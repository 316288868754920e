/* show_relief.h - a surface in the terminal, as shaded relief. */
#pragma once

#include "clients/lib/delaunay_client.h"
#include "clients/surfaces/grid_file.h"

/* Draws the field on at most `columns` by `lines` characters, of which each has two cells one above the other; plain: in
 * characters from low to high instead of colours; the last line says which heights they are, unless there is too little room;
 * geographic: places are in degrees. Returns the exit status, having said what is wrong. */
int show_relief(struct delaunay_client *c, const char *set, const char *field, uint32_t columns,
                uint32_t lines, bool plain, bool geographic);

/* The number of the nearest colour of the 6 x 6 x 6 cube that terminals with 256 colours have. */
unsigned show_relief_cube(uint32_t rgb);
