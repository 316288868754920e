/* query.h - functions that all searches near a place use. */
#pragma once

#include "core/set/set.h"

/* dt_find, also for sets of one point, whose half edge is DT_NONE, or none. */
enum dt_where dt_place_find(const struct dt *t, struct dt_point q, uint32_t near, uint32_t *half);

/* The inside of the border of this number, or of any border if the number is DT_NONE, for questions about the faces of
 * triangles (core/mesh/fixed.h). Errors of dt_region_check. */
enum dt_status dt_enclosure_of(const struct dt *t, uint32_t number, struct dt_enclosure *out);

/* ---- rows of DT_TRIANGLES ---- */

/* Turns the corners of a triangle so that the smallest id comes first. */
static inline void dt_triangle_turn(uint32_t row[3])
{
    while (row[0] > row[1] || row[0] > row[2]) {
        uint32_t first = row[0];
        row[0] = row[1];
        row[1] = row[2];
        row[2] = first;
    }
}

/* Returns 0, 1 or 2: which of three ids is the least; *least is that id. There is no branch, which would be unpredictable. */
static inline uint32_t dt_least_of_three(uint32_t a, uint32_t b, uint32_t c, uint32_t *least)
{
    uint32_t at_b = b < a, two = a ^ ((a ^ b) & (0 - at_b)), at_c = c < two;
    *least = two ^ ((two ^ c) & (0 - at_c));
    return (at_b & (at_c - 1)) | at_c << 1;
}

/* The corners of the triangle of the half edge h. */
void dt_triangle_ids(const struct dt *t, uint32_t h, bool cw, uint32_t row[3]);

/* For qsort: < 0 if row a comes before row b. */
int dt_triangle_compare(const void *a, const void *b);

/* Whether the triangle of half edge h comes before that of g. */
bool dt_triangle_precedes(const struct dt *t, uint32_t h, uint32_t g);

/* For a search from star to star that walks round the origin of h: fetches the triangle beyond the edge
 * opposite to it, which the stars of two neighbours share. */
static inline void dt_fetch_beyond_star(const struct dt_mesh *m, uint32_t h)
{
    dt_fetch(&m->half[dt_base(dt_twin(m, dt_next(h)))]);
}

/* Replaces the vertices list->v[from .. n - 1], which are distinct, by their ids in ascending order.
 * Cost: linear. */
void dt_vertices_to_ids(const struct dt *t, struct dt_ids *list, size_t from);

struct dt_neighbours;

/* dt_nearest_many of one place q, at the moment of v, which is readable: appends up to k ids. `from` was a vertex, best
 * one near q; DT_NONE: there was none. around: the star of that moment that was read last, if one was. */
enum dt_status dt_nearest_then(const struct dt *t, const struct dt_view *v, struct dt_point q,
                               uint32_t from, uint32_t k, struct dt_stop *work,
                               struct dt_neighbours *around, struct dt_ids *out);
