/* view.c - the list of views; see view.h.
 *
 * Views may end while an edit is under way, and begin beside each other, so no thread waits for another: they
 * are in a list that is only ever pushed to, and one that has ended is marked. Edits, which have exclusive
 * access to the set except for views that end, remove the marked ones. */
#include "core/set/view.h"

#include <stdlib.h>

enum { AT_ONCE = 4 }; /* chunks of all kinds that an edit frees */

/* ---- life ---- */

/* A view of the list that has ended, taken over; NULL: there is none. */
static struct dt_view *take_ended(struct dt_views *w)
{
    for (struct dt_view *v = atomic_load(&w->list); v != NULL; v = v->next) {
        int ended = DT_VIEW_ENDED;
        if (atomic_load_explicit(&v->state, memory_order_relaxed) == DT_VIEW_ENDED &&
            atomic_compare_exchange_strong(&v->state, &ended, DT_VIEW_BEGINNING))
            return v;
    }
    return NULL;
}

static struct dt_view *new_view(struct dt_views *w)
{
    struct dt_view *v = calloc(1, sizeof *v);
    if (v == NULL)
        return NULL;
    atomic_init(&v->state, DT_VIEW_BEGINNING);
    v->next = atomic_load(&w->list);
    while (!atomic_compare_exchange_weak(&w->list, &v->next, v))
        ;
    return v;
}

struct dt_view *dt_views_begin(struct dt_views *w)
{
    struct dt_view *v = take_ended(w);
    if (v == NULL)
        v = new_view(w);
    if (v == NULL)
        return NULL;
    v->serial = atomic_fetch_add(&w->serial, 1) + 1;
    for (int kind = 0; kind < DT_IMAGE_KINDS; kind++)
        v->moment[kind] = dt_images_now(&w->images[kind]);
    return v;
}

void dt_view_end(struct dt_view *v)
{
    if (v != NULL)
        atomic_store(&v->state, DT_VIEW_ENDED);
}

void dt_views_clear(struct dt_views *w)
{
    for (struct dt_view *v = atomic_load(&w->list), *next; v != NULL; v = next) {
        next = v->next;
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
    bool read = false;
    for (const struct dt_view *v = atomic_load(&w->list); v != NULL; v = v->next)
        read = read || (atomic_load(&v->state) == DT_VIEW_OPEN && dt_view_reads_rings(w, v));
    return read;
}

void dt_views_lose_rings(struct dt_views *w)
{
    w->rings_lost = atomic_load(&w->serial);
    w->read[DT_IMAGE_RING].keys = 0;
}

void dt_views_lose_rows(struct dt_views *w)
{
    w->lost = atomic_load(&w->serial);
    for (int kind = 0; kind < DT_IMAGE_KINDS; kind++)
        w->read[kind].keys = 0;
}

/* ---- which moments are read ---- */

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t later(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* The view reads images of that kind, of keys below `keys`. */
static void note(struct dt_views *w, const struct dt_view *v, enum dt_image_kind kind,
                 uint32_t keys)
{
    struct dt_moments *m = &w->read[kind];
    m->oldest = earlier(m->oldest, v->moment[kind]);
    m->latest = later(m->latest, v->moment[kind]);
    m->keys = keys > m->keys ? keys : m->keys;
}

static void note_view(struct dt_views *w, const struct dt_view *v)
{
    if (!dt_view_reads_rows(w, v))
        return;
    w->oldest = earlier(w->oldest, v->serial);
    w->latest = later(w->latest, v->serial);
    note(w, v, DT_IMAGE_ROW, v->next_id);
    note(w, v, DT_IMAGE_FAMILY, DT_NONE);
    if (dt_view_reads_rings(w, v))
        note(w, v, DT_IMAGE_RING, v->next_id);
}

/* Takes out the views that have ended and finds out which moments the others read. */
static void look_round(struct dt_views *w)
{
    struct dt_view *last = NULL, *next;
    for (int kind = 0; kind < DT_IMAGE_KINDS; kind++)
        w->read[kind] = (struct dt_moments){.oldest = UINT64_MAX};
    w->oldest = UINT64_MAX;
    w->latest = 0;
    for (struct dt_view *v = atomic_load(&w->list); v != NULL; v = next) {
        next = v->next;
        if (atomic_load(&v->state) != DT_VIEW_ENDED) {
            note_view(w, v);
            last = v;
            continue;
        }
        if (last == NULL)
            atomic_store(&w->list, next);
        else
            last->next = next;
        free(v);
    }
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
