/* headings.h - what a column's heading names: a coordinate (`x`, `POINT_Y`, `Longitude (deg)`) or heights, in several languages. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum axis { AXIS_X, AXIS_Y, AXIS_NONE };

/* The pairs of names; x of one pair does not go with y of another. */
enum heading_pair { PAIR_XY, PAIR_LON_LAT, PAIR_EAST_NORTH, PAIR_COUNT };

struct heading {
    enum axis axis;
    enum heading_pair pair;
    bool plain;    /* the name alone, in upper or lower case */
    bool reversed; /* a longitude that counts to the west, a latitude that counts to the south */
};

/* Reads a heading of `len` bytes (UTF-8 or Latin-1). Accents, units in brackets, words such as coord, point, utm or deg, and
 * separators between words do not count; a heading with any other word names no coordinate. */
struct heading heading_read(const char *text, size_t len);

/* The part of an angle that the heading names: 'd' for lat_deg, 'm' for Lon M, 's' for latitude_seconds; 0 if none. Sets *axis. */
char heading_part(const char *text, size_t len, enum axis *axis);

/* The columns of x and y among headings of a table, found one after the other. */
struct heading_search {
    size_t column[PAIR_COUNT][2], plain_column[PAIR_COUNT][2];
    unsigned found[PAIR_COUNT][2], plain[PAIR_COUNT][2];
};

void heading_search_add(struct heading_search *s, size_t column, const char *text, size_t len);

/* False if no pair is there exactly once. A pair of plain names precedes others; among several of these the
 * order of enum heading_pair decides. *obvious: there was only one choice, and the names are plain. */
bool heading_search_end(const struct heading_search *s, size_t column[2], bool *obvious);

/* Whether it names heights: z, elevation, altitude, ... or depths, which are heights downwards. */
bool heading_is_height(const char *text, size_t len);
bool heading_is_depth(const char *text, size_t len);
