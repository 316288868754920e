/* values.h - surfaces for tests: random values by id, and values of a field. */
#pragma once

#include "core/delaunay_surface.h"

/* METHODS methods whose values are between those of points, and then DT_SMOOTH. */
enum { METHODS = 4 };
extern const enum dt_interpolation all_methods[METHODS + 1];

/* Draws new random values, from 1000 to 1001, for the ids of 60 pages; values of higher ids are missing. */
void make_values(void);
double value_of(uint32_t id);

/* The surface of these values. */
struct dt_surface surface_of(enum dt_interpolation how);

/* A set with values of its points in the field z; nan: none. */
struct dt *set_with(const struct dt_point *p, const double *z, uint32_t n);

/* The surface of its field z, to be ended. */
struct dt_surface surface_in(const struct dt *t, enum dt_interpolation how);

double value_at(const struct dt *t, const struct dt_surface *s, struct dt_point q);

/* The value of the field z at x y. */
double value_in(const struct dt *t, enum dt_interpolation how, double max_edge, double x, double y);

/* Both have the same bytes, or are missing; q is where. */
void check_same(double got, double want, struct dt_point q);
