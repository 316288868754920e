/* changes.h - what an edit is about to change, reported just before it does.
 *
 * For code that keeps earlier states of a set, or needs to know what an edit touches. A callback is called for each
 * thing that is about to change, possibly more than once in an edit. */
#pragma once

#include <stddef.h>
#include <stdint.h>

struct dt_changes {
    /* The row of a live id: its place, whether it is an alias, its life. */
    void (*row)(void *ctx, uint32_t id);
    /* The representative of a group of aliases, or the group that it is part of. */
    void (*family)(void *ctx, uint32_t group);
    /* The neighbours of a vertex of the mesh. */
    void (*star)(void *ctx, uint32_t v);
    /* The id of a vertex, which may be one of the mesh. */
    void (*name)(void *ctx, uint32_t v);
    void *ctx;
};

/* NULL: not needed. */
static inline void dt_changes_row(const struct dt_changes *w, uint32_t id)
{
    if (w != NULL)
        w->row(w->ctx, id);
}

static inline void dt_changes_family(const struct dt_changes *w, uint32_t group)
{
    if (w != NULL)
        w->family(w->ctx, group);
}

static inline void dt_changes_star(const struct dt_changes *w, uint32_t v)
{
    if (w != NULL)
        w->star(w->ctx, v);
}

static inline void dt_changes_name(const struct dt_changes *w, uint32_t v)
{
    if (w != NULL)
        w->name(w->ctx, v);
}
