/* aliases.h - the points that coincide with a representative, in groups.
 *
 * Two questions are asked: who represents an alias, and which alias of a representative has the lowest
 * id. A group answers both in logarithmic time, however large it is, while aliases join and leave in any
 * order and groups become one.
 *
 *     group     5 <---- 2 <---- 7        a group that has become part of another one points to it; the
 *               ^                        root, 5, has the representative. Union by rank without path
 *               '------ 4                compression [Tarjan 1975], so that readers change nothing, and
 *                                        a group that is no root never changes
 *     aliases   each names the group that it joined: 5, 2, 7 or 4
 *
 *     heap      those of one root are a leftist heap by id [Crane 1972; Knuth, TAOCP 3, sec. 5.2.3], with
 *               links to the parents, so that any of them can leave
 *
 * A group without references is free. Knows ids and coordinates only: which id is an alias, and
 * which representative has a group, is the business of points.c. */
#pragma once

#include "core/control/stop.h"
#include "core/delaunay.h"
#include "core/memory/memory.h"
#include "core/points/changes.h"

struct dt_alias {
    struct dt_point xy;
    uint32_t id;
    uint32_t group;               /* that it joined */
    uint32_t parent, left, right; /* in the heap, DT_NONE if none; left also links the free ones */
    uint32_t rank; /* in the heap: how far away the nearest node with a child missing is */
};

struct dt_alias_group {
    uint32_t up; /* the group that it is part of; DT_NONE: it is a root; also links the free ones */
    uint32_t representative; /* of a root: its id */
    uint32_t lowest;         /* of a root: the top of the heap */
    uint32_t named;          /* by how many aliases and groups; 0: it is free */
    uint32_t rank;           /* at least the height of the tree below */
};

struct dt_aliases {
    struct dt_pages *pages;       /* borrows; where its arrays come from; NULL: the system */
    struct dt_alias *alias;       /* owns cap; 0 .. end - 1 are in use or free */
    struct dt_alias_group *group; /* owns group_cap; 0 .. groups - 1 are in use or free */
    uint32_t cap, end, count;
    uint32_t group_cap, groups;
    uint32_t free_alias, free_group;  /* heads of the free lists */
    const struct dt_changes *changes; /* borrows: who is to know that a group changes */
};

void dt_aliases_init(struct dt_aliases *a, struct dt_pages *pages);
void dt_aliases_clear(struct dt_aliases *a);
enum dt_status dt_aliases_copy(const struct dt_aliases *a, struct dt_aliases *copy,
                               struct dt_stop *stop);
size_t dt_aliases_memory(const struct dt_aliases *a);

/* Makes room for one more alias and one more group. */
enum dt_status dt_aliases_reserve(struct dt_aliases *a);

/* A new group, for which there is room. It is free again when its last alias has left. */
uint32_t dt_aliases_new_group(struct dt_aliases *a, uint32_t representative);

/* Whether the group, which may be a free one, is one and a root. */
static inline bool dt_aliases_is_root(const struct dt_aliases *a, uint32_t group)
{
    return a->group[group].up == DT_NONE && a->group[group].named > 0;
}

/* The root of a group. Cost: at most logarithmic in the number of groups that it was made of. */
static inline uint32_t dt_aliases_root(const struct dt_aliases *a, uint32_t group)
{
    while (a->group[group].up != DT_NONE)
        group = a->group[group].up;
    return group;
}

/* The representative of the alias with that index. */
static inline uint32_t dt_aliases_representative(const struct dt_aliases *a, uint32_t index)
{
    return a->group[dt_aliases_root(a, a->alias[index].group)].representative;
}

/* Another id represents the root. */
static inline void dt_aliases_rename(struct dt_aliases *a, uint32_t root, uint32_t representative)
{
    dt_changes_family(a->changes, root);
    a->group[root].representative = representative;
}

/* Adds an alias, for which there is room, to a root and returns its index. Cost: logarithmic. */
uint32_t dt_aliases_join(struct dt_aliases *a, uint32_t root, uint32_t id, struct dt_point xy);

/* Removes the alias with that index. If it was the last one of its group, that is free, and the
 * representative that had it is returned, else DT_NONE. Cost: logarithmic. */
uint32_t dt_aliases_leave(struct dt_aliases *a, uint32_t index);

/* Two roots become one, which is returned; it is represented as `into` was. Cost: logarithmic. */
uint32_t dt_aliases_unite(struct dt_aliases *a, uint32_t from, uint32_t into);

/* The lowest alias of the root that is not among the n ascending ids; DT_NONE if there is none. Cost: O(1 + the
 * number of the root's aliases that are among them). */
uint32_t dt_aliases_lowest_but(const struct dt_aliases *a, uint32_t root, const uint32_t *ids,
                               size_t n);
