/* brute.h - every query of core/delaunay.h by brute force, for small sets with tolerance 0.
 *
 * Gift wrapping on a matrix of directed edges, linear scans, no mesh, no grid; it uses only the predicates
 * of core/, which have an oracle of their own (exact.h). Time and memory are O(n^2) or more: for a few
 * hundred points. */
#pragma once

#include "core/delaunay.h"

struct brute {
    uint32_t n;         /* ids are 0 .. n - 1 */
    struct dt_point *p; /* owns, by id */
    uint32_t *rep;      /* owns, by id: the representative, DT_NONE for a deleted id */
    uint32_t *apex; /* owns n * n: of the edge from a to b the corner left of it, DT_NONE if it has
                        no triangle */
    /* owns; if all points are on one line: the representatives along it; else NULL */
    uint32_t *line;
    uint32_t points; /* representatives */
};

/* The triangulation of the points p[id] with live[id] (NULL: all). */
struct brute *brute_new(const struct dt_point *p, const bool *live, uint32_t n);
void brute_free(struct brute *b);

/* Each appends to *out; the rows of a table as dt_table_read writes them. */
void brute_table(const struct brute *b, enum dt_table table, bool cw, struct dt_ids *out);
void brute_ring(const struct brute *b, uint32_t id, bool cw, struct dt_ids *out);
void brute_nearest(const struct brute *b, struct dt_point q, uint32_t k, struct dt_ids *out);
void brute_within_box(const struct brute *b, struct dt_point lo, struct dt_point hi,
                      struct dt_ids *out);
void brute_within_disc(const struct brute *b, struct dt_point centre, double r, struct dt_ids *out);

bool brute_on_hull(const struct brute *b, uint32_t id);
struct dt_location brute_locate(const struct brute *b, struct dt_point q);
