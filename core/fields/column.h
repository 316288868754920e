/* column.h - one field of a set: a double for every id, nan where it is missing.
 *
 *      field -> block[id / 32768] -> slot[id / 512 % 64] -> page: value[id % 512]
 *
 * If a block or a page does not exist, its values are missing; so memory follows the ids that have values.
 *
 * Copies of a set share pages: the first that writes to a shared page makes its own.
 *
 * Views are numbered as they begin (core/set/view.h). An edit that is about to change a page that an open view
 * reads puts it aside and continues with a copy:
 *
 *      slot -> page, since 7 -> put aside, since 4 until 7 -> put aside, since 0 until 4
 *              views 8, 9, ..            views 5, 6, 7                  views 1 to 4
 *
 * So nothing is copied while no view is open, and a page at most once for all views that are open.
 * Pages put aside are in one queue of the set, the earliest first, and go when no view reads them any more. */
#pragma once

#include "core/control/stop.h"
#include "core/delaunay_fields.h"

#define DT_FIELD_SLOTS 64u /* pages of a block */
#define DT_FIELD_BLOCK (DT_FIELD_PAGE * DT_FIELD_SLOTS)

struct dt_values {
    atomic_uint refs; /* slots and pages put aside that refer to it, of all copies of the set */
    double v[DT_FIELD_PAGE];
};

struct dt_slot {
    struct dt_values *now;  /* NULL: all values are missing */
    struct dt_aside *older; /* what was here before, NULL: nothing that is read */
    uint64_t since;         /* the views that had begun when `now` came here */
    double least, most;     /* of the values that are there; infinite if there are none */
    uint32_t n;             /* values that are there */
};

struct dt_block {
    uint32_t used; /* slots that have a page or something older */
    struct dt_slot slot[DT_FIELD_SLOTS];
};

/* A page put aside. */
struct dt_aside {
    struct dt_aside *older; /* of the same slot */
    struct dt_aside *next;  /* in the queue */
    struct dt_field *field;
    uint32_t page;
    struct dt_values *values;
    uint64_t since, until; /* views after `since`, up to `until`, see it */
};

struct dt_field {
    char name[DT_FIELD_NAME + 1];
    struct dt_block **block; /* owns `blocks` */
    uint32_t blocks;
    uint32_t values;       /* that are there */
    uint32_t number;       /* fields were made in the set before, dropped ones included */
    uint64_t edits;        /* dt_field_edits */
    atomic_uint *copies;   /* shared by the copies of the set; 1: no page is shared */
    uint64_t born, gone;   /* views after `born`, up to `gone`, see it */
    struct dt_field *next; /* among those that are dropped */
};

/* The state that the fields of a set share. Start with {0}. */
struct dt_shelf {
    struct dt_aside *first, *last; /* the queue of pages put aside; owns */
    uint64_t serial;               /* of the view that began last */
    uint64_t latest;               /* of the latest view that is read; 0: none */
    size_t memory;                 /* bytes of all fields, and of what was put aside */
    uint32_t made;                 /* fields so far */
};

static inline struct dt_slot *dt_field_slot(const struct dt_field *c, uint32_t id)
{
    uint32_t block = id / DT_FIELD_BLOCK;
    if (block >= c->blocks || c->block[block] == NULL)
        return NULL;
    return &c->block[block]->slot[id / DT_FIELD_PAGE % DT_FIELD_SLOTS];
}

/* The values of the ids around id now, DT_FIELD_PAGE of them; NULL: all are missing. */
static inline const double *dt_field_page_now(const struct dt_field *c, uint32_t id)
{
    const struct dt_slot *s = dt_field_slot(c, id);
    return s == NULL || s->now == NULL ? NULL : s->now->v;
}

/* The same at the moment of the view with that serial. */
const double *dt_field_page_then(const struct dt_field *c, uint64_t serial, uint32_t id);

/* A field without values; NULL: out of memory. */
struct dt_field *dt_field_new(struct dt_shelf *s, const char *name, size_t len);

/* Its pages in the queue must have gone. */
void dt_field_free(struct dt_shelf *s, struct dt_field *c);

/* Frees its last blocks, up to n of them; true: none is left. */
bool dt_field_free_blocks(struct dt_shelf *s, struct dt_field *c, uint32_t n);

/* A copy in another set, which shares all pages; NULL: out of memory. If it is stopped, values are missing. */
struct dt_field *dt_field_copy(struct dt_shelf *s, const struct dt_field *c, struct dt_stop *stop);

/* Makes the page of id writable. DT_NOMEM: all values are as before. */
enum dt_status dt_field_open(struct dt_shelf *s, struct dt_field *c, uint32_t id);

/* n ids: the ids of id[], or, if that is NULL, `first` and those after it. */
struct dt_field_ids {
    const uint32_t *id; /* borrows */
    uint32_t first;
    size_t n;
};

static inline uint32_t dt_field_id(const struct dt_field_ids *ids, size_t i)
{
    return ids->id != NULL ? ids->id[i] : ids->first + (uint32_t)i;
}

/* Writes the values, finite or nan, to the pages of the ids, which have been opened; v is NULL: takes them away. Of several
 * for an id the last one counts. If a page does not exist, its values are missing, and only nan may be written to it. */
void dt_field_write(struct dt_shelf *s, struct dt_field *c, const struct dt_field_ids *ids,
                    const double *v);

/* Frees the pages of these ids that are empty. */
void dt_field_close(struct dt_shelf *s, struct dt_field *c, const struct dt_field_ids *ids);

/* Frees the first page of the queue. */
void dt_shelf_free_first(struct dt_shelf *s);
