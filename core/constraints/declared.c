/* declared.c - see declared.h. */
#include "core/constraints/declared.h"

#include <string.h>

#include "core/memory/memory.h"

enum { ROW_BITS = 28 }; /* of DT_MAX_CONSTRAINTS */

void dt_declared_clear(struct dt_declared *d)
{
    dt_array_free(d->row);
    dt_array_free(d->table);
    dt_idmap_clear(&d->first);
    *d = (struct dt_declared){.pages = d->pages, .first = d->first};
}

size_t dt_declared_memory(const struct dt_declared *d)
{
    return d->cap * sizeof *d->row + d->places * sizeof *d->table + dt_idmap_memory(&d->first);
}

enum dt_status dt_declared_copy(const struct dt_declared *d, struct dt_declared *copy)
{
    struct dt_declared c = {
        .pages = d->pages, .rows = d->rows, .borders = d->borders, .end = d->end};
    c.free_list = d->free_list;
    c.first.keeper = d->pages;
    if (d->rows == 0) {
        *copy = c;
        return DT_OK;
    }
    c.row = dt_array_new_in(d->pages, d->end, sizeof *c.row);
    c.table = dt_array_new_in(d->pages, d->places, sizeof *c.table);
    if (c.row == NULL || c.table == NULL || dt_idmap_copy(&d->first, &c.first, NULL) != DT_OK) {
        dt_declared_clear(&c);
        return DT_NOMEM;
    }
    memcpy(c.row, d->row, d->end * sizeof *c.row);
    memcpy(c.table, d->table, d->places * sizeof *c.table);
    c.cap = d->end;
    c.places = d->places;
    *copy = c;
    return DT_OK;
}

/* ---- the table ---- */

static uint64_t hash(const struct dt_declared_row *r)
{
    uint64_t key = ((uint64_t)r->end[0] << 32 | r->end[1]) * 0x9e3779b97f4a7c15u;
    return (key ^ key >> 32 ^ (uint64_t)r->what << 16) * 0xd6e8feb86659fd93u;
}

/* The place, among `places`, at which the search for a row begins. */
static uint32_t home(const struct dt_declared_row *r, uint32_t places)
{
    return (uint32_t)((hash(r) >> 32) * places >> 32);
}

/* The tag that the table has beside the number of a row: 0 to 14, so that no entry is DT_NONE. */
static uint32_t tag(const struct dt_declared_row *r)
{
    return (uint32_t)((hash(r) & 0xff) * 15 >> 8) << ROW_BITS;
}

static uint32_t row_at(const struct dt_declared *d, uint32_t place)
{
    return d->table[place] == DT_NONE ? DT_NONE : d->table[place] & ((1u << ROW_BITS) - 1);
}

static uint32_t following(const struct dt_declared *d, uint32_t place)
{
    return place + 1 < d->places ? place + 1 : 0;
}

static bool equal(const struct dt_declared_row *a, const struct dt_declared_row *b)
{
    return a->end[0] == b->end[0] && a->end[1] == b->end[1] && a->what == b->what;
}

/* The place of the row, or a free place in which it could be. */
static uint32_t place_of(const struct dt_declared *d, const struct dt_declared_row *r)
{
    uint32_t i = home(r, d->places), own = tag(r);
    while (d->table[i] != DT_NONE &&
           (d->table[i] >> ROW_BITS != own >> ROW_BITS || !equal(&d->row[row_at(d, i)], r)))
        i = following(d, i);
    return i;
}

static enum dt_status grow_table(struct dt_declared *d, size_t rows)
{
    size_t places = rows + rows / 3 + 16;
    if (places <= d->places)
        return DT_OK;
    uint32_t *table = dt_array_new_in(d->pages, places, sizeof *table);
    if (table == NULL)
        return DT_NOMEM;
    dt_array_free(d->table);
    d->table = table;
    d->places = (uint32_t)places;
    for (size_t i = 0; i < places; i++)
        table[i] = DT_NONE;
    for (uint32_t i = 0; i < d->end; i++)
        if (dt_declared_is_live(d, i))
            table[place_of(d, &d->row[i])] = tag(&d->row[i]) | i;
    return DT_OK;
}

enum dt_status dt_declared_reserve(struct dt_declared *d, size_t n)
{
    size_t rows = d->rows + n, end = n + d->rows > d->end ? n + d->rows : d->end;
    if (rows > DT_MAX_CONSTRAINTS)
        return DT_TOOBIG;
    if (end > d->cap) {
        size_t cap = n > d->rows / 2 ? end : dt_array_room(d->cap, end, DT_MAX_CONSTRAINTS);
        if (!dt_array_resize(d->pages, &d->row, d->end, cap, sizeof *d->row))
            return DT_NOMEM;
        d->cap = (uint32_t)cap;
    }
    size_t room = d->places - d->places / 4;
    return rows + 12 <= room ? DT_OK : grow_table(d, n > d->rows / 2 ? rows : rows + rows / 2);
}

static struct dt_declared_row row_of(const struct dt_constraint *c)
{
    struct dt_constraint k = dt_constraint_ascending(*c);
    return (struct dt_declared_row){.end = {k.a, k.b}, .what = k.number << 1 | k.border};
}

uint32_t dt_declared_find(const struct dt_declared *d, const struct dt_constraint *c)
{
    struct dt_declared_row r = row_of(c);
    return d->rows == 0 ? DT_NONE : row_at(d, place_of(d, &r));
}

void dt_declared_fetch(const struct dt_declared *d, const struct dt_constraint *c)
{
    struct dt_declared_row r = row_of(c);
    if (d->places > 0)
        dt_fetch(&d->table[home(&r, d->places)]);
    dt_idmap_fetch(&d->first, c->a);
    dt_idmap_fetch(&d->first, c->b);
}

/* Frees a place, and moves rows after it that would no longer be found [Knuth, TAOCP 3, sec. 6.4, algorithm R]. */
static void leave_table(struct dt_declared *d, uint32_t hole)
{
    uint32_t i = hole, n = d->places;
    for (;;) {
        d->table[hole] = DT_NONE;
        uint32_t from;
        do {
            i = following(d, i);
            if (d->table[i] == DT_NONE)
                return;
            from = home(&d->row[row_at(d, i)], n);
        } while ((i + n - from) % n < (i + n - hole) % n);
        d->table[hole] = d->table[i];
        hole = i;
    }
}

/* ---- the lists ---- */

static void enter_list(struct dt_declared *d, uint32_t row, int which)
{
    struct dt_declared_row *r = &d->row[row];
    uint32_t next = dt_idmap_get(&d->first, r->end[which]);
    r->prev[which] = DT_NONE;
    r->next[which] = next;
    if (next != DT_NONE)
        d->row[next].prev[d->row[next].end[0] != r->end[which]] = row;
    dt_idmap_set(&d->first, r->end[which], row);
}

static void leave_list(struct dt_declared *d, uint32_t row, int which)
{
    struct dt_declared_row *r = &d->row[row];
    uint32_t id = r->end[which], next = r->next[which], prev = r->prev[which];
    if (next != DT_NONE)
        d->row[next].prev[d->row[next].end[0] != id] = prev;
    if (prev != DT_NONE)
        d->row[prev].next[d->row[prev].end[0] != id] = next;
    else if (next != DT_NONE)
        dt_idmap_set(&d->first, id, next);
    else
        dt_idmap_unset(&d->first, id);
}

enum dt_status dt_declared_add(struct dt_declared *d, const struct dt_constraint *c, uint32_t *row)
{
    struct dt_declared_row r = row_of(c);
    if (dt_idmap_reserve(&d->first, r.end[0], 1) != DT_OK ||
        dt_idmap_reserve(&d->first, r.end[1], 1) != DT_OK)
        return DT_NOMEM;
    bool reused = d->rows < d->end;
    *row = reused ? d->free_list : d->end++;
    if (reused)
        d->free_list = d->row[*row].next[0];
    d->row[*row] = r;
    d->table[place_of(d, &r)] = tag(&r) | *row;
    d->rows++;
    d->borders += r.what & 1;
    enter_list(d, *row, 0);
    enter_list(d, *row, 1);
    return DT_OK;
}

void dt_declared_remove(struct dt_declared *d, uint32_t row)
{
    struct dt_declared_row *r = &d->row[row];
    leave_table(d, place_of(d, r));
    leave_list(d, row, 0);
    leave_list(d, row, 1);
    d->borders -= r->what & 1;
    if (d->rows == d->end && row + 1 == d->end) {
        d->end--;
    } else {
        r->end[0] = DT_NONE;
        r->next[0] = d->free_list;
        d->free_list = row;
    }
    if (--d->rows == 0)
        dt_declared_clear(d);
    else
        dt_idmap_trim(&d->first);
}

/* ---- what rows are ---- */

struct dt_constraint dt_declared_get(const struct dt_declared *d, uint32_t row)
{
    const struct dt_declared_row *r = &d->row[row];
    return (struct dt_constraint){r->end[0], r->end[1], (r->what & 1) != 0, r->what >> 1};
}

enum dt_status dt_constraint_append(struct dt_constraint_list *list, struct dt_constraint c)
{
    return dt_items_append(&list->v, &list->n, &list->cap, &c, sizeof c);
}

int dt_constraint_compare(const void *p, const void *q)
{
    const struct dt_constraint *a = p, *b = q;
    if (a->a != b->a)
        return a->a < b->a ? -1 : 1;
    if (a->b != b->b)
        return a->b < b->b ? -1 : 1;
    if (a->border != b->border)
        return a->border ? 1 : -1;
    return (a->number > b->number) - (a->number < b->number);
}
