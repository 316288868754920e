/* wkt.h - points in well-known text. */
#ifndef CLIENTS_WKT_H
#define CLIENTS_WKT_H

#include "clients/reading/row.h"

/* The number of the reference system in `SRID=n;POINT ...`; an empty value if it has none. */
struct value wkt_srid(struct value v);

/* Reads the geometry POINT (x y [z ...]). Sets *values to 2 or 3. False if it is another one, or empty. */
bool wkt_read_point(struct value v, double xyz[3], int *values);

#endif
