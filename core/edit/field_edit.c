/* field_edit.c - values are set, and fields dropped. First the pages that will be written to are made ready, which
 * may fail and changes no value; then the values are written, which cannot fail. */
#include "core/delaunay_fields.h"

#include <math.h>
#include <string.h>

#include "core/control/stop.h"
#include "core/edit/update.h"

/* The values to be set. */
struct setting {
    struct dt *t;
    struct dt_field *field;
    bool created;
    struct dt_field_ids ids;
    const double *v;
};

/* Counts the next DT_WORK_BLOCK values in advance. */
static enum dt_status count_values(const struct setting *s, size_t i, struct dt_stop *work)
{
    size_t left = s->ids.n - i;
    return (i & DT_WORK_MASK) != 0 ? DT_OK
                                   : dt_work(work, left < DT_WORK_BLOCK ? left : DT_WORK_BLOCK);
}

/* DT_OK if every value may be set at its point. */
static enum dt_status check(const struct setting *s, struct dt_stop *work, uint32_t *missing)
{
    enum dt_status status = DT_OK;
    for (size_t i = 0; i < s->ids.n && status == DT_OK; i++) {
        status = count_values(s, i, work);
        *missing = dt_field_id(&s->ids, i);
        bool needless = s->ids.id == NULL && isnan(s->v[i]);
        if (isinf(s->v[i]))
            status = DT_RANGE;
        else if (!needless && dt_idmap_get(&s->t->points.value, *missing) == DT_NONE)
            status = DT_NOPOINT;
    }
    return status;
}

/* Makes the pages ready that have to be there for the values to be set. */
static enum dt_status open_pages(const struct setting *s, struct dt_stop *work)
{
    struct dt_shelf *shelf = &s->t->fields.shelf;
    enum dt_status status = DT_OK;
    uint32_t open = DT_NONE; /* the page that was opened last */
    for (size_t i = 0; i < s->ids.n && status == DT_OK; i++) {
        uint32_t id = dt_field_id(&s->ids, i);
        status = count_values(s, i, work);
        if (status != DT_OK || id / DT_FIELD_PAGE == open ||
            (isnan(s->v[i]) && dt_field_page_now(s->field, id) == NULL))
            continue;
        status = dt_field_open(shelf, s->field, id);
        open = id / DT_FIELD_PAGE;
    }
    if (status != DT_OK)
        dt_field_close(shelf, s->field, &s->ids);
    return status;
}

/* For those who follow the set. */
static void note_values(const struct setting *s)
{
    struct dt_touched *w = &s->t->touched;
    for (size_t i = 0; w->with_values && !w->values.all && i < s->ids.n; i++)
        dt_touched_note(&w->values, (uint64_t)dt_field_id(&s->ids, i) << 32 |
                                        (DT_TOUCHED_VALUE + s->field->number));
}

static void write_values(const struct setting *s)
{
    dt_field_write(&s->t->fields.shelf, s->field, &s->ids, s->v);
}

/* Finds the field, or creates it. */
static enum dt_status find_field(struct setting *s, const char *name, size_t len)
{
    if (len == 0 || len > DT_FIELD_NAME || memchr(name, '\0', len) != NULL)
        return DT_NOFIELD;
    s->field = dt_fields_find(&s->t->fields, name, len);
    s->created = s->field == NULL;
    return s->created ? dt_fields_create(&s->t->fields, name, len, &s->field) : DT_OK;
}

/* Finds or creates the field, and makes its pages ready. If that fails, a created field is dropped again. */
static enum dt_status open_field(struct setting *s, const char *name, size_t len,
                                 struct dt_stop *work)
{
    enum dt_status status = find_field(s, name, len);
    if (status != DT_OK)
        return status;
    status = open_pages(s, work);
    if (status != DT_OK && s->created)
        dt_fields_drop(&s->t->fields, s->field);
    return status;
}

static enum dt_status set_values(struct setting *s, const char *name, size_t len,
                                 const struct dt_options *opt, uint32_t *missing)
{
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status status = check(s, &work, missing);
    if (status != DT_OK)
        return status;
    dt_views_values_begin(s->t);
    status = open_field(s, name, len, &work);
    if (status != DT_OK)
        return status;
    note_values(s);
    write_values(s);
    return DT_OK;
}

enum dt_status dt_field_set(struct dt *t, const char *name, size_t len, const uint32_t *ids,
                            const double *values, size_t n, const struct dt_options *opt,
                            uint32_t *missing)
{
    struct setting s = {.t = t, .ids = {.id = ids, .n = n}, .v = values};
    return set_values(&s, name, len, opt, missing);
}

enum dt_status dt_field_set_run(struct dt *t, const char *name, size_t len, uint32_t first,
                                const double *values, size_t n, const struct dt_options *opt,
                                uint32_t *missing)
{
    struct setting s = {.t = t, .ids = {.first = first, .n = n}, .v = values};
    if (n <= (uint64_t)UINT32_MAX + 1 - first)
        return set_values(&s, name, len, opt, missing);
    *missing = DT_NONE;
    return DT_NOPOINT;
}

/* ---- with new points ---- */

/* Makes everything ready for the values of points that have no ids yet; work may be NULL. */
static enum dt_status make_ready(struct setting *s, const struct dt_values_of *column,
                                 struct dt_stop *work)
{
    enum dt_status status = DT_OK;
    for (size_t i = 0; i < s->ids.n && status == DT_OK; i++)
        status = isinf(s->v[i]) ? DT_RANGE : DT_OK;
    return status == DT_OK ? open_field(s, column->name, column->len, work) : status;
}

static void undo(struct setting *s, size_t n)
{
    while (n-- > 0) {
        if (s[n].created)
            dt_fields_drop(&s[n].t->fields, s[n].field);
        else
            dt_field_close(&s[n].t->fields.shelf, s[n].field, &s[n].ids);
    }
}

enum dt_status dt_add_values(struct dt *t, const struct dt_point *p, size_t n,
                             const struct dt_values_of *column, size_t columns,
                             const struct dt_options *opt, struct dt_added *out)
{
    struct setting s[DT_MAX_FIELDS];
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status status = DT_OK;
    size_t ready = 0;
    if (columns > DT_MAX_FIELDS || n > DT_NONE - t->points.next_id)
        return DT_TOOBIG;
    dt_views_edit_begin(t);
    for (; ready < columns && status == DT_OK; ready += status == DT_OK) {
        struct dt_field_ids ids = {.first = t->points.next_id, .n = n};
        s[ready] = (struct setting){.t = t, .ids = ids, .v = column[ready].values};
        status = make_ready(&s[ready], &column[ready], &work);
    }
    if (status == DT_OK)
        status = dt_update_add_many(t, p, n, opt, out);
    for (size_t i = 0; i < columns && status == DT_OK; i++)
        write_values(&s[i]);
    if (status != DT_OK)
        undo(s, ready);
    return status;
}

void dt_take_back(struct dt *t, uint32_t n)
{
    enum { PIECE = 256 };
    uint32_t ids[PIECE], first = t->points.next_id - n;
    dt_views_edit_begin(t);
    for (uint32_t at = 0, k; at < n && t->fields.n > 0; at += k) {
        for (k = 0; k < PIECE && at + k < n; k++)
            ids[k] = first + at + k;
        (void)dt_fields_take_ready(&t->fields, ids, k,
                                   NULL); /* they are ready: they were just set */
        dt_fields_take(&t->fields, ids, k);
    }
    dt_update_take_back(t, n);
}

enum dt_status dt_field_drop(struct dt *t, const char *name, size_t len)
{
    struct dt_field *field = dt_fields_find(&t->fields, name, len);
    if (field == NULL)
        return DT_NOFIELD;
    dt_views_values_begin(t);
    t->touched.values.all = t->touched.with_values;
    dt_fields_drop(&t->fields, field);
    return DT_OK;
}
