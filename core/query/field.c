/* field.c - queries of fields: the fields of a set, and their values now and at the moments of views. */
#include "core/delaunay_fields.h"

#include <math.h>
#include <string.h>

#include "core/set/set.h"

const char *dt_field_name(const struct dt_field *f)
{
    return f->name;
}

uint32_t dt_field_number(const struct dt_field *f)
{
    return f->number;
}

uint64_t dt_field_edits(const struct dt_field *f)
{
    return f->edits;
}

uint32_t dt_field_count(const struct dt_field *f)
{
    return f->values;
}

const struct dt_field *dt_field_find(const struct dt *t, const char *name, size_t len)
{
    return dt_fields_find(&t->fields, name, len);
}

/* Whether the field was there when the view began. */
static bool is_of(const struct dt_field *c, uint64_t serial)
{
    return c->born < serial && serial <= c->gone;
}

/* The serial of the view. The present has a serial after all views. */
static uint64_t serial_of(const struct dt_view *v)
{
    return v == NULL ? UINT64_MAX : v->serial;
}

/* c if it follows f by name, and comes before `best`. */
static const struct dt_field *nearer(const struct dt_field *f, const struct dt_field *best,
                                     const struct dt_field *c)
{
    if ((f != NULL && strcmp(c->name, f->name) <= 0) ||
        (best != NULL && strcmp(c->name, best->name) >= 0))
        return best;
    return c;
}

const struct dt_field *dt_field_next(const struct dt *t, const struct dt_view *v,
                                     const struct dt_field *f)
{
    const struct dt_field *best = NULL;
    for (uint32_t i = 0; i < t->fields.n; i++)
        if (is_of(t->fields.field[i], serial_of(v)))
            best = nearer(f, best, t->fields.field[i]);
    for (const struct dt_field *c = t->fields.dropped; v != NULL && c != NULL; c = c->next)
        if (is_of(c, v->serial))
            best = nearer(f, best, c);
    return best;
}

void dt_field_summary(const struct dt_field *f, struct dt_field_summary *out)
{
    double least = (double)INFINITY, most = (double)-INFINITY;
    for (uint32_t i = 0; i < f->blocks; i++) {
        const struct dt_block *b = f->block[i];
        for (uint32_t k = 0; b != NULL && k < DT_FIELD_SLOTS; k++) {
            least = b->slot[k].least < least ? b->slot[k].least : least;
            most = b->slot[k].most > most ? b->slot[k].most : most;
        }
    }
    bool none = f->values == 0;
    *out = (struct dt_field_summary){f->name, f->values, none ? (double)NAN : least,
                                     none ? (double)NAN : most};
}

void dt_field_values(const struct dt_field *f, const struct dt_view *v, const uint32_t *ids,
                     size_t n, double *out)
{
    for (size_t i = 0; i < n; i++) {
        const double *page = dt_field_page_then(f, serial_of(v), ids[i]);
        out[i] = page == NULL ? (double)NAN : page[ids[i] % DT_FIELD_PAGE];
    }
}

const double *dt_field_page(const struct dt_field *f, const struct dt_view *v, uint64_t *from)
{
    uint64_t end = (uint64_t)f->blocks * DT_FIELD_BLOCK, id = *from;
    while (id < end) {
        const double *page = dt_field_page_then(f, serial_of(v), (uint32_t)id);
        *from = id;
        if (page != NULL)
            return page;
        bool block = f->block[id / DT_FIELD_BLOCK] != NULL;
        id += block ? DT_FIELD_PAGE : DT_FIELD_BLOCK - id % DT_FIELD_BLOCK;
    }
    return NULL;
}
