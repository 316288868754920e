/* view_save.c - saves the data that an edit is about to change, once for all views that read it.
 *
 * An edit learns from the views which moments are read (dt_views_edit_begin) and is called back for what it is
 * about to change (core/points/changes.h). */
#include "core/set/set.h"

#include "core/mesh/star.h"
#include "core/set/view_rows.h"

/* Whether the value that the key has now is read and has not been saved. */
static bool is_needed(const struct dt_views *w, enum dt_image_kind kind, uint32_t key)
{
    const struct dt_moments *m = &w->read[kind];
    return key < m->keys && !dt_images_has(&w->images[kind], key, m->latest);
}

static void save_row(void *ctx, uint32_t id)
{
    struct dt *t = ctx;
    struct dt_views *w = &t->views;
    if (t->touched.on)
        dt_touched_note(&t->touched.rows, (uint64_t)id << 32 | DT_TOUCHED_ROW);
    if (t->touched.on && t->constraints != NULL)
        dt_touched_note_end(t, id);
    if (!is_needed(w, DT_IMAGE_ROW, id))
        return;
    uint32_t *image = dt_images_save(&w->images[DT_IMAGE_ROW], id, DT_ROW_WORDS);
    if (image != NULL)
        dt_view_save_row(t, id, image);
    else
        dt_views_lose_rows(w);
}

static void save_family(void *ctx, uint32_t group)
{
    struct dt *t = ctx;
    struct dt_views *w = &t->views;
    if (!is_needed(w, DT_IMAGE_FAMILY, group))
        return;
    uint32_t *image = dt_images_save(&w->images[DT_IMAGE_FAMILY], group, DT_FAMILY_WORDS);
    if (image != NULL)
        dt_view_save_family(t, group, image);
    else
        dt_views_lose_rows(w);
}

static void save_star(void *ctx, uint32_t v)
{
    struct dt *t = ctx;
    struct dt_views *w = &t->views;
    uint32_t id = t->points.id[v];
    if (t->touched.on && id != DT_NONE)
        dt_touched_note(&t->touched.rows, (uint64_t)id << 32 | DT_TOUCHED_RING);
    if (!is_needed(w, DT_IMAGE_RING, id))
        return;
    uint32_t *image = dt_images_save(&w->images[DT_IMAGE_RING], id, dt_star_words(&t->mesh, v));
    if (image != NULL)
        dt_star_save(&t->mesh, t->points.id, v, image);
    else
        dt_views_lose_rings(w);
}

/* The id of a vertex is the key of its star, and is contained in the stars of its neighbours. */
static void save_name(void *ctx, uint32_t v)
{
    const struct dt *t = ctx;
    const struct dt_mesh *m = &t->mesh;
    if ((t->views.read[DT_IMAGE_RING].keys == 0 && !t->touched.on) || !t->current)
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

/* Returns whether something was freed. */
static bool look_after(struct dt *t)
{
    struct dt_views *w = &t->views;
    bool freed = dt_views_review(w);
    freed |= dt_fields_review(&t->fields, atomic_load(&w->serial), w->last, w->first);
    bool rows = t->touched.on || w->read[DT_IMAGE_ROW].keys > 0;
    bool rings = t->touched.on || w->read[DT_IMAGE_RING].keys > 0;
    w->changes = (struct dt_changes){save_row, save_family, save_star, save_name, t};
    t->points.changes = t->points.aliases.changes = rows ? &w->changes : NULL;
    t->scratch.changes = rings ? &w->changes : NULL;
    return freed;
}

void dt_views_edit_begin(struct dt *t)
{
    t->edits++;
    dt_views_values_begin(t);
}

void dt_views_values_begin(struct dt *t)
{
    const struct dt_views *w = &t->views;
    /* Since rows were taken last the points were on one line, and are not any more, or the reverse. */
    if (t->touched.on && dt_is_live(t) &&
        dt_mesh_is_line(&t->mesh) != (t->touched.line != DT_NOT_ON_LINE))
        t->touched.rows.all = true;
    if (t->touched.on || dt_views_has_any(w) || !dt_views_are_empty(w) ||
        t->points.changes != NULL || dt_fields_keep(&t->fields))
        look_after(t);
}

bool dt_view_tidy(struct dt *t)
{
    return look_after(t);
}
