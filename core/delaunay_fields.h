/* delaunay_fields.h - the third part of the core's public header: values at points.
 *
 * A field is a named column of a set: a double for every id, nan where it is missing. An alias has a value of its
 * own. Fields never change the triangulation; values stay when points move, and go when points are deleted.
 * Values are finite: an infinite one is refused, -0 becomes 0, and there is one nan.
 *
 * Functions that take a const set may run in several threads at once, but not beside an edit, also one of the
 * fields. */
#pragma once

#include "core/delaunay.h"

#ifdef __cplusplus
extern "C" {
#endif

#define DT_MAX_FIELDS 64  /* of a set */
#define DT_FIELD_NAME 64  /* bytes of a name, from 1 on; any but NUL */
#define DT_FIELD_PAGE 512 /* ids whose values lie together: from a multiple of it on */

/* Borrowed from its set: valid until the field is dropped or the set is freed. A field that was read through a view is valid
 * until the view ends or cannot be read any more (dt_view_rows, even when asked for no row, does not return DT_OK). */
struct dt_field;

const char *dt_field_name(const struct dt_field *f); /* ends with NUL; borrowed from the field */

/* Fields of a set, dropped ones included, have different numbers; copies of a set have those of the set. */
uint32_t dt_field_number(const struct dt_field *f);

/* The number of edits of points and constraints so far, failed ones included; edits of values alone do not count. A copy
 * continues the number. So a set with the same number has the same points and constraints. */
uint64_t dt_edits(const struct dt *t);

/* The number of edits of its values so far: a field of the same dt_field_number and edits has the same values. A copy of the
 * set continues it. */
uint64_t dt_field_edits(const struct dt_field *f);

/* The number of points that have a value. Constant. */
uint32_t dt_field_count(const struct dt_field *f);

/* The field of that name; NULL: there is none. Cost: the number of fields. */
const struct dt_field *dt_field_find(const struct dt *t, const char *name, size_t len);

/* The field that follows f by name, or the first one if f is NULL; NULL: there is none. With a view: of those that
 * there were at its moment. Cost: the number of fields. */
const struct dt_field *dt_field_next(const struct dt *t, const struct dt_view *v,
                                     const struct dt_field *f);

struct dt_field_summary {
    const char *name;   /* borrowed; ends with NUL */
    uint32_t values;    /* how many are there */
    double least, most; /* of them; nan if there are none */
};

/* As it is now. Cost: one step for DT_FIELD_PAGE ids. */
void dt_field_summary(const struct dt_field *f, struct dt_field_summary *out);

/* The values of n ids at the moment of the view, now if v is NULL: out[n]; nan where a value is missing or there is
 * no such id. Cost: constant for each. */
void dt_field_values(const struct dt_field *f, const struct dt_view *v, const uint32_t *ids,
                     size_t n, double *out);

/* The values of the ids from *from, a multiple of DT_FIELD_PAGE, on: DT_FIELD_PAGE of them, valid until the next
 * edit. If all values are missing there is no page: *from advances to the next existing one. NULL: there is none.
 * Cost: constant, amortised over the pages of a field. */
const double *dt_field_page(const struct dt_field *f, const struct dt_view *v, uint64_t *from);

/* Sets the values of n ids, all or none; nan takes a value away, and of several for an id the last one counts.
 * The field is created if there is none of that name. DT_NOPOINT puts the first id that is missing in *missing;
 * DT_RANGE: a value is infinite; DT_TOOBIG: it would be field DT_MAX_FIELDS + 1. opt may be NULL: its flag and
 * its steps. Cost: constant for each. */
enum dt_status dt_field_set(struct dt *t, const char *name, size_t len, const uint32_t *ids,
                            const double *values, size_t n, const struct dt_options *opt,
                            uint32_t *missing);

/* The same for the ids first .. first + n - 1. There need be no point where the value is nan. */
enum dt_status dt_field_set_run(struct dt *t, const char *name, size_t len, uint32_t first,
                                const double *values, size_t n, const struct dt_options *opt,
                                uint32_t *missing);

/* Values for all of the points that are added together. */
struct dt_values_of {
    const char *name;     /* of the field; borrowed, as the values */
    size_t len;           /* of the name */
    const double *values; /* of the points, in their order */
};

/* dt_add_many, and the values of the new points in `columns` fields with different names, all or none. */
enum dt_status dt_add_values(struct dt *t, const struct dt_point *p, size_t n,
                             const struct dt_values_of *column, size_t columns,
                             const struct dt_options *opt, struct dt_added *out);

/* DT_NOFIELD: there is none of that name. Cost: its pages. */
enum dt_status dt_field_drop(struct dt *t, const char *name, size_t len);

#ifdef __cplusplus
}
#endif
