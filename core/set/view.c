/* view.c - the list of views; see view.h.
 *
 * Views may end while an edit is under way, and begin beside each other, and no thread waits for another. So views that begin
 * are pushed to the list, and those that end to a stack. Edits, which have exclusive access to the set except for views
 * that end, enter the new ones and take the ended ones out:
 *
 *      newest -> v9 -> v8 -> v7 -> v5 -> v2        pushed: v9, v8. An edit enters them: it links them backwards, too.
 *                       <--------------- oldest    Each has the moment of the one before or a later one.
 *
 * So only two views determine the moments that are read: the oldest and the newest, among all views and among views with
 * rings. */
#include "core/set/view.h"

#include <stdlib.h>

enum { AT_ONCE = 4 }; /* chunks of all kinds that an edit frees */

/* ---- life ---- */

struct dt_view *dt_views_begin(struct dt_views *w)
{
    struct dt_view *v = calloc(1, sizeof *v);
    if (v == NULL)
        return NULL;
    v->home = w;
    v->serial = atomic_fetch_add(&w->serial, 1) + 1;
    for (int kind = 0; kind < DT_IMAGE_KINDS; kind++)
        v->moment[kind] = dt_images_now(&w->images[kind]);
    return v;
}

void dt_views_open(struct dt_views *w, struct dt_view *v)
{
    atomic_store(&v->counted, v->with_rings);
    if (v->with_rings)
        atomic_fetch_add(&w->rings, 1);
    v->older = atomic_load(&w->newest);
    while (!atomic_compare_exchange_weak(&w->newest, &v->older, v))
        ;
}

/* It does not read the triangulation any more. */
static void discount(struct dt_view *v)
{
    if (atomic_exchange(&v->counted, false))
        atomic_fetch_sub(&v->home->rings, 1);
}

void dt_view_end(struct dt_view *v)
{
    if (v == NULL)
        return;
    struct dt_views *w = v->home;
    discount(v);
    v->next_ended = atomic_load(&w->ended);
    while (!atomic_compare_exchange_weak(&w->ended, &v->next_ended, v))
        ;
}

/* ---- by edits ---- */

/* Links the views that have begun since the last call. */
static void enter_new(struct dt_views *w)
{
    struct dt_view *newer = NULL, *newest_ring = NULL, *newer_ring = NULL,
                   *v = atomic_load(&w->newest);
    for (; v != NULL && !v->entered; v = v->older) {
        v->entered = true;
        v->newer = newer;
        newer = v;
        if (!v->with_rings)
            continue;
        v->newer_ring = newer_ring;
        if (newer_ring != NULL)
            newer_ring->older_ring = v;
        else
            newest_ring = v;
        newer_ring = v;
    }
    if (v != NULL)
        v->newer = newer;
    else if (newer != NULL)
        w->oldest = newer;
    if (newer_ring == NULL)
        return;
    newer_ring->older_ring = w->newest_ring;
    if (w->newest_ring != NULL)
        w->newest_ring->newer_ring = newer_ring;
    else
        w->oldest_ring = newer_ring;
    w->newest_ring = newest_ring;
}

static void leave_rings(struct dt_views *w, const struct dt_view *v)
{
    if (v->newer_ring != NULL)
        v->newer_ring->older_ring = v->older_ring;
    else
        w->newest_ring = v->older_ring;
    if (v->older_ring != NULL)
        v->older_ring->newer_ring = v->newer_ring;
    else
        w->oldest_ring = v->newer_ring;
}

static void leave(struct dt_views *w, struct dt_view *v)
{
    if (v->with_rings)
        leave_rings(w, v);
    if (v->newer != NULL)
        v->newer->older = v->older;
    else
        atomic_store(&w->newest, v->older);
    if (v->older != NULL)
        v->older->newer = v->newer;
    else
        w->oldest = v->newer;
}

static void free_ended(struct dt_views *w)
{
    struct dt_view *v = atomic_exchange(&w->ended, NULL), *next;
    for (; v != NULL; v = next) {
        next = v->next_ended;
        leave(w, v);
        free(v);
    }
}

void dt_views_clear(struct dt_views *w)
{
    for (struct dt_view *v = atomic_load(&w->newest), *older; v != NULL; v = older) {
        older = v->older;
        free(v);
    }
    for (int kind = 0; kind < DT_IMAGE_KINDS; kind++)
        dt_images_clear(&w->images[kind]);
}

size_t dt_views_memory(const struct dt_views *w)
{
    size_t bytes = 0;
    for (int kind = 0; kind < DT_IMAGE_KINDS; kind++)
        bytes += dt_images_memory(&w->images[kind]);
    return bytes;
}

bool dt_views_are_empty(const struct dt_views *w)
{
    bool empty = true;
    for (int kind = 0; kind < DT_IMAGE_KINDS; kind++)
        empty = empty && dt_images_is_empty(&w->images[kind]);
    return empty;
}

uint32_t dt_view_next_id(const struct dt_view *v)
{
    return v->next_id;
}

void dt_view_summary(const struct dt_view *v, struct dt_summary *out)
{
    *out = v->sum;
}

/* ---- what is read, and what is lost ---- */

bool dt_views_read_rings(const struct dt_views *w)
{
    return atomic_load(&w->rings) > 0;
}

static void discount_all(struct dt_views *w)
{
    for (struct dt_view *v = atomic_load(&w->newest); v != NULL; v = v->older)
        discount(v);
}

void dt_views_lose_rings(struct dt_views *w)
{
    discount_all(w);
    w->rings_lost = atomic_load(&w->serial);
    w->read[DT_IMAGE_RING].keys = 0;
}

void dt_views_lose_rows(struct dt_views *w)
{
    discount_all(w);
    w->lost = atomic_load(&w->serial);
    for (int kind = 0; kind < DT_IMAGE_KINDS; kind++)
        w->read[kind].keys = 0;
}

/* ---- which moments are read ---- */

/* Sets the moments of a kind, from the views that read it: the oldest and the newest one, NULL: none. */
static void note(struct dt_views *w, enum dt_image_kind kind, const struct dt_view *oldest,
                 const struct dt_view *newest, uint32_t keys)
{
    w->read[kind] = (struct dt_moments){.oldest = UINT64_MAX};
    if (oldest != NULL)
        w->read[kind] = (struct dt_moments){oldest->moment[kind], newest->moment[kind], keys};
}

/* Removes the views that have ended, and finds out which moments the others read. Lost views are the oldest
 * ones. */
static void look_round(struct dt_views *w)
{
    enter_new(w);
    free_ended(w);
    const struct dt_view *oldest = w->oldest, *ring = w->oldest_ring;
    const struct dt_view *newest = atomic_load(&w->newest);
    while (oldest != NULL && !dt_view_reads_rows(w, oldest))
        oldest = oldest->newer;
    while (ring != NULL && !dt_view_reads_rings(w, ring))
        ring = ring->newer_ring;
    w->first = oldest != NULL ? oldest->serial : UINT64_MAX;
    w->last = oldest != NULL ? newest->serial : 0;
    uint32_t keys = oldest != NULL ? newest->next_id : 0;
    note(w, DT_IMAGE_ROW, oldest, newest, keys);
    note(w, DT_IMAGE_FAMILY, oldest, newest, DT_NONE);
    note(w, DT_IMAGE_RING, ring, w->newest_ring, ring != NULL ? w->newest_ring->next_id : 0);
}

bool dt_views_review(struct dt_views *w)
{
    int n = 0;
    look_round(w);
    for (int kind = 0; kind < DT_IMAGE_KINDS; kind++)
        while (n < AT_ONCE && dt_images_trim(&w->images[kind], w->read[kind].oldest))
            n++;
    return n > 0;
}
