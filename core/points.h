/* points.h - the points of a set: coordinates by vertex, ids by vertex, vertices by id, and the aliases.
 *
 * A vertex number is the place of a representative in the arrays xy and id, which the mesh shares: in order of arrival
 * at first, in grid order once triangulated, so that neighbours in the plane are neighbours in memory. Ids are the
 * caller's numbers and never change. Aliases are no vertices; they live in a table of their own. */
#ifndef DT_POINTS_H
#define DT_POINTS_H

#include "core/delaunay.h"

struct dt_points {
    struct dt_point *xy; /* owns, by vertex */
    uint32_t *id;        /* owns, by vertex: the representative's id; DT_NONE for a free vertex */
    uint32_t end, cap;   /* vertices 0 .. end - 1 are in use or free */
    uint32_t free_count; /* how many of them are free */
    uint32_t free_list;  /* a free vertex; DT_NONE if none */
    uint32_t next_id;    /* ids handed out so far are 0 .. next_id - 1 */
    uint32_t aliases;    /* how many live ids are aliases */
    double tol;
    struct dt_id_pages *pages;      /* owns: id -> vertex or alias */
    struct dt_alias_table *alias;   /* owns; NULL while there is none */
    struct dt_coincidence *places;  /* owns: finds a representative by its place */
};

/* Representatives = vertices in use. */
static inline uint32_t dt_points_vertices(const struct dt_points *p)
{
    return p->end - p->free_count;
}

/* The vertex of id's representative; DT_NONE if there is no such id. Cost: constant. */
uint32_t dt_points_vertex(const struct dt_points *p, uint32_t id);

/* Whether the live id is an alias. */
bool dt_points_is_alias(const struct dt_points *p, uint32_t id);

/* The smallest live id that is >= id, DT_NONE if there is none. Cost: amortised constant over an ascending scan. */
uint32_t dt_points_next_live(const struct dt_points *p, uint32_t id);

#endif
