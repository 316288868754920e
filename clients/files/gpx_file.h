/* gpx_file.h - the points of a GPX file [topografix.com/GPX/1/1]: waypoints (wpt), points of routes (rtept) and of tracks (trkpt), in
 * order. The longitude is x, the latitude y, and the elevation (ele) becomes the field z. Extensions are passed over. */
#pragma once

#include "clients/points/points_file.h"
#include "clients/points/table_fields.h"

enum gpx_kind { GPX_WPT, GPX_RTEPT, GPX_TRKPT, GPX_KINDS };

struct gpx_notes {
    uint64_t points[GPX_KINDS];
    bool heights;
};

/* Adds the points, and the field to *t if an elevation is a number. */
bool gpx_text_read(struct points_file *f, const char *text, size_t n, struct table_fields *t,
                   struct gpx_notes *notes);

/* Writes how the file was read, for instance "x=lon y=lat z=ele of 2 wpt, 130 trkpt". */
void gpx_describe(const struct gpx_notes *notes, char *to, size_t room);
