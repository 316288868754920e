/* aliases.c - doubly linked groups in two arrays with free lists; see aliases.h. */
#include "core/aliases.h"

#include <string.h>

#include "core/memory.h"

void dt_aliases_init(struct dt_aliases *a, struct dt_pages *pages)
{
    *a = (struct dt_aliases){.pages = pages, .free_alias = DT_NONE, .free_group = DT_NONE};
}

void dt_aliases_clear(struct dt_aliases *a)
{
    dt_array_free(a->alias);
    dt_array_free(a->group);
    dt_idmap_clear(&a->group_of);
    dt_aliases_init(a, a->pages);
}

enum dt_status dt_aliases_copy(const struct dt_aliases *a, struct dt_aliases *copy)
{
    dt_aliases_init(copy, a->pages);
    if (a->cap == 0)
        return DT_OK;
    struct dt_alias *alias = dt_array_new_in(a->pages, a->cap, sizeof *alias);
    struct dt_alias_group *group = dt_array_new_in(a->pages, a->cap, sizeof *group);
    struct dt_idmap group_of = {0};
    if (alias == NULL || group == NULL || dt_idmap_copy(&a->group_of, &group_of) != DT_OK) {
        dt_array_free(alias);
        dt_array_free(group);
        return DT_NOMEM;
    }
    memcpy(alias, a->alias, a->end * sizeof *alias);
    memcpy(group, a->group, a->groups * sizeof *group);
    *copy = *a;
    copy->alias = alias;
    copy->group = group;
    copy->group_of = group_of;
    copy->changes = NULL;
    return DT_OK;
}

size_t dt_aliases_memory(const struct dt_aliases *a)
{
    return a->cap * (sizeof *a->alias + sizeof *a->group) + dt_idmap_memory(&a->group_of);
}

enum dt_status dt_aliases_reserve(struct dt_aliases *a, uint32_t representative)
{
    if (a->count == a->cap) {
        size_t cap = dt_array_room(a->cap, (size_t)a->count + 1, DT_MAX_POINTS);
        void *alias = dt_array_grow_in(a->pages, a->alias, a->end, cap, sizeof *a->alias);
        if (alias == NULL)
            return DT_NOMEM;
        a->alias = alias;
        void *group = dt_array_grow_in(a->pages, a->group, a->groups, cap, sizeof *a->group);
        if (group == NULL)
            return DT_NOMEM;
        a->group = group;
        a->cap = (uint32_t)cap;
    }
    return dt_idmap_reserve(&a->group_of, representative, 1);
}

static uint32_t new_group(struct dt_aliases *a, uint32_t representative)
{
    uint32_t g = a->free_group;
    if (g != DT_NONE) {
        a->free_group = a->group[g].head;
        dt_changes_family(a->changes, g);
    } else {
        g = a->groups++;
    }
    a->group[g] = (struct dt_alias_group){representative, DT_NONE, DT_NONE};
    dt_idmap_set(&a->group_of, representative, g);
    return g;
}

/* Links alias i into its group behind `prev`, DT_NONE for the front. */
static void link_behind(struct dt_aliases *a, uint32_t i, uint32_t prev)
{
    struct dt_alias_group *g = a->group + a->alias[i].group;
    uint32_t next = prev == DT_NONE ? g->head : a->alias[prev].next;
    a->alias[i].prev = prev;
    a->alias[i].next = next;
    *(prev == DT_NONE ? &g->head : &a->alias[prev].next) = i;
    *(next == DT_NONE ? &g->tail : &a->alias[next].prev) = i;
}

uint32_t dt_aliases_join(struct dt_aliases *a, uint32_t representative, uint32_t id,
                         struct dt_point xy)
{
    uint32_t g = dt_idmap_get(&a->group_of, representative);
    if (g == DT_NONE)
        g = new_group(a, representative);
    uint32_t i = a->free_alias;
    if (i != DT_NONE)
        a->free_alias = a->alias[i].next;
    else
        i = a->end++;
    a->count++;
    a->alias[i] = (struct dt_alias){.xy = xy, .id = id, .group = g};

    uint32_t head = a->group[g].head, prev = a->group[g].tail;
    if (head != DT_NONE && id < a->alias[head].id)
        prev = DT_NONE;
    while (prev != DT_NONE && a->alias[prev].id > id)
        prev = a->alias[prev].prev;
    link_behind(a, i, prev);
    return i;
}

void dt_aliases_leave(struct dt_aliases *a, uint32_t index)
{
    struct dt_alias *x = a->alias + index;
    struct dt_alias_group *g = a->group + x->group;
    *(x->prev == DT_NONE ? &g->head : &a->alias[x->prev].next) = x->next;
    *(x->next == DT_NONE ? &g->tail : &a->alias[x->next].prev) = x->prev;
    if (g->head == DT_NONE) {
        dt_idmap_unset(&a->group_of, g->representative);
        g->head = a->free_group;
        a->free_group = x->group;
    }
    x->next = a->free_alias;
    a->free_alias = index;
    a->count--;
}

uint32_t dt_aliases_lowest(const struct dt_aliases *a, uint32_t representative)
{
    uint32_t g = dt_idmap_get(&a->group_of, representative);
    return g == DT_NONE ? DT_NONE : a->group[g].head;
}

void dt_aliases_rename(struct dt_aliases *a, uint32_t from, uint32_t to)
{
    uint32_t g = dt_idmap_get(&a->group_of, from);
    if (g == DT_NONE)
        return;
    dt_changes_family(a->changes, g);
    dt_idmap_unset(&a->group_of, from);
    dt_idmap_set(&a->group_of, to, g);
    a->group[g].representative = to;
}
