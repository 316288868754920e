/* aliases.h - the points that coincide with a representative, grouped by it, each group in
 * ascending order of ids.
 *
 * Knows ids and coordinates only; which id is an alias at all is the business of points.c. */
#ifndef DT_ALIASES_H
#define DT_ALIASES_H

#include "core/changes.h"
#include "core/idmap.h"

struct dt_alias {
    struct dt_point xy;
    uint32_t id;
    uint32_t group;
    uint32_t prev, next; /* in the group, by id; next also links the free ones */
};

struct dt_alias_group {
    uint32_t representative; /* its id */
    uint32_t head, tail;     /* lowest and highest alias; head also links the free groups */
};

struct dt_aliases {
    struct dt_pages *pages;       /* borrows; where its arrays come from; NULL: the system */
    struct dt_alias *alias;       /* owns cap; 0 .. end - 1 are in use or free */
    struct dt_alias_group *group; /* owns cap; 0 .. groups - 1 are in use or free */
    uint32_t cap, end, groups, count;
    uint32_t free_alias, free_group;  /* heads of the free lists */
    struct dt_idmap group_of;         /* id of a representative that has aliases -> group */
    const struct dt_changes *changes; /* borrows: who is to know of a group's representative */
};

void dt_aliases_init(struct dt_aliases *a, struct dt_pages *pages);
void dt_aliases_clear(struct dt_aliases *a);
enum dt_status dt_aliases_copy(const struct dt_aliases *a, struct dt_aliases *copy);
size_t dt_aliases_memory(const struct dt_aliases *a);

/* Makes room for one more alias of `representative`, so that the next join or rename to it cannot
 * fail. */
enum dt_status dt_aliases_reserve(struct dt_aliases *a, uint32_t representative);

/* Fetches what dt_aliases_join to `representative` will read. */
static inline void dt_aliases_fetch(const struct dt_aliases *a, uint32_t representative)
{
    uint32_t g = dt_idmap_get(&a->group_of, representative);
    if (g != DT_NONE)
        dt_fetch(&a->group[g]);
}

/* Adds an alias and returns its index. Cost: constant if id is higher or lower than all others of
 * the group, else linear in the group. */
uint32_t dt_aliases_join(struct dt_aliases *a, uint32_t representative, uint32_t id,
                         struct dt_point xy);

/* Removes the alias with that index. Cost: constant. */
void dt_aliases_leave(struct dt_aliases *a, uint32_t index);

/* The index of the representative's lowest alias; DT_NONE if it has none. */
uint32_t dt_aliases_lowest(const struct dt_aliases *a, uint32_t representative);

/* The aliases of `from`, if any, become those of `to`, for which room was reserved and which has
 * none. */
void dt_aliases_rename(struct dt_aliases *a, uint32_t from, uint32_t to);

static inline uint32_t dt_aliases_representative(const struct dt_aliases *a, uint32_t index)
{
    return a->group[a->alias[index].group].representative;
}

#endif
