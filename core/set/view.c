/* view.c - the list of views; see view.h.
 *
 * Views may end while an edit is under way, and begin beside each other, and no thread waits for another. So views that begin
 * are pushed to one stack, and those that end to another one. Edits, which have exclusive access to the set except for views
 * that end, enter the former into lists, from the oldest to the newest view, and take the latter out. In a list each
 * view has the moment of the one before or a later one. So only two views determine the moments that are read: the oldest and the newest,
 * among all views and among views with rings. */
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
    v->next_begun = atomic_load(&w->begun);
    while (!atomic_compare_exchange_weak(&w->begun, &v->next_begun, v))
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

static void enter(struct dt_views *w, struct dt_view *v, enum dt_view_list k)
{
    struct dt_view_ends *list = &w->list[k];
    v->link[k].older = list->newest;
    if (list->newest != NULL)
        list->newest->link[k].newer = v;
    else
        list->oldest = v;
    list->newest = v;
}

static void leave(struct dt_views *w, const struct dt_view *v, enum dt_view_list k)
{
    struct dt_view_ends *list = &w->list[k];
    const struct dt_view_link *at = &v->link[k];
    if (at->newer != NULL)
        at->newer->link[k].older = at->older;
    else
        list->newest = at->older;
    if (at->older != NULL)
        at->older->link[k].newer = at->newer;
    else
        list->oldest = at->newer;
}

/* Enters the views that have begun since the last call, the oldest first. */
static void enter_begun(struct dt_views *w)
{
    struct dt_view *v = atomic_exchange(&w->begun, NULL), *first = NULL, *next;
    for (; v != NULL; v = next) {
        next = v->next_begun;
        v->next_begun = first;
        first = v;
    }
    for (v = first; v != NULL; v = v->next_begun) {
        enter(w, v, DT_VIEWS_ALL);
        if (v->with_rings)
            enter(w, v, DT_VIEWS_RINGS);
    }
}

/* They have been entered. */
static void free_ended(struct dt_views *w)
{
    struct dt_view *v = atomic_exchange(&w->ended, NULL), *next;
    for (; v != NULL; v = next) {
        next = v->next_ended;
        leave(w, v, DT_VIEWS_ALL);
        if (v->with_rings)
            leave(w, v, DT_VIEWS_RINGS);
        free(v);
    }
}

void dt_views_clear(struct dt_views *w)
{
    enter_begun(w);
    free_ended(w);
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
    enter_begun(w);
    for (struct dt_view *v = w->list[DT_VIEWS_RINGS].oldest; v != NULL;
         v = v->link[DT_VIEWS_RINGS].newer)
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
    enter_begun(w);
    free_ended(w);
    const struct dt_view *oldest = w->list[DT_VIEWS_ALL].oldest,
                         *newest = w->list[DT_VIEWS_ALL].newest,
                         *ring = w->list[DT_VIEWS_RINGS].oldest,
                         *newest_ring = w->list[DT_VIEWS_RINGS].newest;
    while (oldest != NULL && !dt_view_reads_rows(w, oldest))
        oldest = oldest->link[DT_VIEWS_ALL].newer;
    while (ring != NULL && !dt_view_reads_rings(w, ring))
        ring = ring->link[DT_VIEWS_RINGS].newer;
    w->first = oldest != NULL ? oldest->serial : UINT64_MAX;
    w->last = oldest != NULL ? newest->serial : 0;
    note(w, DT_IMAGE_ROW, oldest, newest, oldest != NULL ? newest->next_id : 0);
    note(w, DT_IMAGE_FAMILY, oldest, newest, DT_NONE);
    note(w, DT_IMAGE_RING, ring, newest_ring, ring != NULL ? newest_ring->next_id : 0);
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
