/* view.c - views begin and end, and edits save what they change; see view.h.
 *
 * Views may end while an edit is under way, and begin beside each other, so no thread waits for another: they
 * are in a list that is only ever pushed to, and one that has ended is marked. Edits, which have the set for
 * themselves but for views that end, take the marked ones out. */
#include "core/view.h"

#include <stdlib.h>

#include "core/hull.h"
#include "core/star.h"
#include "core/update.h"

enum {
    AT_ONCE = 2,            /* chunks that an edit frees */
    FORGOTTEN_AT_ONCE = 256 /* the same when no view is open */
};

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

static uint32_t some_hull_point(const struct dt *t)
{
    const struct dt_mesh *m = &t->mesh;
    if (m->vertices == 0)
        return DT_NONE;
    return t->points.id[m->vertices == 1 ? m->alone : dt_hull_vertex(m, m->hull)];
}

struct dt_view *dt_view_begin(struct dt *t, bool rings)
{
    struct dt_views *w = &t->views;
    struct dt_view *v = take_ended(w);
    if (v == NULL)
        v = new_view(w);
    if (v == NULL)
        return NULL;
    v->serial = atomic_fetch_add(&w->serial, 1) + 1;
    v->with_rings = rings && dt_is_live(t);
    v->line = v->with_rings && dt_mesh_is_line(&t->mesh);
    v->on_hull = v->with_rings ? some_hull_point(t) : DT_NONE;
    v->next_id = t->points.next_id;
    v->rows = dt_images_now(&w->rows);
    v->families = dt_images_now(&w->families);
    v->rings = dt_images_now(&w->rings);
    dt_summary(t, &v->sum);
    v->sum.memory = 0;
    atomic_store(&v->state, DT_VIEW_OPEN);
    return v;
}

void dt_view_end(struct dt_view *v)
{
    if (v != NULL)
        atomic_store(&v->state, DT_VIEW_ENDED);
}

void dt_views_clear(struct dt *t)
{
    struct dt_views *w = &t->views;
    for (struct dt_view *v = atomic_load(&w->list), *next; v != NULL; v = next) {
        next = v->next;
        free(v);
    }
    dt_images_clear(&w->rows);
    dt_images_clear(&w->families);
    dt_images_clear(&w->rings);
}

size_t dt_views_memory(const struct dt_views *w)
{
    return dt_images_memory(&w->rows) + dt_images_memory(&w->families) +
           dt_images_memory(&w->rings);
}

uint32_t dt_view_next_id(const struct dt_view *v)
{
    return v->next_id;
}

void dt_view_summary(const struct dt_view *v, struct dt_summary *out)
{
    *out = v->sum;
}

/* ---- what is lost ---- */

static bool reads_rows(const struct dt_views *w, const struct dt_view *v)
{
    return v->serial > w->lost;
}

static bool reads_rings(const struct dt_views *w, const struct dt_view *v)
{
    return v->with_rings && v->serial > w->rings_lost && reads_rows(w, v);
}

void dt_views_lose_rings(struct dt *t)
{
    t->views.rings_lost = atomic_load(&t->views.serial);
    t->views.ring_ids = 0;
}

static void lose_rows(struct dt *t)
{
    t->views.lost = atomic_load(&t->views.serial);
    t->views.row_ids = t->views.ring_ids = 0;
}

enum dt_status dt_view_readable(const struct dt *t, const struct dt_view *v, bool rings)
{
    if (v == NULL)
        return !rings || dt_is_live(t) ? DT_OK : DT_UNTRIANGULATED;
    if (!reads_rows(&t->views, v))
        return DT_NOMEM;
    if (!rings)
        return DT_OK;
    if (!v->with_rings)
        return DT_UNTRIANGULATED;
    return reads_rings(&t->views, v) && dt_is_live(t) ? DT_OK : DT_NOMEM;
}

bool dt_view_blocks(const struct dt *t, size_t n)
{
    bool read = false;
    for (const struct dt_view *v = atomic_load(&t->views.list); v != NULL; v = v->next)
        read = read || (atomic_load(&v->state) == DT_VIEW_OPEN && reads_rings(&t->views, v));
    return read && dt_is_live(t) && dt_update_is_bulk(t, n);
}

/* ---- saving ---- */

static void save_row(void *ctx, uint32_t id)
{
    struct dt *t = ctx;
    struct dt_views *w = &t->views;
    if (id >= w->row_ids || dt_images_has(&w->rows, id, w->rows_since))
        return;
    uint32_t *image = dt_images_save(&w->rows, id, DT_ROW_WORDS);
    if (image != NULL)
        dt_view_save_row(t, id, image);
    else
        lose_rows(t);
    w->saved = true;
}

static void save_family(void *ctx, uint32_t group)
{
    struct dt *t = ctx;
    struct dt_views *w = &t->views;
    if (w->row_ids == 0 || dt_images_has(&w->families, group, w->families_since))
        return;
    uint32_t *image = dt_images_save(&w->families, group, DT_FAMILY_WORDS);
    if (image != NULL)
        dt_view_save_family(t, group, image);
    else
        lose_rows(t);
    w->saved = true;
}

static void save_star(void *ctx, uint32_t v)
{
    struct dt *t = ctx;
    struct dt_views *w = &t->views;
    uint32_t id = t->points.id[v];
    if (id >= w->ring_ids || dt_images_has(&w->rings, id, w->rings_since))
        return;
    uint32_t *image = dt_images_save(&w->rings, id, dt_star_words(&t->mesh, v));
    if (image != NULL)
        dt_star_save(t, v, image);
    else
        dt_views_lose_rings(t);
    w->saved = true;
}

/* The id of a vertex is the key of its star, and stands in those of its neighbours. */
static void save_name(void *ctx, uint32_t v)
{
    const struct dt *t = ctx;
    const struct dt_mesh *m = &t->mesh;
    if (t->views.ring_ids == 0 || !t->current)
        return;
    save_star(ctx, v);
    uint32_t h = m->leaving[v];
    if (h == DT_NONE)
        return;
    do {
        if (dt_dest(m, h) != DT_NONE)
            save_star(ctx, dt_dest(m, h));
        h = dt_turn_ccw(m, h);
    } while (h != m->leaving[v]);
}

/* ---- edits ---- */

/* From which places on images are read. */
struct moment {
    uint64_t rows, families, rings;
};

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t later(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

static void note(struct dt_views *w, const struct dt_view *v, struct moment *oldest)
{
    if (reads_rows(w, v)) {
        w->row_ids = v->next_id > w->row_ids ? v->next_id : w->row_ids;
        w->rows_since = later(w->rows_since, v->rows);
        w->families_since = later(w->families_since, v->families);
        oldest->rows = earlier(oldest->rows, v->rows);
        oldest->families = earlier(oldest->families, v->families);
    }
    if (reads_rings(w, v)) {
        w->ring_ids = v->next_id > w->ring_ids ? v->next_id : w->ring_ids;
        w->rings_since = later(w->rings_since, v->rings);
        oldest->rings = earlier(oldest->rings, v->rings);
    }
}

/* Takes out the views that have ended and finds out which moments the others read. */
static struct moment look_round(struct dt_views *w)
{
    struct moment oldest = {UINT64_MAX, UINT64_MAX, UINT64_MAX};
    struct dt_view *last = NULL, *next;
    w->row_ids = w->ring_ids = 0;
    w->rows_since = w->families_since = w->rings_since = 0;
    for (struct dt_view *v = atomic_load(&w->list); v != NULL; v = next) {
        next = v->next;
        if (atomic_load(&v->state) != DT_VIEW_ENDED) {
            note(w, v, &oldest);
            last = v;
            continue;
        }
        if (last == NULL)
            atomic_store(&w->list, next);
        else
            last->next = next;
        free(v);
    }
    return oldest;
}

/* Frees some of what lies before the oldest moment, UINT64_MAX if none is read. */
static bool trim(struct dt_images *s, uint64_t oldest)
{
    if (oldest == UINT64_MAX)
        return dt_images_forget(s, FORGOTTEN_AT_ONCE);
    int n = 0;
    while (n < AT_ONCE && dt_images_trim(s, oldest))
        n++;
    return n > 0;
}

/* Returns whether something was freed. */
static bool look_after(struct dt *t)
{
    struct dt_views *w = &t->views;
    struct moment oldest = look_round(w);
    bool rows = trim(&w->rows, oldest.rows), families = trim(&w->families, oldest.families);
    bool rings = trim(&w->rings, oldest.rings);
    w->saved = !dt_images_is_empty(&w->rows) || !dt_images_is_empty(&w->families) ||
               !dt_images_is_empty(&w->rings);
    w->changes = (struct dt_changes){save_row, save_family, save_star, save_name, t};
    t->points.changes = t->points.aliases.changes = w->row_ids > 0 ? &w->changes : NULL;
    t->scratch.changes = w->ring_ids > 0 ? &w->changes : NULL;
    return rows || families || rings;
}

void dt_views_edit_begin(struct dt *t)
{
    const struct dt_views *w = &t->views;
    if (atomic_load_explicit(&w->list, memory_order_relaxed) != NULL || w->saved ||
        t->points.changes != NULL)
        look_after(t);
}

bool dt_view_tidy(struct dt *t)
{
    return look_after(t);
}
