/* column.c - see column.h. */
#include "core/fields/column.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory/memory.h"

/* ---- memory ---- */

static void *take(struct dt_shelf *s, size_t bytes)
{
    void *p = malloc(bytes);
    s->memory += p != NULL ? bytes : 0;
    return p;
}

static void give(struct dt_shelf *s, void *p, size_t bytes)
{
    free(p);
    s->memory -= p != NULL ? bytes : 0;
}

static struct dt_values *new_values(struct dt_shelf *s)
{
    struct dt_values *v = take(s, sizeof *v);
    if (v != NULL)
        atomic_init(&v->refs, 1);
    return v;
}

/* One reference to the page less. */
static void release(struct dt_shelf *s, struct dt_values *v)
{
    s->memory -= v != NULL ? sizeof *v : 0;
    if (v != NULL && atomic_fetch_sub(&v->refs, 1) == 1)
        free(v);
}

/* ---- life ---- */

struct dt_field *dt_field_new(struct dt_shelf *s, const char *name, size_t len)
{
    struct dt_field *c = take(s, sizeof *c);
    atomic_uint *copies = malloc(sizeof *copies);
    if (c == NULL || copies == NULL) {
        free(copies);
        give(s, c, sizeof *c);
        return NULL;
    }
    atomic_init(copies, 1);
    *c = (struct dt_field){
        .number = s->made++, .copies = copies, .born = s->serial, .gone = UINT64_MAX};
    memcpy(c->name, name, len);
    return c;
}

bool dt_field_free_blocks(struct dt_shelf *s, struct dt_field *c, uint32_t n)
{
    for (; c->blocks > 0 && n > 0; n--) {
        struct dt_block *b = c->block[--c->blocks];
        for (uint32_t i = 0; b != NULL && i < DT_FIELD_SLOTS; i++)
            release(s, b->slot[i].now);
        give(s, b, sizeof *b);
        s->memory -= sizeof(struct dt_block *);
    }
    return c->blocks == 0;
}

void dt_field_free(struct dt_shelf *s, struct dt_field *c)
{
    dt_field_free_blocks(s, c, UINT32_MAX);
    dt_array_free(c->block);
    if (atomic_fetch_sub(c->copies, 1) == 1)
        free(c->copies);
    give(s, c, sizeof *c);
}

/* Makes the table of blocks longer. */
static enum dt_status reserve_blocks(struct dt_shelf *s, struct dt_field *c, uint32_t blocks)
{
    if (blocks <= c->blocks)
        return DT_OK;
    if (!dt_array_resize(NULL, &c->block, c->blocks, blocks, sizeof(struct dt_block *)))
        return DT_NOMEM;
    for (uint32_t i = c->blocks; i < blocks; i++)
        c->block[i] = NULL;
    s->memory += (blocks - c->blocks) * sizeof(struct dt_block *);
    c->blocks = blocks;
    return DT_OK;
}

static struct dt_block *new_block(struct dt_shelf *s)
{
    struct dt_block *b = take(s, sizeof *b);
    if (b == NULL)
        return NULL;
    b->used = 0;
    for (uint32_t i = 0; i < DT_FIELD_SLOTS; i++)
        b->slot[i] = (struct dt_slot){.least = (double)INFINITY, .most = (double)-INFINITY};
    return b;
}

/* The copy has no views, so it needs nothing that was put aside. */
static void copy_block(struct dt_shelf *s, const struct dt_block *from, struct dt_block *to)
{
    for (uint32_t i = 0; i < DT_FIELD_SLOTS; i++) {
        if (from->slot[i].now == NULL)
            continue;
        to->slot[i] = from->slot[i];
        to->slot[i].older = NULL;
        to->slot[i].since = 0;
        to->used++;
        atomic_fetch_add(&to->slot[i].now->refs, 1);
        s->memory += sizeof(struct dt_values);
    }
}

struct dt_field *dt_field_copy(struct dt_shelf *s, const struct dt_field *c, struct dt_stop *stop)
{
    struct dt_field *copy = dt_field_new(s, c->name, strlen(c->name));
    if (copy == NULL)
        return NULL;
    free(copy->copies);
    copy->copies = c->copies;
    atomic_fetch_add(copy->copies, 1);
    copy->values = c->values;
    copy->number = c->number;
    copy->edits = c->edits;
    if (reserve_blocks(s, copy, c->blocks) != DT_OK) {
        dt_field_free(s, copy);
        return NULL;
    }
    for (uint32_t i = 0; i < c->blocks && !dt_stopped(stop); i++) {
        if (c->block[i] == NULL)
            continue;
        copy->block[i] = new_block(s);
        if (copy->block[i] == NULL) {
            dt_field_free(s, copy);
            return NULL;
        }
        copy_block(s, c->block[i], copy->block[i]);
    }
    return copy;
}

/* ---- earlier moments ---- */

const double *dt_field_page_then(const struct dt_field *c, uint64_t serial, uint32_t id)
{
    const struct dt_slot *s = dt_field_slot(c, id);
    if (s == NULL)
        return NULL;
    if (s->since < serial)
        return s->now == NULL ? NULL : s->now->v;
    const struct dt_aside *a = s->older;
    while (a != NULL && a->since >= serial)
        a = a->older;
    return a == NULL || a->until < serial ? NULL : a->values->v;
}

/* Whether an open view reads the page that is there now. */
static bool is_read(const struct dt_shelf *s, const struct dt_slot *slot)
{
    return slot->now != NULL && s->latest > slot->since;
}

static bool is_shared(const struct dt_field *c, const struct dt_slot *slot)
{
    return slot->now != NULL && atomic_load(c->copies) > 1 && atomic_load(&slot->now->refs) > 1;
}

/* Puts the page of the slot aside for views; its reference moves. */
static bool put_aside(struct dt_shelf *s, struct dt_field *c, uint32_t page, struct dt_slot *slot)
{
    struct dt_aside *a = take(s, sizeof *a);
    if (a == NULL)
        return false;
    *a = (struct dt_aside){
        slot->older, NULL, c, page, slot->now, slot->since, s->serial,
    };
    slot->older = a;
    if (s->first == NULL)
        s->first = a;
    else
        s->last->next = a;
    s->last = a;
    return true;
}

static void leave_block(struct dt_shelf *s, struct dt_field *c, uint32_t id)
{
    struct dt_block **b = &c->block[id / DT_FIELD_BLOCK];
    if (--(*b)->used > 0)
        return;
    give(s, *b, sizeof **b);
    *b = NULL;
}

/* Frees the page of id if it is empty. */
static void close_page(struct dt_shelf *s, struct dt_field *c, uint32_t id)
{
    struct dt_slot *slot = dt_field_slot(c, id);
    if (slot == NULL || slot->now == NULL || slot->n > 0 || slot->older != NULL)
        return;
    release(s, slot->now);
    slot->now = NULL;
    leave_block(s, c, id);
}

void dt_shelf_free_first(struct dt_shelf *s)
{
    struct dt_aside *a = s->first;
    uint32_t id = a->page * DT_FIELD_PAGE;
    struct dt_slot *slot = dt_field_slot(a->field, id);
    struct dt_aside **at = &slot->older;
    while (*at != a)
        at = &(*at)->older;
    *at = a->older;
    s->first = a->next;
    if (slot->now == NULL && slot->older == NULL)
        leave_block(s, a->field, id);
    else
        close_page(s, a->field, id);
    release(s, a->values);
    give(s, a, sizeof *a);
}

/* ---- writing ---- */

static enum dt_status open_slot(struct dt_shelf *s, struct dt_field *c, uint32_t page,
                                struct dt_slot *slot)
{
    struct dt_values *fresh = new_values(s);
    if (fresh == NULL)
        return DT_NOMEM;
    if (slot->now == NULL)
        for (uint32_t i = 0; i < DT_FIELD_PAGE; i++)
            fresh->v[i] = (double)NAN;
    else
        memcpy(fresh->v, slot->now->v, sizeof fresh->v);
    if (!is_read(s, slot)) {
        release(s, slot->now);
    } else if (!put_aside(s, c, page, slot)) {
        release(s, fresh);
        return DT_NOMEM;
    }
    slot->now = fresh;
    slot->since = s->serial;
    return DT_OK;
}

enum dt_status dt_field_open(struct dt_shelf *s, struct dt_field *c, uint32_t id)
{
    uint32_t block = id / DT_FIELD_BLOCK;
    struct dt_slot *slot = dt_field_slot(c, id);
    if (slot != NULL && slot->now != NULL && !is_read(s, slot) && !is_shared(c, slot))
        return DT_OK;
    if (reserve_blocks(s, c, block + 1) != DT_OK)
        return DT_NOMEM;
    if (c->block[block] == NULL && (c->block[block] = new_block(s)) == NULL)
        return DT_NOMEM;
    struct dt_block *b = c->block[block];
    slot = dt_field_slot(c, id);
    b->used += slot->now == NULL && slot->older == NULL;
    enum dt_status status = open_slot(s, c, id / DT_FIELD_PAGE, slot);
    if (status != DT_OK && slot->now == NULL && slot->older == NULL)
        leave_block(s, c, id);
    return status;
}

/* There is one nan, and no -0. */
static double normal(double v)
{
    return isnan(v) ? (double)NAN : v + 0.0;
}

/* The number of ids from number i on that are in one page. */
static size_t run_at(const struct dt_field_ids *ids, size_t i)
{
    uint32_t id = dt_field_id(ids, i);
    size_t most = ids->n - i, room = DT_FIELD_PAGE - id % DT_FIELD_PAGE, k = 1;
    if (ids->id == NULL)
        return most < room ? most : room;
    while (k < most && ids->id[i + k] / DT_FIELD_PAGE == id / DT_FIELD_PAGE)
        k++;
    return k;
}

static void find_extremes(struct dt_slot *slot)
{
    const double *v = slot->now->v;
    double least = (double)INFINITY, most = (double)-INFINITY;
    for (uint32_t i = 0; i < DT_FIELD_PAGE; i++) { /* a nan is neither less nor greater */
        least = v[i] < least ? v[i] : least;
        most = v[i] > most ? v[i] : most;
    }
    slot->least = least;
    slot->most = most;
}

/* Writes the values of the ids from number i up to `end`, which are in one page. */
static void write_run(struct dt_field *c, struct dt_slot *slot, const struct dt_field_ids *ids,
                      size_t i, size_t end, const double *v)
{
    double *page = slot->now->v, least = slot->least, most = slot->most;
    uint32_t n = slot->n;
    bool extreme = false; /* has been overwritten */
    for (; i < end; i++) {
        double *at = &page[dt_field_id(ids, i) % DT_FIELD_PAGE], old = *at;
        *at = v == NULL ? (double)NAN : normal(v[i]);
        extreme |= old == least || old == most;
        n += (uint32_t)(*at == *at) - (uint32_t)(old == old);
        least = *at < least ? *at : least;
        most = *at > most ? *at : most;
    }
    c->values += n - slot->n;
    slot->n = n;
    slot->least = least;
    slot->most = most;
    if (extreme)
        find_extremes(slot);
}

void dt_field_write(struct dt_shelf *s, struct dt_field *c, const struct dt_field_ids *ids,
                    const double *v)
{
    c->edits++;
    for (size_t i = 0, end; i < ids->n; i = end) {
        struct dt_slot *slot = dt_field_slot(c, dt_field_id(ids, i));
        end = i + run_at(ids, i);
        if (slot != NULL && slot->now != NULL)
            write_run(c, slot, ids, i, end, v);
    }
    dt_field_close(s, c, ids);
}

void dt_field_close(struct dt_shelf *s, struct dt_field *c, const struct dt_field_ids *ids)
{
    for (size_t i = 0; i < ids->n; i += run_at(ids, i))
        close_page(s, c, dt_field_id(ids, i));
}
