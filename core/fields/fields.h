/* fields.h - the fields of a set: named columns of values (column.h), and what edits have put aside for views. */
#pragma once

#include "core/control/stop.h"
#include "core/fields/column.h"

/* Start with {0}. */
struct dt_fields {
    struct dt_field **field; /* owns n, in no order; room for DT_MAX_FIELDS; NULL: never had one */
    uint32_t n;
    struct dt_field *dropped; /* owns; those that views still read, the earliest first */
    struct dt_shelf shelf;
};

/* No view is open. */
void dt_fields_clear(struct dt_fields *f);

static inline size_t dt_fields_memory(const struct dt_fields *f)
{
    return f->shelf.memory + (f->field == NULL ? 0 : DT_MAX_FIELDS * sizeof *f->field);
}

/* A copy for a copy of the set: *copy is {0}. DT_NOMEM: it is cleared. If it is stopped, values are missing. */
enum dt_status dt_fields_copy(const struct dt_fields *f, struct dt_fields *copy,
                              struct dt_stop *stop);

/* The field of that name, NULL if there is none. */
struct dt_field *dt_fields_find(const struct dt_fields *f, const char *name, size_t len);

/* A new field in *c; its name is a new one. DT_TOOBIG: there are DT_MAX_FIELDS already. */
enum dt_status dt_fields_create(struct dt_fields *f, const char *name, size_t len,
                                struct dt_field **c);
void dt_fields_drop(struct dt_fields *f, struct dt_field *c);

/* Makes dt_fields_take of these ids certain to succeed, and fetches what it will read. */
enum dt_status dt_fields_take_ready(struct dt_fields *f, const uint32_t *ids, size_t n,
                                    struct dt_stop *work);

/* The values of n ascending ids go. */
void dt_fields_take(struct dt_fields *f, const uint32_t *ids, size_t n);

/* Whether something may have been kept for views. */
static inline bool dt_fields_keep(const struct dt_fields *f)
{
    return f->shelf.first != NULL || f->dropped != NULL;
}

/* Takes note of the views: the serials of the last one, and of the latest and the oldest that are read (0 and
 * UINT64_MAX if none is). Frees some of the pages that no view reads. Returns whether something was freed. */
bool dt_fields_review(struct dt_fields *f, uint64_t serial, uint64_t latest, uint64_t oldest);
