/* wkt.h - geometries in well-known text: their kinds. lines/wkt_lines.h reads them. */
#pragma once

#include "clients/reading/row.h"

/* The number of the reference system in `SRID=n;POINT ...`; an empty value if it has none. */
struct value wkt_srid(struct value v);

/* The text after that prefix. */
struct value wkt_without_srid(struct value v);

/* Pass a word, in upper or lower case, and blanks after it; the kind of a geometry with its Z, M or ZM. *flat: it has M, but not Z. False,
 * and *v is unchanged, if there is another one. */
bool wkt_take_word(struct value *v, const char *word);
bool wkt_take_kind(struct value *v, const char *kind, bool *flat);

/* The kind of a geometry of curves, which no reader reads: CIRCULARSTRING, COMPOUNDCURVE, CURVEPOLYGON, MULTICURVE or MULTISURFACE; NULL
 * for others. Kinds: OGC 06-103r4, section 7. */
const char *wkt_curved_kind(struct value v);

/* Whether it begins as a geometry of any kind, and whether its first position has a height; false for curves. */
bool wkt_is_geometry(struct value v, bool *solid);
