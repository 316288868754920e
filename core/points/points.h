/* points.h - the points of a set: coordinates by vertex, ids by vertex, vertices by id, and the
 * aliases.
 *
 * A vertex number is the place of a representative in the arrays xy and id, which the mesh shares. Vertices
 * are in order of arrival at first, and in grid order once triangulated, so that neighbours in the plane are
 * neighbours in memory. Ids are the caller's numbers and never change. Aliases are no vertices;
 * they live in a table of their own. */
#pragma once

#include "core/control/stop.h"
#include "core/points/aliases.h"
#include "core/points/changes.h"
#include "core/points/idmap.h"
#include "core/points/places.h"

/* In a value of `value`: the rest is an index of aliases, not a vertex. */
#define DT_ALIAS_BIT (1u << 31)

struct dt_points {
    struct dt_pages *pages; /* borrows; where large arrays come from; NULL: the system */
    struct dt_point *xy;    /* owns cap, by vertex */
    uint32_t *id;      /* owns cap, by vertex: the representative's id; DT_NONE for a free vertex */
    uint32_t end, cap; /* vertices 0 .. end - 1 are in use or free */
    uint32_t free_count; /* how many of them are free */
    uint32_t free_list;  /* a free vertex, DT_NONE if none; its xy.x holds the next one */
    uint32_t next_id;    /* ids handed out so far are 0 .. next_id - 1 */
    double tol;
    struct dt_idmap value; /* id -> vertex, or DT_ALIAS_BIT | index */
    struct dt_aliases aliases;
    uint32_t *group; /* owns group_cap, by vertex: the root of its aliases, DT_NONE if it has none;
                           NULL: there has never been an alias */
    uint32_t group_cap;      /* at least cap, or 0 */
    struct dt_places places; /* finds a representative by its place; built when first needed */
    /* owns one for each vertex: the steps of a build (plan.h), for which the vertices are sorted; NULL: none */
    uint16_t *plan;
    const struct dt_changes *changes; /* borrows; notified of changes; NULL: not needed */
};

void dt_points_init(struct dt_points *p, double tol, struct dt_pages *pages);
void dt_points_clear(struct dt_points *p);
enum dt_status dt_points_copy(const struct dt_points *p, struct dt_points *copy,
                              struct dt_stop *stop);
size_t dt_points_memory(const struct dt_points *p);

/* To be called before a vertex comes, goes or moves: the plan is out of date. */
void dt_points_unplan(struct dt_points *p);

/* Representatives = vertices in use. */
static inline uint32_t dt_points_vertices(const struct dt_points *p)
{
    return p->end - p->free_count;
}

static inline uint32_t dt_points_live(const struct dt_points *p)
{
    return dt_points_vertices(p) + p->aliases.count;
}

/* The vertex of id's representative; DT_NONE if there is no such id. Cost: as dt_aliases_root. */
static inline uint32_t dt_points_vertex(const struct dt_points *p, uint32_t id)
{
    uint32_t v = dt_idmap_get(&p->value, id);
    if (v == DT_NONE || !(v & DT_ALIAS_BIT))
        return v;
    return dt_idmap_get(&p->value, dt_aliases_representative(&p->aliases, v & ~DT_ALIAS_BIT));
}

/* Whether the live id is an alias. */
static inline bool dt_points_is_alias(const struct dt_points *p, uint32_t id)
{
    return (dt_idmap_get(&p->value, id) & DT_ALIAS_BIT) != 0;
}

/* The smallest live id that is >= id, DT_NONE if there is none. */
static inline uint32_t dt_points_next_live(const struct dt_points *p, uint32_t id)
{
    return dt_idmap_next(&p->value, id);
}

/* Fetches the coordinates of a live id. */
static inline void dt_points_fetch(const struct dt_points *p, uint32_t id)
{
    uint32_t v = dt_idmap_get(&p->value, id);
    dt_fetch(v & DT_ALIAS_BIT ? (const void *)&p->aliases.alias[v & ~DT_ALIAS_BIT] : &p->xy[v]);
}

/* The coordinates of a live id. */
struct dt_point dt_points_xy(const struct dt_points *p, uint32_t id);

/* A function with a parameter `work` (stop.h) takes its steps off it; NULL: no end. */

/* Adding n valid points: room for them, or for their ids alone; then for each id from next_id on, in any order but with
 * coincident points ascending, either dt_points_enter or dt_points_join; then dt_points_arrived. dt_points_take_back
 * undoes what was done before dt_points_arrived; none of these points may have been taken over. */
enum dt_status dt_points_reserve(struct dt_points *p, size_t n, struct dt_stop *work);
enum dt_status dt_points_reserve_ids(struct dt_points *p, size_t n);
uint32_t dt_points_enter(struct dt_points *p, uint32_t id,
                         struct dt_point q); /* returns its vertex */
enum dt_status dt_points_join(struct dt_points *p, uint32_t id, struct dt_point q, uint32_t v);
void dt_points_arrived(struct dt_points *p, uint32_t n);
void dt_points_take_back(struct dt_points *p, uint32_t n);

/* Makes the deletion of n distinct live ids, in ascending order, by dt_points_delete_all certain to
 * succeed. */
enum dt_status dt_points_delete_ready(struct dt_points *p, const uint32_t *ids, size_t n,
                                      struct dt_stop *work);

/* Deletes a live id. If it is a representative that has aliases, the lowest alias takes over its vertex. With a
 * tolerance, another representative may be at exactly that alias's place. Then the two groups become one, represented
 * by the smaller id, and the vertex is free. */
void dt_points_delete(struct dt_points *p, uint32_t id);

/* Deletes n distinct live ids, in ascending order: aliases first, so that each group has one successor. If it
 * is stopped, only some of them; stop may be NULL. */
void dt_points_delete_all(struct dt_points *p, const uint32_t *ids, size_t n, struct dt_stop *stop);

/* The alias with that index leaves its group. */
void dt_points_leave_group(struct dt_points *p, uint32_t index);

/* Vertex v moves to a place where there is no other. */
void dt_points_shift(struct dt_points *p, uint32_t v, struct dt_point to);

/* The alias that will take over vertex v if its representative goes, and with it all of the n ids,
 * which are ascending; NULL if there is none. */
const struct dt_alias *dt_points_heir(const struct dt_points *p, uint32_t v, const uint32_t *ids,
                                      size_t n);

/* Moving a live id: dt_points_move_ready makes the others certain to succeed. Then the point leaves,
 * by dt_points_delete, and arrives: at vertex `at`, with which it coincides, or, if that is DT_NONE,
 * at a vertex of its own, which is returned; DT_NONE is returned if no vertex came. */
enum dt_status dt_points_move_ready(struct dt_points *p, uint32_t id, struct dt_stop *work);
uint32_t dt_points_arrive(struct dt_points *p, uint32_t id, struct dt_point to, uint32_t at);

/* The vertex that a point at q coincides with, `except` left out; DT_NONE if there is none. The
 * first call after dt_points_renumber needs dt_points_index, O(n). */
enum dt_status dt_points_index(struct dt_points *p, struct dt_stop *work);
uint32_t dt_points_find(const struct dt_points *p, struct dt_point q, uint32_t except);

/* Renumbers the vertices, in a dense order without free ones: vertex v represents the point (*id)[v] at (*xy)[v]. There
 * may be new ids, which are reserved. Exchanges these arrays for those of *p. DT_NOMEM, DT_CANCELLED: nothing is
 * exchanged; *p is unchanged or, if it is disposable, must be freed. If opt is NULL, it cannot fail unless there
 * are more vertices than ever before. Cost: linear. */
enum dt_status dt_points_renumber(struct dt_points *p, struct dt_point **xy, uint32_t **id,
                                  uint32_t n, const struct dt_options *opt);
