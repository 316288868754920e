/* aliases.c - see aliases.h. */
#include "core/points/aliases.h"

#include "core/memory/sort.h"

void dt_aliases_init(struct dt_aliases *a, struct dt_pages *pages)
{
    *a = (struct dt_aliases){.pages = pages, .free_alias = DT_NONE, .free_group = DT_NONE};
}

void dt_aliases_clear(struct dt_aliases *a)
{
    dt_array_free(a->alias);
    dt_array_free(a->group);
    dt_aliases_init(a, a->pages);
}

enum dt_status dt_aliases_copy(const struct dt_aliases *a, struct dt_aliases *copy,
                               struct dt_stop *stop)
{
    dt_aliases_init(copy, a->pages);
    if (a->cap == 0)
        return DT_OK;
    struct dt_alias *alias = dt_array_new_in(a->pages, a->cap, sizeof *alias);
    struct dt_alias_group *group = dt_array_new_in(a->pages, a->group_cap, sizeof *group);
    if (alias == NULL || group == NULL) {
        dt_array_free(alias);
        dt_array_free(group);
        return DT_NOMEM;
    }
    dt_copy(alias, a->alias, a->end, sizeof *alias, stop);
    dt_copy(group, a->group, a->groups, sizeof *group, stop);
    *copy = *a;
    copy->alias = alias;
    copy->group = group;
    copy->changes = NULL;
    return DT_OK;
}

size_t dt_aliases_memory(const struct dt_aliases *a)
{
    return a->cap * sizeof *a->alias + a->group_cap * sizeof *a->group;
}

/* Makes room for one item more in an array of which `end` are in use. `array` points to the pointer to the
 * array, which may have any type. */
static enum dt_status grow(struct dt_aliases *a, void *array, uint32_t end, uint32_t *cap,
                           size_t size)
{
    if (end < *cap)
        return DT_OK;
    size_t room = dt_array_room(*cap, (size_t)end + 1, UINT32_MAX);
    if (!dt_array_resize(a->pages, array, end, room, size))
        return DT_NOMEM;
    *cap = (uint32_t)room;
    return DT_OK;
}

enum dt_status dt_aliases_reserve(struct dt_aliases *a)
{
    enum dt_status status = DT_OK;
    if (a->free_alias == DT_NONE)
        status = grow(a, &a->alias, a->end, &a->cap, sizeof *a->alias);
    if (status == DT_OK && a->free_group == DT_NONE)
        status = grow(a, &a->group, a->groups, &a->group_cap, sizeof *a->group);
    return status;
}

/* ---- groups ---- */

uint32_t dt_aliases_new_group(struct dt_aliases *a, uint32_t representative)
{
    uint32_t g = a->free_group;
    if (g != DT_NONE)
        a->free_group = a->group[g].up;
    else
        g = a->groups++;
    a->group[g] =
        (struct dt_alias_group){.up = DT_NONE, .representative = representative, .lowest = DT_NONE};
    return g;
}

/* Removes one reference from the group. A group without references becomes free, which removes one from its
 * parent, and so on. Returns the representative of a root that is free, else DT_NONE. */
static uint32_t unname(struct dt_aliases *a, uint32_t g)
{
    uint32_t representative = DT_NONE;
    while (g != DT_NONE && --a->group[g].named == 0) {
        uint32_t up = a->group[g].up;
        dt_changes_family(a->changes, g);
        if (up == DT_NONE)
            representative = a->group[g].representative;
        a->group[g].up = a->free_group;
        a->free_group = g;
        g = up;
    }
    return representative;
}

/* ---- heaps ---- */

static uint32_t rank_of(const struct dt_aliases *a, uint32_t i)
{
    return i == DT_NONE ? 0 : a->alias[i].rank;
}

/* Makes the child with the larger rank the left one; returns whether the rank of i has changed. */
static bool balance(struct dt_aliases *a, uint32_t i)
{
    struct dt_alias *x = &a->alias[i];
    uint32_t before = x->rank;
    if (rank_of(a, x->left) < rank_of(a, x->right)) {
        uint32_t left = x->left;
        x->left = x->right;
        x->right = left;
    }
    x->rank = rank_of(a, x->right) + 1;
    return x->rank != before;
}

/* i, which may be DT_NONE, becomes the right child of `parent`; DT_NONE: a top. */
static void hang_right(struct dt_aliases *a, uint32_t i, uint32_t parent)
{
    if (i != DT_NONE)
        a->alias[i].parent = parent;
    if (parent != DT_NONE)
        a->alias[parent].right = i;
}

/* Merges the right spines of two heaps, whose ranks are at most logarithmic, and returns the top. */
static uint32_t meld(struct dt_aliases *a, uint32_t x, uint32_t y)
{
    uint32_t top = DT_NONE, last = DT_NONE;
    while (x != DT_NONE && y != DT_NONE) {
        bool swap = a->alias[y].id < a->alias[x].id;
        uint32_t next = swap ? y : x;
        y = swap ? x : y;
        hang_right(a, next, last);
        top = top == DT_NONE ? next : top;
        last = next;
        x = a->alias[next].right;
    }
    x = x == DT_NONE ? y : x;
    hang_right(a, x, last);
    while (last != DT_NONE) {
        balance(a, last);
        last = a->alias[last].parent;
    }
    return top == DT_NONE ? x : top;
}

/* Removes i from its heap, the top of which is *top. */
static void take_out(struct dt_aliases *a, uint32_t i, uint32_t *top)
{
    uint32_t parent = a->alias[i].parent, rest = meld(a, a->alias[i].left, a->alias[i].right);
    if (rest != DT_NONE)
        a->alias[rest].parent = parent;
    if (parent == DT_NONE)
        *top = rest;
    else if (a->alias[parent].left == i)
        a->alias[parent].left = rest;
    else
        a->alias[parent].right = rest;
    while (parent != DT_NONE && balance(a, parent))
        parent = a->alias[parent].parent;
}

/* ---- both ---- */

uint32_t dt_aliases_join(struct dt_aliases *a, uint32_t root, uint32_t id, struct dt_point xy)
{
    uint32_t i = a->free_alias;
    if (i != DT_NONE)
        a->free_alias = a->alias[i].left;
    else
        i = a->end++;
    a->alias[i] = (struct dt_alias){.xy = xy,
                                    .id = id,
                                    .group = root,
                                    .parent = DT_NONE,
                                    .left = DT_NONE,
                                    .right = DT_NONE,
                                    .rank = 1};
    a->group[root].lowest = meld(a, a->group[root].lowest, i);
    a->group[root].named++;
    a->count++;
    return i;
}

uint32_t dt_aliases_leave(struct dt_aliases *a, uint32_t index)
{
    uint32_t group = a->alias[index].group;
    take_out(a, index, &a->group[dt_aliases_root(a, group)].lowest);
    a->alias[index].left = a->free_alias;
    a->free_alias = index;
    a->count--;
    return unname(a, group);
}

uint32_t dt_aliases_unite(struct dt_aliases *a, uint32_t from, uint32_t into)
{
    struct dt_alias_group *f = &a->group[from], *t = &a->group[into];
    uint32_t representative = t->representative, lowest = meld(a, f->lowest, t->lowest);
    bool upwards = f->rank > t->rank; /* `into` becomes part of `from` */
    uint32_t root = upwards ? from : into, part = upwards ? into : from;
    dt_changes_family(a->changes, part);
    if (upwards)
        dt_changes_family(a->changes, root);
    a->group[root].rank += f->rank == t->rank;
    a->group[root].representative = representative;
    a->group[root].lowest = lowest;
    a->group[root].named++;
    a->group[part].up = root;
    return root;
}

/* The next node of the heap in preorder that is not below i, DT_NONE if there is none. */
static uint32_t beside(const struct dt_aliases *a, uint32_t i)
{
    for (uint32_t parent; (parent = a->alias[i].parent) != DT_NONE; i = parent)
        if (a->alias[parent].left == i && a->alias[parent].right != DT_NONE)
            return a->alias[parent].right;
    return DT_NONE;
}

uint32_t dt_aliases_lowest_but(const struct dt_aliases *a, uint32_t root, const uint32_t *ids,
                               size_t n)
{
    uint32_t best = DT_NONE, i = a->group[root].lowest;
    while (i != DT_NONE) {
        const struct dt_alias *x = &a->alias[i];
        bool left_out = dt_sorted_have(ids, n, x->id);
        if (!left_out && (best == DT_NONE || x->id < a->alias[best].id))
            best = i;
        i = left_out && x->left != DT_NONE ? x->left : beside(a, i);
    }
    return best;
}
