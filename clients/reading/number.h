/* number.h - numbers as people and programs write them in tables: decimal commas, groups of thousands, FORTRAN's
 * exponents, degrees with minutes, seconds and hemispheres, units. */
#pragma once

#include "clients/reading/row.h"

/* The meaning of a single comma, which a number such as 1,234 does not show by itself. */
enum comma { COMMA_UNKNOWN, COMMA_DECIMAL, COMMA_GROUPS };

struct number_style {
    enum comma comma;
    bool point_groups; /* 1.234 is 1234 */
    bool commas;       /* numbers with commas have been seen */
};

/* The form of a number, which shows what commas and points mean in its file. */
enum number_shape {
    SHAPE_NONE,         /* not a number */
    SHAPE_INTEGER,      /* 12 */
    SHAPE_POINT,        /* 12.5 */
    SHAPE_POINT_EITHER, /* 1.234: also groups */
    SHAPE_POINT_GROUPS, /* 1.234.567, 1.234,5 */
    SHAPE_COMMA,        /* 12,5 */
    SHAPE_COMMA_EITHER, /* 1,234: also groups */
    SHAPE_COMMA_GROUPS, /* 1,234,567, 1,234.5 */
    SHAPE_COUNT
};

enum number_shape number_shape(struct value v);

/* Reads a number; false if it is none, or if the style does not decide what a comma means. It may be infinite. */
bool number_read(const struct number_style *style, struct value v, double *x);

/* Reads degrees as 53.2N, 53° 20' 30" N, S 53:20:30. `axis` is 0 for a longitude (E, W), 1 for a latitude (N, S). False
 * without a degree sign, a colon or a letter. */
bool number_read_degrees(const struct number_style *style, struct value v, int axis, double *x);

/* Removes a unit of lengths or angles behind a number: "12 m". False if there is none. */
bool number_split_unit(struct value *v, struct value *unit);

/* Whether it is what tables have in the place of a missing number: nothing, -, NA, n/a, null, ***, ... */
bool number_is_missing(struct value v);
