/* view_rows.c - the beginning of views, and reads of rows; see view_rows.h. */
#include "core/set/view_rows.h"

#include "core/delaunay_surface.h"

#include "core/mesh/hull.h"

#include <string.h>

static uint32_t some_hull_point(const struct dt *t)
{
    const struct dt_mesh *m = &t->mesh;
    if (m->vertices == 0)
        return DT_NONE;
    return t->points.id[m->vertices == 1 ? m->alone : dt_hull_vertex(m, m->hull)];
}

struct dt_view *dt_view_begin(struct dt *t, bool rings)
{
    struct dt_view *v = dt_views_begin(&t->views);
    if (v == NULL)
        return NULL;
    v->with_rings = rings && dt_is_live(t);
    v->constrained = v->with_rings && t->mesh.fixed != NULL;
    v->line = v->with_rings && dt_mesh_is_line(&t->mesh);
    v->on_hull = v->with_rings ? some_hull_point(t) : DT_NONE;
    v->constraints = t->constraints == NULL ? 0 : dt_history_now(&t->constraints->history);
    v->next_id = t->points.next_id;
    dt_summary(t, &v->sum);
    v->sum.memory = 0;
    dt_views_open(&t->views, v);
    return v;
}

enum dt_status dt_view_readable_delaunay(const struct dt *t, const struct dt_view *v)
{
    bool constrained = v == NULL ? t->mesh.fixed != NULL : v->constrained;
    enum dt_status s = dt_view_readable(t, v, true);
    return s == DT_OK && constrained ? DT_NOTDELAUNAY : s;
}

enum dt_status dt_view_readable(const struct dt *t, const struct dt_view *v, bool rings)
{
    if (v == NULL)
        return !rings || dt_is_live(t) ? DT_OK : DT_UNTRIANGULATED;
    if (!dt_view_reads_rows(&t->views, v))
        return DT_NOMEM;
    if (!rings)
        return DT_OK;
    if (!v->with_rings)
        return DT_UNTRIANGULATED;
    return dt_view_reads_rings(&t->views, v) && dt_is_live(t) ? DT_OK : DT_NOMEM;
}

const struct dt_view *dt_view_if_changed(const struct dt *t, const struct dt_view *v)
{
    bool changed = false;
    for (int kind = 0; v != NULL && kind < DT_IMAGE_KINDS; kind++)
        changed = changed || v->moment[kind] != dt_images_now(&t->views.images[kind]);
    return changed ? v : NULL;
}

bool dt_view_is_current(const struct dt *t, const struct dt_view *v)
{
    return dt_view_readable(t, v, true) == DT_OK && dt_view_if_changed(t, v) == NULL;
}

/* ---- one row ---- */

void dt_view_save_row(const struct dt *t, uint32_t id, uint32_t *image)
{
    uint32_t value = dt_idmap_get(&t->points.value, id);
    struct dt_point at = dt_points_xy(&t->points, id);
    bool alias = (value & DT_ALIAS_BIT) != 0;
    image[0] = alias ? t->points.aliases.alias[value & ~DT_ALIAS_BIT].group : DT_NONE;
    memcpy(image + 1, &at, sizeof at);
}

void dt_view_save_family(const struct dt *t, uint32_t group, uint32_t *image)
{
    image[0] = t->points.aliases.group[group].up;
    image[1] = t->points.aliases.group[group].representative;
}

static const uint32_t *saved_row(const struct dt *t, const struct dt_view *v, uint32_t id)
{
    return dt_view_image(&t->views, v, DT_IMAGE_ROW, id, NULL);
}

static uint32_t representative_of(const struct dt *t, const struct dt_view *v, uint32_t group)
{
    for (;;) {
        const struct dt_alias_group *now = &t->points.aliases.group[group];
        const uint32_t *then =
            v == NULL ? NULL : dt_view_image(&t->views, v, DT_IMAGE_FAMILY, group, NULL);
        uint32_t up = then != NULL ? then[0] : now->up;
        if (up == DT_NONE)
            return then != NULL ? then[1] : now->representative;
        group = up;
    }
}

static struct dt_row decode_row(const struct dt *t, const struct dt_view *v, uint32_t id,
                                const uint32_t *image)
{
    struct dt_row row = {.id = id, .representative = id};
    if (image[0] != DT_NONE)
        row.representative = representative_of(t, v, image[0]);
    memcpy(&row.at, image + 1, sizeof row.at);
    return row;
}

/* The row of an id whose entry in the map is `value` now and has not changed since. */
static struct dt_row row_now(const struct dt *t, const struct dt_view *v, uint32_t id,
                             uint32_t value)
{
    if (!(value & DT_ALIAS_BIT))
        return (struct dt_row){id, id, t->points.xy[value]};
    const struct dt_alias *a = &t->points.aliases.alias[value & ~DT_ALIAS_BIT];
    return (struct dt_row){id, representative_of(t, v, a->group), a->xy};
}

bool dt_view_row(const struct dt *t, const struct dt_view *v, uint32_t id, struct dt_row *row)
{
    if (v != NULL && id >= v->next_id)
        return false;
    v = dt_view_if_changed(t, v);
    const uint32_t *image = v == NULL ? NULL : saved_row(t, v, id);
    if (image != NULL) {
        *row = decode_row(t, v, id, image);
        return true;
    }
    uint32_t value = dt_idmap_get(&t->points.value, id);
    if (value == DT_NONE)
        return false;
    *row = row_now(t, v, id, value);
    return true;
}

struct dt_point dt_view_place(const struct dt *t, const struct dt_view *v, uint32_t id)
{
    struct dt_row row = {0};
    (void)dt_view_row(t, v, id, &row);
    return row.at;
}

uint32_t dt_view_representative(const struct dt *t, const struct dt_view *v, uint32_t id)
{
    if (v != NULL && id >= v->next_id)
        return DT_NONE;
    const uint32_t *image = v == NULL ? NULL : saved_row(t, v, id);
    if (image != NULL)
        return image[0] == DT_NONE ? id : representative_of(t, v, image[0]);
    uint32_t value = dt_idmap_get(&t->points.value, id);
    if (value == DT_NONE || !(value & DT_ALIAS_BIT))
        return value == DT_NONE ? DT_NONE : id;
    return representative_of(t, v, t->points.aliases.alias[value & ~DT_ALIAS_BIT].group);
}

enum dt_status dt_view_get(const struct dt *t, const struct dt_view *v, uint32_t id,
                           struct dt_point *p)
{
    if (v == NULL)
        return dt_get(t, id, p);
    struct dt_row row;
    enum dt_status status = dt_view_readable(t, v, false);
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
    w.saved = w.v == NULL ? DT_NONE : dt_idmap_next(&t->views.images[DT_IMAGE_ROW].newest, from);
    return w;
}

uint32_t dt_view_ids_next(struct dt_view_ids *w, uint32_t from)
{
    const struct dt_views *views = &w->t->views;
    for (;; from++) {
        if (w->saved < from)
            w->saved = dt_idmap_next(&views->images[DT_IMAGE_ROW].newest, from);
        uint32_t live = dt_points_next_live(&w->t->points, from);
        from = live < w->saved ? live : w->saved;
        if (from >= w->end)
            return DT_NONE;
        if (from == live || dt_view_has(views, w->v, DT_IMAGE_ROW, from))
            return from;
    }
}

uint32_t dt_view_ids_after(const struct dt *t, const struct dt_view *v, uint32_t from, uint32_t n)
{
    uint32_t live = dt_idmap_after(&t->points.value, from, n), saved = DT_NONE;
    if (dt_view_if_changed(t, v) != NULL)
        saved = dt_idmap_after(&t->views.images[DT_IMAGE_ROW].newest, from, n);
    return live < saved ? live : saved;
}

/* ---- all rows ---- */

enum { AHEAD = 64 }; /* rows whose places are fetched together: they lie anywhere */

/* Lists the next ids, up to n, with what each stands for; those that were saved are filled in already, and
 * stand for DT_NONE. Returns how many. */
static size_t list_rows(struct dt_view_ids *w, uint32_t *from, struct dt_row *row, uint32_t *value,
                        size_t n)
{
    const struct dt_points *p = &w->t->points;
    for (size_t i = 0; i < n; i++) {
        uint32_t id = dt_view_ids_next(w, *from);
        if (id == DT_NONE)
            return i;
        *from = id + 1;
        const uint32_t *image = w->v == NULL ? NULL : saved_row(w->t, w->v, id);
        value[i] = image != NULL ? DT_NONE : dt_idmap_get(&p->value, id);
        row[i].id = id;
        if (image != NULL)
            row[i] = decode_row(w->t, w->v, id, image);
        else if (!(value[i] & DT_ALIAS_BIT))
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
