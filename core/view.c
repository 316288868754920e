/* view.c - views begin and end, and edits save what they change; see view.h.
 *
 * Views may end while an edit is under way, and begin beside each other, so they are in a list that is only
 * ever pushed to, and one that has ended is marked. Edits, which have the set for themselves but for views that
 * end, take the marked ones out. */
#include "core/view.h"

#include <stdlib.h>
#include <string.h>

#include "core/set.h"
#include "core/update.h"

enum {
    ROW_WORDS = 5, /* of an image: group or DT_NONE, x, y */
    FAMILY_WORDS =
        2,      /* the group that it is part of, DT_NONE for a root; a root's representative */
    AT_ONCE = 4 /* chunks that an edit frees */
};

/* ---- life ---- */

/* A view of the list that has ended, taken over by the caller; NULL: there is none. */
static struct dt_view *take_ended(struct dt_views *w)
{
    for (struct dt_view *v = atomic_load(&w->list); v != NULL; v = v->next) {
        bool open = false;
        if (!atomic_load_explicit(&v->open, memory_order_relaxed) &&
            atomic_compare_exchange_strong(&v->open, &open, true))
            return v;
    }
    return NULL;
}

static struct dt_view *new_view(struct dt_views *w)
{
    struct dt_view *v = calloc(1, sizeof *v);
    if (v == NULL)
        return NULL;
    atomic_init(&v->open, true);
    v->next = atomic_load(&w->list);
    while (!atomic_compare_exchange_weak(&w->list, &v->next, v))
        ;
    return v;
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
    v->rings = rings && dt_is_live(t);
    v->rows = dt_images_now(&w->rows);
    v->families = dt_images_now(&w->families);
    v->next_id = t->points.next_id;
    dt_summary(t, &v->sum);
    v->sum.memory = 0;
    return v;
}

void dt_view_end(struct dt_view *v)
{
    if (v != NULL)
        atomic_store(&v->open, false);
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
}

size_t dt_views_memory(const struct dt_views *w)
{
    return dt_images_memory(&w->rows) + dt_images_memory(&w->families);
}

uint32_t dt_view_next_id(const struct dt_view *v)
{
    return v->next_id;
}

void dt_view_summary(const struct dt_view *v, struct dt_summary *out)
{
    *out = v->sum;
}

/* ---- edits ---- */

/* From which places on images are read. */
struct moment {
    uint64_t rows, families;
};

static void note(struct dt_views *w, const struct dt_view *v, struct moment *oldest)
{
    if (v->serial <= w->lost)
        return;
    w->ids = v->next_id > w->ids ? v->next_id : w->ids;
    w->rows_since = v->rows > w->rows_since ? v->rows : w->rows_since;
    w->families_since = v->families > w->families_since ? v->families : w->families_since;
    oldest->rows = v->rows < oldest->rows ? v->rows : oldest->rows;
    oldest->families = v->families < oldest->families ? v->families : oldest->families;
}

/* Takes out what has ended and finds out which moments are read. */
static struct moment look_round(struct dt_views *w)
{
    struct moment oldest = {UINT64_MAX, UINT64_MAX};
    struct dt_view *last = NULL, *next;
    w->ids = 0;
    w->rows_since = w->families_since = 0;
    for (struct dt_view *v = atomic_load(&w->list); v != NULL; v = next) {
        next = v->next;
        if (atomic_load(&v->open)) {
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

/* Frees some chunks that lie before the oldest moment; if none is read, at the end all of it. */
static bool trim(struct dt_images *s, uint64_t oldest)
{
    int n = 0;
    while (n < AT_ONCE && dt_images_trim(s, oldest))
        n++;
    if (oldest == UINT64_MAX && n < AT_ONCE && !dt_images_is_empty(s)) {
        dt_images_clear(s);
        return true;
    }
    return n > 0;
}

/* Returns whether something was freed. */
static bool look_after(struct dt *t)
{
    struct dt_views *w = &t->views;
    struct moment oldest = look_round(w);
    bool rows = trim(&w->rows, oldest.rows), families = trim(&w->families, oldest.families);
    w->saved = !dt_images_is_empty(&w->rows) || !dt_images_is_empty(&w->families);
    t->points.changes = t->points.aliases.changes = w->ids > 0 ? &w->changes : NULL;
    return rows || families;
}

/* The row of a live id as an image has it. */
static void encode_row(const struct dt_points *p, uint32_t id, uint32_t *image)
{
    uint32_t value = dt_idmap_get(&p->value, id);
    bool alias = (value & DT_ALIAS_BIT) != 0;
    struct dt_point at = dt_points_xy(p, id);
    image[0] = alias ? p->aliases.alias[value & ~DT_ALIAS_BIT].group : DT_NONE;
    memcpy(image + 1, &at, sizeof at);
}

/* Nobody can read any more. */
static void lose(struct dt *t)
{
    t->views.lost = atomic_load(&t->views.serial);
    t->views.ids = 0;
}

static void save_row(void *ctx, uint32_t id)
{
    struct dt *t = ctx;
    struct dt_views *w = &t->views;
    if (id >= w->ids || dt_images_has(&w->rows, id, w->rows_since))
        return;
    uint32_t *image = dt_images_save(&w->rows, id, ROW_WORDS);
    if (image == NULL)
        lose(t);
    else
        encode_row(&t->points, id, image);
    w->saved = true;
}

static void save_family(void *ctx, uint32_t group)
{
    struct dt *t = ctx;
    struct dt_views *w = &t->views;
    if (w->ids == 0 || dt_images_has(&w->families, group, w->families_since))
        return;
    const struct dt_alias_group *g = &t->points.aliases.group[group];
    uint32_t *image = dt_images_save(&w->families, group, FAMILY_WORDS);
    if (image == NULL) {
        lose(t);
    } else {
        image[0] = g->up;
        image[1] = g->representative;
    }
    w->saved = true;
}

static void lose_star(void *ctx, uint32_t v)
{
    (void)v;
    dt_views_lose_rings(ctx);
}

void dt_views_edit_begin(struct dt *t)
{
    struct dt_views *w = &t->views;
    if (dt_is_live(t))
        dt_views_lose_rings(t);
    if (atomic_load_explicit(&w->list, memory_order_relaxed) == NULL && !w->saved &&
        t->points.changes == NULL)
        return;
    w->changes = (struct dt_changes){save_row, save_family, lose_star, lose_star, t};
    look_after(t);
}

bool dt_view_tidy(struct dt *t)
{
    return look_after(t);
}

void dt_views_lose_rings(struct dt *t)
{
    t->views.rings_lost = atomic_load(&t->views.serial);
}

bool dt_view_blocks(const struct dt *t, size_t n)
{
    const struct dt_views *w = &t->views;
    bool read = false;
    for (const struct dt_view *v = atomic_load(&w->list); v != NULL; v = v->next)
        read = read || (atomic_load(&v->open) && v->rings && v->serial > w->rings_lost &&
                        v->serial > w->lost);
    return read && dt_is_live(t) && dt_update_is_bulk(t, n);
}

/* ---- reading rows ---- */

enum dt_status dt_view_readable(const struct dt *t, const struct dt_view *v, bool rings)
{
    const struct dt_views *w = &t->views;
    if (v->serial <= w->lost)
        return DT_NOMEM;
    if (!rings)
        return DT_OK;
    if (!v->rings)
        return DT_UNTRIANGULATED;
    return v->serial <= w->rings_lost || !dt_is_live(t) ? DT_NOMEM : DT_OK;
}

const struct dt_view *dt_view_if_changed(const struct dt *t, const struct dt_view *v)
{
    const struct dt_views *w = &t->views;
    if (v == NULL ||
        (v->rows == dt_images_now(&w->rows) && v->families == dt_images_now(&w->families)))
        return NULL;
    return v;
}

static uint32_t representative_of(const struct dt *t, const struct dt_view *v, uint32_t group)
{
    const uint32_t *image;
    do {
        const struct dt_alias_group *g = &t->points.aliases.group[group];
        image = v == NULL ? NULL : dt_images_get(&t->views.families, group, v->families, NULL);
        uint32_t up = image != NULL ? image[0] : g->up;
        if (up == DT_NONE)
            return image != NULL ? image[1] : g->representative;
        group = up;
    } while (true);
}

/* The row of an id that stands for `value` and has not changed since. */
static struct dt_row row_now(const struct dt *t, const struct dt_view *v, uint32_t id,
                             uint32_t value)
{
    if (!(value & DT_ALIAS_BIT))
        return (struct dt_row){id, id, t->points.xy[value]};
    const struct dt_alias *a = &t->points.aliases.alias[value & ~DT_ALIAS_BIT];
    return (struct dt_row){id, representative_of(t, v, a->group), a->xy};
}

static bool row_saved(const struct dt *t, const struct dt_view *v, uint32_t id, struct dt_row *row)
{
    const uint32_t *image = dt_images_get(&t->views.rows, id, v->rows, NULL);
    if (image == NULL)
        return false;
    row->id = id;
    row->representative = image[0] == DT_NONE ? id : representative_of(t, v, image[0]);
    memcpy(&row->at, image + 1, sizeof row->at);
    return true;
}

bool dt_view_row(const struct dt *t, const struct dt_view *v, uint32_t id, struct dt_row *row)
{
    if (v != NULL && id >= v->next_id)
        return false;
    v = dt_view_if_changed(t, v);
    if (v != NULL && row_saved(t, v, id, row))
        return true;
    uint32_t value = dt_idmap_get(&t->points.value, id);
    if (value == DT_NONE)
        return false;
    *row = row_now(t, v, id, value);
    return true;
}

bool dt_view_is_alias(const struct dt *t, const struct dt_view *v, uint32_t id,
                      uint32_t *representative)
{
    const struct dt_points *p = &t->points;
    const uint32_t *image = v == NULL ? NULL : dt_images_get(&t->views.rows, id, v->rows, NULL);
    uint32_t group = image == NULL ? DT_NONE : image[0];
    if (image == NULL && dt_points_is_alias(p, id))
        group = p->aliases.alias[dt_idmap_get(&p->value, id) & ~DT_ALIAS_BIT].group;
    if (group != DT_NONE)
        *representative = representative_of(t, v, group);
    return group != DT_NONE;
}

enum dt_status dt_view_get(const struct dt *t, const struct dt_view *v, uint32_t id,
                           struct dt_point *p)
{
    struct dt_row row;
    enum dt_status status = v == NULL ? DT_OK : dt_view_readable(t, v, false);
    if (status != DT_OK)
        return status;
    if (!dt_view_row(t, v, id, &row))
        return DT_NOPOINT;
    *p = row.at;
    return DT_OK;
}

/* ---- walking ids ---- */

struct dt_view_ids dt_view_ids_begin(const struct dt *t, const struct dt_view *v, uint32_t from)
{
    struct dt_view_ids w = {t, dt_view_if_changed(t, v), v == NULL ? DT_NONE : v->next_id, 0};
    w.saved = w.v == NULL ? DT_NONE : dt_sparse_next(&t->views.rows.newest, from);
    return w;
}

uint32_t dt_view_ids_next(struct dt_view_ids *w, uint32_t from)
{
    const struct dt_images *rows = &w->t->views.rows;
    for (;; from++) {
        if (w->saved < from)
            w->saved = dt_sparse_next(&rows->newest, from);
        uint32_t live = dt_points_next_live(&w->t->points, from);
        from = live < w->saved ? live : w->saved;
        if (from >= w->end)
            return DT_NONE;
        if (from == live || dt_images_has(rows, from, w->v->rows))
            return from;
    }
}

enum dt_status dt_view_ring(const struct dt *t, const struct dt_view *v, uint32_t id, bool cw,
                            struct dt_ids *ring, uint32_t *rep, bool *boundary)
{
    enum dt_status status = v == NULL ? DT_OK : dt_view_readable(t, v, true);
    if (status != DT_OK)
        return status;
    if (v != NULL && id >= v->next_id)
        return DT_NOPOINT;
    return dt_ring(t, id, cw, ring, rep, boundary);
}

uint32_t dt_view_ids_after(const struct dt *t, const struct dt_view *v, uint32_t from, uint32_t n)
{
    uint32_t live = dt_idmap_after(&t->points.value, from, n), saved = DT_NONE;
    if (dt_view_if_changed(t, v) != NULL)
        saved = dt_sparse_after(&t->views.rows.newest, from, n);
    return live < saved ? live : saved;
}

/* ---- reading all rows ---- */

enum { AHEAD = 64 }; /* rows whose places are fetched together: they lie anywhere */

/* Lists the next ids, up to n, with what each stands for, DT_NONE if its row is filled in already, from an
 * image. Returns how many. */
static size_t list_rows(struct dt_view_ids *w, uint32_t *from, struct dt_row *row, uint32_t *value,
                        size_t n)
{
    const struct dt_points *p = &w->t->points;
    for (size_t i = 0; i < n; i++) {
        uint32_t id = dt_view_ids_next(w, *from);
        if (id == DT_NONE)
            return i;
        *from = id + 1;
        row[i].id = id;
        value[i] = DT_NONE;
        if (w->v != NULL && row_saved(w->t, w->v, id, &row[i]))
            continue;
        value[i] = dt_idmap_get(&p->value, id);
        if (!(value[i] & DT_ALIAS_BIT))
            dt_fetch(&p->xy[value[i]]);
    }
    return n;
}

enum dt_status dt_view_rows(const struct dt *t, const struct dt_view *v, uint32_t *from,
                            struct dt_row *row, size_t room, size_t *n)
{
    enum dt_status status = dt_view_readable(t, v, false);
    if (status != DT_OK)
        return status;
    struct dt_view_ids walk = dt_view_ids_begin(t, v, *from);
    *n = 0;
    for (size_t listed = 1; listed > 0 && *n < room; *n += listed) {
        uint32_t value[AHEAD];
        struct dt_row *r = row + *n;
        listed = list_rows(&walk, from, r, value, room - *n < AHEAD ? room - *n : AHEAD);
        for (size_t i = 0; i < listed; i++)
            if (value[i] != DT_NONE)
                r[i] = row_now(t, walk.v, r[i].id, value[i]);
    }
    return DT_OK;
}
