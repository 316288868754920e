/* fields.c - see fields.h. */
#include "core/fields/fields.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/memory.h"

enum { AT_ONCE = 256 /* pages that a review frees */ };

void dt_fields_clear(struct dt_fields *f)
{
    while (f->shelf.first != NULL)
        dt_shelf_free_first(&f->shelf);
    for (struct dt_field *c = f->dropped, *next; c != NULL; c = next) {
        next = c->next;
        dt_field_free(&f->shelf, c);
    }
    for (uint32_t i = 0; i < f->n; i++)
        dt_field_free(&f->shelf, f->field[i]);
    free(f->field);
    *f = (struct dt_fields){.n = 0};
}

static bool make_table(struct dt_fields *f)
{
    if (f->field == NULL)
        f->field = calloc(DT_MAX_FIELDS, sizeof *f->field);
    return f->field != NULL;
}

enum dt_status dt_fields_copy(const struct dt_fields *f, struct dt_fields *copy,
                              struct dt_stop *stop)
{
    if (f->n == 0)
        return DT_OK;
    if (!make_table(copy))
        return DT_NOMEM;
    for (; copy->n < f->n; copy->n++) {
        struct dt_field *c = dt_field_copy(&copy->shelf, f->field[copy->n], stop);
        if (c == NULL) {
            dt_fields_clear(copy);
            return DT_NOMEM;
        }
        copy->field[copy->n] = c;
    }
    copy->shelf.made = f->shelf.made;
    return DT_OK;
}

/* ---- names ---- */

struct dt_field *dt_fields_find(const struct dt_fields *f, const char *name, size_t len)
{
    for (uint32_t i = 0; i < f->n && len > 0 && len <= DT_FIELD_NAME; i++)
        if (strncmp(f->field[i]->name, name, len) == 0 && f->field[i]->name[len] == '\0')
            return f->field[i];
    return NULL;
}

enum dt_status dt_fields_create(struct dt_fields *f, const char *name, size_t len,
                                struct dt_field **c)
{
    if (f->n == DT_MAX_FIELDS)
        return DT_TOOBIG;
    *c = make_table(f) ? dt_field_new(&f->shelf, name, len) : NULL;
    if (*c == NULL)
        return DT_NOMEM;
    f->field[f->n++] = *c;
    return DT_OK;
}

void dt_fields_drop(struct dt_fields *f, struct dt_field *c)
{
    uint32_t i = 0;
    while (f->field[i] != c)
        i++;
    f->field[i] = f->field[--f->n];
    bool kept = f->shelf.latest > c->born;
    for (const struct dt_aside *a = f->shelf.first; a != NULL && !kept; a = a->next)
        kept = a->field == c;
    if (!kept) {
        dt_field_free(&f->shelf, c);
        return;
    }
    struct dt_field **last = &f->dropped;
    while (*last != NULL)
        last = &(*last)->next;
    *last = c;
    c->gone = f->shelf.serial;
}

/* ---- points go ---- */

enum dt_status dt_fields_take_ready(struct dt_fields *f, const uint32_t *ids, size_t n,
                                    struct dt_stop *work)
{
    enum dt_status status = DT_OK;
    for (uint32_t k = 0; k < f->n; k++) {
        struct dt_field *c = f->field[k];
        for (size_t i = 0; i < n && status == DT_OK; i++) {
            const double *page = dt_field_page_now(c, ids[i]);
            if ((i & DT_WORK_MASK) == 0)
                status = dt_work(work, n - i < DT_WORK_BLOCK ? n - i : DT_WORK_BLOCK);
            if (status == DT_OK && page != NULL)
                status = dt_field_open(&f->shelf, c, ids[i]);
            if (status == DT_OK && page != NULL && i < DT_AHEAD)
                dt_fetch(&dt_field_page_now(c, ids[i])[ids[i] % DT_FIELD_PAGE]);
        }
    }
    return status;
}

void dt_fields_take(struct dt_fields *f, const uint32_t *ids, size_t n)
{
    struct dt_field_ids gone = {.id = ids, .n = n};
    for (uint32_t k = 0; k < f->n; k++)
        dt_field_write(&f->shelf, f->field[k], &gone, NULL);
}

/* ---- what was kept for views ---- */

/* Frees some blocks of the first field that is dropped, and in the end the field. */
static void free_dropped(struct dt_fields *f)
{
    struct dt_field *c = f->dropped;
    if (!dt_field_free_blocks(&f->shelf, c, AT_ONCE / DT_FIELD_SLOTS))
        return;
    f->dropped = c->next;
    dt_field_free(&f->shelf, c);
}

bool dt_fields_review(struct dt_fields *f, uint64_t serial, uint64_t latest, uint64_t oldest)
{
    struct dt_shelf *s = &f->shelf;
    int n = 0;
    s->serial = serial;
    s->latest = latest;
    for (; n < AT_ONCE && s->first != NULL && s->first->until < oldest; n++)
        dt_shelf_free_first(s);
    if (n < AT_ONCE && f->dropped != NULL && f->dropped->gone < oldest &&
        (s->first == NULL || s->first->until > f->dropped->gone)) {
        free_dropped(f);
        n++;
    }
    return n > 0;
}
