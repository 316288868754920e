/* declared.h - the constraints that have been declared: pairs of ids with a kind and a number.
 *
 * A row is in a list at each of its ends, and a hash table finds it by what it is:
 *
 *      first: id -> a row          row    next[end], prev[end]: the rows before and after it in the list of that end
 *      table: what it is -> row; the entry has four bits of a hash, too, so that few rows are looked at in vain
 *
 * In memory: 28 bytes a row, up to 8 of the table, and 4 for each id that is an end. Knows nothing of meshes. */
#pragma once

#include "core/control/stop.h"
#include "core/delaunay_constraints.h"
#include "core/points/idmap.h"

#include <stdlib.h>

struct dt_declared_row {
    uint32_t end[2]; /* ids, ascending; end[0] == DT_NONE: free, and next[0] is the next free row */
    uint32_t what;   /* number << 1 | border */
    uint32_t next[2], prev[2]; /* DT_NONE: none */
};

/* Start with {0}, or with a keeper, here and in `first`. */
struct dt_declared {
    struct dt_pages *pages;      /* borrows; where its arrays come from; NULL: the system */
    struct dt_declared_row *row; /* owns `cap` */
    uint32_t rows, end, cap;     /* live rows; rows 0 .. end - 1 are live or free */
    uint32_t borders;            /* of the live rows */
    uint32_t free_list;          /* with free rows */
    uint32_t *table; /* owns `places`: hash bits, row; DT_NONE if free; linear probing */
    uint32_t places;
    struct dt_idmap first; /* id -> a row at that end */
};

/* It keeps its keeper. */
void dt_declared_clear(struct dt_declared *d);
enum dt_status dt_declared_copy(const struct dt_declared *d, struct dt_declared *copy);
size_t dt_declared_memory(const struct dt_declared *d);

/* Makes room for n rows more. */
enum dt_status dt_declared_reserve(struct dt_declared *d, size_t n);

/* The row, DT_NONE if there is none. The ids of c are in any order. */
uint32_t dt_declared_find(const struct dt_declared *d, const struct dt_constraint *c);

/* Fetches what dt_declared_find and dt_declared_add of c will read. */
void dt_declared_fetch(const struct dt_declared *d, const struct dt_constraint *c);

/* Adds a row that is not there and for which there is room. *row: its number. DT_NOMEM: unchanged. */
enum dt_status dt_declared_add(struct dt_declared *d, const struct dt_constraint *c, uint32_t *row);

/* Removes a live row. */
void dt_declared_remove(struct dt_declared *d, uint32_t row);

/* Returns the constraint of a row. */
struct dt_constraint dt_declared_get(const struct dt_declared *d, uint32_t row);

/* The rows at an end, one after the other, DT_NONE at the end. */
static inline uint32_t dt_declared_first(const struct dt_declared *d, uint32_t id)
{
    return d->rows == 0 ? DT_NONE : dt_idmap_get(&d->first, id);
}

static inline uint32_t dt_declared_next(const struct dt_declared *d, uint32_t row, uint32_t id)
{
    const struct dt_declared_row *r = &d->row[row];
    return r->next[r->end[0] != id];
}

static inline bool dt_declared_is_live(const struct dt_declared *d, uint32_t row)
{
    return d->row[row].end[0] != DT_NONE;
}

/* The same constraint, its smaller id first. */
static inline struct dt_constraint dt_constraint_ascending(struct dt_constraint c)
{
    return c.a < c.b ? c : (struct dt_constraint){c.b, c.a, c.border, c.number};
}

/* Whether it is one of n, which are sorted. */
static inline bool dt_constraint_among(const struct dt_constraint *c, size_t n,
                                       const struct dt_constraint *key)
{
    return n > 0 && bsearch(key, c, n, sizeof *c, dt_constraint_compare) != NULL;
}

/* Appends one; DT_NOMEM leaves the list as it was. Cost: constant, amortised. */
enum dt_status dt_constraint_append(struct dt_constraint_list *list, struct dt_constraint c);
