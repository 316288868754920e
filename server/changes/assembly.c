/* assembly.c - see assembly.h. The values of a column may be in several records; columns follow each other, and all have values of
 * the same ids, usually those of the points. */
#include "server/changes/assembly.h"

#include "core/delaunay_fields.h"

#include <stdlib.h>
#include <string.h>

void assembly_clear(struct assembly *s)
{
    change_clear(&s->change);
    pslg_lists_clear(&s->lists);
    buf_free(&s->values);
    reservation_set(&s->memory, 0);
    *s = (struct assembly){.pages = s->pages, .memory = s->memory};
}

/* Reserves `more` bytes beyond the present room. */
static bool reserve(struct assembly *s, size_t more)
{
    size_t constraints = s->released_cap + s->added_cap;
    size_t bytes = s->points_cap * sizeof(struct dt_point) + buf_len(&s->values) +
                   constraints * sizeof(struct record_constraint) + more;
    return s->memory.budget == NULL || reservation_resize(&s->memory, bytes);
}

/* Appends the items of the record to the *n at *items, where there is room for *cap, and which may be `most`. */
static enum assembled append(struct assembly *s, const struct record *r, void **items, uint32_t *n,
                             size_t *cap, size_t most)
{
    const size_t size = record_item_size(r->type), want = (size_t)*n + r->n;
    if (want > most)
        return ASSEMBLY_INVALID;
    if (want > *cap) {
        size_t room = want > 2 * *cap ? want : 2 * *cap;
        void *larger = reserve(s, (room - *cap) * size)
                           ? dt_pages_grow(s->pages, *items, *n * size, room * size)
                           : NULL;
        if (larger == NULL)
            return ASSEMBLY_NOMEM;
        *items = larger;
        *cap = room;
    }
    if (r->n > 0)
        record_items(r, 0, r->n, (char *)*items + *n * size);
    *n = (uint32_t)want;
    return ASSEMBLY_MORE;
}

static enum assembled take_points(struct assembly *s, const struct record *r)
{
    void *points = s->change.points;
    enum assembled how = append(s, r, &points, &s->change.n, &s->points_cap, DT_MAX_POINTS);
    s->change.points = points;
    return how;
}

static enum assembled take_constraints(struct assembly *s, const struct record *r)
{
    bool added = r->type == RECORD_CONSTRAIN;
    struct record_constraint **v = added ? &s->lists.added : &s->lists.released;
    void *items = *v;
    enum assembled how = append(s, r, &items, added ? &s->lists.n_added : &s->lists.n_released,
                                added ? &s->added_cap : &s->released_cap, DT_MAX_CONSTRAINTS);
    *v = items;
    return how;
}

/* ---- columns ---- */

static struct name *last_column(const struct assembly *s)
{
    struct columns *v = s->change.columns;
    return v == NULL ? NULL : &v->field[v->count - 1];
}

/* Another column begins. */
static enum assembled add_column(struct assembly *s, const struct record *r)
{
    struct columns *old = s->change.columns;
    size_t before = old == NULL ? 0 : old->count;
    if (before == DT_MAX_FIELDS)
        return ASSEMBLY_INVALID;
    struct columns *v = columns_new(before + 1);
    if (v == NULL)
        return ASSEMBLY_NOMEM;
    if (before > 0)
        memcpy(v->field, old->field, before * sizeof v->field[0]);
    v->field[before] = name_of(r->field, r->field_len);
    columns_free(old);
    s->change.columns = v;
    return ASSEMBLY_MORE;
}

static enum assembled take_values(struct assembly *s, const struct record *r)
{
    struct word field = {r->field, r->field_len};
    const struct name *last = last_column(s);
    if (!word_is_field_name(&field))
        return ASSEMBLY_INVALID;
    if (!reserve(s, r->n * sizeof(double)))
        return ASSEMBLY_NOMEM;
    double *to = (double *)(void *)buf_reserve(&s->values, ((size_t)r->n + 1) * sizeof *to);
    enum assembled how = ASSEMBLY_MORE;
    if (to == NULL) {
        s->values.failed = false;
        return ASSEMBLY_NOMEM;
    }
    if (last == NULL)
        s->first = r->first;
    if (last == NULL || !name_equals(last, r->field, r->field_len))
        how = add_column(s, r);
    if (how != ASSEMBLY_MORE)
        return how;
    if (r->n > 0)
        record_items(r, 0, r->n, to);
    buf_commit(&s->values, r->n * sizeof *to);
    if (s->change.columns->count == 1)
        s->n += r->n;
    return ASSEMBLY_MORE;
}

/* The values move to one array of their own. */
static enum assembled fill_columns(struct assembly *s, struct columns *v)
{
    size_t bytes = buf_len(&s->values);
    if (bytes != v->count * (size_t)s->n * sizeof(double))
        return ASSEMBLY_INVALID;
    if (v->v == NULL) /* it is there if the record has come before */
        v->v = dt_pages_grow(s->pages, NULL, 0, bytes + 1);
    if (v->v == NULL)
        return ASSEMBLY_NOMEM;
    if (bytes > 0)
        memcpy(v->v, buf_head(&s->values), bytes);
    v->first = s->first;
    v->n = s->n;
    return ASSEMBLY_DONE;
}

/* A LOAD without points sets values of a field that are too many for one record. */
static void become_run(struct change *c)
{
    const struct columns *v = c->columns;
    if (c->n > 0 || v == NULL || v->count > 1 || v->n == 0)
        return;
    c->kind = &change_kinds[CHANGE_RUN];
    c->n = v->n;
}

/* ---- constraints ---- */

static bool has_constraints(const struct assembly *s)
{
    return s->lists.n_added + s->lists.n_released > 0;
}

/* A LOAD of constraints of one type alone is that. */
static bool become_plain(struct assembly *s, struct change *c)
{
    struct pslg_lists *d = &s->lists;
    if (c->n > 0 || c->columns != NULL || (d->n_added > 0 && d->n_released > 0))
        return false;
    bool added = d->n_added > 0;
    struct record_constraint **v = added ? &d->added : &d->released;
    c->kind = &change_kinds[added ? CHANGE_CONSTRAIN : CHANGE_RELEASE];
    c->n = added ? d->n_added : d->n_released;
    c->first = 0;
    c->constraints = *v;
    *v = NULL;
    pslg_lists_clear(d);
    return true;
}

/* Gives the change the constraints. */
static enum assembled become_drawing(struct assembly *s, struct change *c)
{
    if (become_plain(s, c))
        return ASSEMBLY_DONE;
    c->pslg = pslg_new();
    if (c->pslg == NULL)
        return ASSEMBLY_NOMEM;
    c->kind = &change_kinds[CHANGE_PSLG];
    c->pslg->lists = s->lists;
    s->lists = (struct pslg_lists){0};
    return ASSEMBLY_DONE;
}

/* ---- the change ---- */

static enum assembled begin(struct assembly *s, const struct record *r)
{
    struct word set = {r->name, r->name_len};
    if (s->begun)
        return ASSEMBLY_INVALID;
    assembly_clear(s);
    s->change = (struct change){0};
    change_init(&s->change, CHANGE_ADD, &set);
    s->change.first = r->first;
    s->change.pages = s->pages;
    s->begun = true;
    return ASSEMBLY_MORE;
}

static enum assembled end(struct assembly *s, const struct record *r, struct change *c)
{
    enum assembled how = ASSEMBLY_DONE;
    uint64_t items = (uint64_t)s->change.n + s->lists.n_released + s->lists.n_added;
    if (!name_equals(&s->change.set, r->name, r->name_len) || r->n != items)
        return ASSEMBLY_INVALID;
    if (s->change.columns != NULL)
        how = fill_columns(s, s->change.columns);
    if (how != ASSEMBLY_DONE)
        return how;
    if (has_constraints(s))
        how = become_drawing(s, &s->change);
    else
        become_run(&s->change);
    if (how != ASSEMBLY_DONE)
        return how;
    *c = s->change;
    buf_free(&s->values);
    *s = (struct assembly){.pages = s->pages, .memory = s->memory};
    return ASSEMBLY_DONE;
}

enum assembled assembly_take(struct assembly *s, const struct record *r, struct change *c)
{
    if (r->type == RECORD_LOAD)
        return begin(s, r);
    if (!s->begun)
        return ASSEMBLY_INVALID;
    if (s->skips) {
        if (r->type != RECORD_LOADED)
            return ASSEMBLY_MORE;
        assembly_clear(s);
        return ASSEMBLY_ENDED;
    }
    if (r->type == RECORD_CONSTRAIN || r->type == RECORD_RELEASE)
        return take_constraints(s, r);
    if (r->type == RECORD_LOADED)
        return end(s, r, c);
    if (has_constraints(s)) /* they come last */
        return ASSEMBLY_INVALID;
    return r->type == RECORD_CHUNK ? take_points(s, r) : take_values(s, r);
}
