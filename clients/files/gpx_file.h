/* gpx_file.h - the points of a GPX file [topografix.com/GPX/1/1]: every waypoint (wpt), point of a route (rtept) and of a track
 * (trkpt), in order; x is its longitude, y its latitude, and its elevation (ele) becomes the field z. What is in extensions does
 * not count. */
#ifndef CLIENTS_GPX_FILE_H
#define CLIENTS_GPX_FILE_H

#include "clients/files/points_file.h"
#include "clients/files/table_fields.h"

enum gpx_kind { GPX_WPT, GPX_RTEPT, GPX_TRKPT, GPX_KINDS };

struct gpx_notes {
    uint64_t points[GPX_KINDS];
    bool heights;
};

/* Reads the whole file into memory. Adds the field to *t. */
bool gpx_file_read(struct points_file *f, int fd, struct table_fields *t, struct gpx_notes *notes);
bool gpx_text_read(struct points_file *f, const char *text, size_t n, struct table_fields *t,
                   struct gpx_notes *notes);

/* How the file was read, for instance "x=lon y=lat z=ele of 2 wpt, 130 trkpt". */
void gpx_describe(const struct gpx_notes *notes, char *to, size_t room);

#endif
