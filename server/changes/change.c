/* change.c - the table of the kinds of changes, and their records. */
#include "server/changes/change.h"

#include "core/delaunay_fields.h"
#include "server/changes/constraint.h"

#include <stdlib.h>

/* ---- what the kinds do ---- */

/* The rows become points and columns of values. */
static bool split_rows(struct change *c)
{
    struct columns *v = c->columns;
    size_t width = 2 + v->count;
    c->points = dt_pages_grow(c->pages, NULL, 0, ((size_t)c->n + 1) * sizeof *c->points);
    v->v = dt_pages_grow(c->pages, NULL, 0, (c->n * v->count + 1) * sizeof *v->v);
    if (c->points == NULL || v->v == NULL)
        return false;
    for (size_t i = 0; i < c->n; i++) {
        const double *row = c->rows + i * width;
        c->points[i] = (struct dt_point){row[0], row[1]};
        for (size_t k = 0; k < v->count; k++)
            v->v[k * c->n + i] = row[2 + k];
    }
    v->n = c->n;
    dt_pages_release(c->rows);
    c->rows = NULL;
    return true;
}

static enum dt_status set_runs(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    const struct columns *v = c->columns;
    enum dt_status status = DT_OK;
    for (size_t k = 0; k < v->count && status == DT_OK; k++)
        status = dt_field_set_run(dt, v->field[k].text, v->field[k].len, v->first,
                                  columns_values(v, k), v->n, opt, &c->missing);
    return status;
}

/* Of records: the values need not be those of the new points alone. */
static enum dt_status add_and_set(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    enum dt_status status = dt_add_many(dt, c->points, c->n, opt, &c->added);
    return status == DT_OK ? set_runs(dt, c, opt) : status;
}

static enum dt_status add_points(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    struct dt_values_of column[DT_MAX_FIELDS];
    struct columns *v = c->columns;
    if (v == NULL)
        return dt_add_many(dt, c->points, c->n, opt, &c->added);
    if (v->v != NULL && v->n != c->n)
        return add_and_set(dt, c, opt);
    if (c->rows != NULL && !split_rows(c))
        return DT_NOMEM;
    for (size_t k = 0; k < v->count; k++)
        column[k] = (struct dt_values_of){v->field[k].text, v->field[k].len, columns_values(v, k)};
    enum dt_status status = dt_add_values(dt, c->points, c->n, column, v->count, opt, &c->added);
    v->first = c->added.first;
    return status;
}

static enum dt_status delete_points(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    return dt_delete_many(dt, c->ids, c->n, opt, &c->deleted, &c->missing);
}

static enum dt_status move_point(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    c->missing = c->first;
    return dt_move_to(dt, c->first, (struct dt_point){c->a, c->b}, opt);
}

static enum dt_status move_points(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    struct dt_point *to = malloc((c->n + 1) * (sizeof *to + sizeof(uint32_t)));
    uint32_t *id = (uint32_t *)(void *)(to + c->n);
    for (uint32_t i = 0; to != NULL && i < c->n; i++) {
        id[i] = c->moves[i].id;
        to[i] = (struct dt_point){c->moves[i].x, c->moves[i].y};
    }
    enum dt_status status =
        to == NULL ? DT_NOMEM : dt_move_many(dt, id, to, c->n, opt, &c->missing);
    free(to);
    return status;
}

static enum dt_status delete_ends(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    return dt_delete_cascade(dt, c->ids, c->n, opt, &c->deleted, &c->missing);
}

/* Returns which fields of the columns exist: bit k. */
static uint64_t fields_there(const struct dt *dt, const struct columns *v)
{
    uint64_t there = 0;
    for (size_t k = 0; v != NULL && k < v->count; k++)
        if (dt_field_find(dt, v->field[k].text, v->field[k].len) != NULL)
            there |= (uint64_t)1 << k;
    return there;
}

/* The points go, and the fields that came with them. */
static void take_back(struct dt *dt, const struct change *c, uint64_t there)
{
    const struct columns *v = c->columns;
    dt_take_back(dt, c->n);
    for (size_t k = 0; v != NULL && k < v->count; k++)
        if ((there >> k & 1) == 0)
            (void)dt_field_drop(dt, v->field[k].text, v->field[k].len);
}

/* A change that has points or constraints of one type alone becomes a change of that type, as its records mean. */
static void become_plain(struct change *c)
{
    struct pslg_lists *v = &c->pslg->lists;
    bool points = c->n > 0 || c->columns != NULL || c->pslg->loads;
    if (points && v->n_released + v->n_added == 0)
        c->kind = &change_kinds[CHANGE_ADD];
    if (points || (v->n_released > 0) == (v->n_added > 0))
        return;
    bool added = v->n_added > 0;
    c->kind = &change_kinds[added ? CHANGE_CONSTRAIN : CHANGE_RELEASE];
    c->first = 0;
    c->n = added ? v->n_added : v->n_released;
    dt_pages_release(c->points);
    c->constraints = added ? v->added : v->released;
    *(added ? &v->added : &v->released) = NULL;
}

static enum dt_status draw(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    const uint64_t there = fields_there(dt, c->columns);
    c->added = (struct dt_added){.first = dt_next_id(dt)};
    enum dt_status status = c->n > 0 || c->columns != NULL ? add_points(dt, c, opt) : DT_OK;
    if (status != DT_OK)
        return status;
    struct pslg_points p = {c->points, c->n, c->columns};
    status = pslg_edit(dt, c->pslg, &p, c->pages, opt, &c->missing);
    c->crossed = c->pslg->crossed;
    if (status != DT_OK) {
        if (opt == NULL || !opt->disposable)
            take_back(dt, c, there);
        return status;
    }
    c->added.added += p.n - c->n;
    c->points = p.points;
    c->n = p.n;
    c->columns = p.columns;
    if (c->columns != NULL)
        c->columns->first = c->added.first;
    become_plain(c);
    return DT_OK;
}

/* The rows become constraints. */
static bool split_pairs(struct change *c)
{
    const uint32_t *id = (const uint32_t *)(const void *)c->rows;
    if (c->rows == NULL)
        return true;
    c->constraints = dt_pages_grow(c->pages, NULL, 0, ((size_t)c->n + 1) * sizeof *c->constraints);
    for (size_t i = 0; c->constraints != NULL && i < c->n; i++)
        c->constraints[i] = (struct record_constraint){id[2 * i], id[2 * i + 1], c->first};
    if (c->constraints == NULL)
        return false;
    dt_pages_release(c->rows);
    c->rows = NULL;
    c->first = 0;
    return true;
}

static enum dt_status declare(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    if (!split_pairs(c))
        return DT_NOMEM;
    return constraint_declare(dt, c->constraints, c->n, opt, &c->constrained, &c->missing);
}

static enum dt_status release(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    size_t *released = &c->constrained;
    if (!split_pairs(c))
        return DT_NOMEM;
    struct dt_constraint *missing = &c->crossed.one;
    return c->a == RELEASE_LISTED
               ? constraint_release(dt, c->constraints, c->n, opt, released, missing)
               : constraint_release_of(dt, c->a == RELEASE_ALL, c->first, opt, released, missing);
}

static enum dt_status set_values(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    enum { FEW = 8 };
    double few[FEW + FEW / 2] = {0}, *v = few;
    if (c->n > FEW)
        v = malloc(c->n * (sizeof *v + sizeof(uint32_t)));
    if (v == NULL)
        return DT_NOMEM;
    uint32_t *id = (uint32_t *)(void *)(v + c->n);
    for (uint32_t i = 0; i < c->n; i++) {
        id[i] = c->pairs[i].id;
        v[i] = c->pairs[i].value;
    }
    enum dt_status status =
        dt_field_set(dt, c->field.text, c->field.len, id, v, c->n, opt, &c->missing);
    if (v != few)
        free(v);
    return status;
}

static enum dt_status drop_field(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    return dt_field_drop(dt, c->field.text, c->field.len);
}

static void note_expiry(struct registry *r, struct dataset *set, const struct change *c)
{
    registry_expire(r, set, (int64_t)c->a);
}

static void note_triangulation(struct registry *r, struct dataset *set, const struct change *c)
{
    set->triangulated = true;
}

const struct change_kind change_kinds[CHANGE_KINDS] = {
    [CHANGE_CREATE] = {.record = RECORD_CREATE, .flags = CHANGE_NEW},
    [CHANGE_DROP] = {.record = RECORD_DROP, .flags = CHANGE_EXISTING | CHANGE_FREES},
    [CHANGE_EXPIRE] = {.record = RECORD_EXPIRE, .flags = CHANGE_EXISTING, .note = note_expiry},
    [CHANGE_ADD] = {.record = RECORD_ADD,
                    .what = "adding points",
                    .flags = CHANGE_GROWS,
                    .items = ITEMS_POINTS,
                    .undone = "",
                    .edit = add_points},
    [CHANGE_DELETE] = {.record = RECORD_DELETE,
                       .what = "deleting points",
                       .flags = CHANGE_EXISTING | CHANGE_FREES,
                       .items = ITEMS_IDS,
                       .undone = "; nothing was deleted",
                       .edit = delete_points},
    [CHANGE_MOVE] = {.record = RECORD_MOVE,
                     .what = "moving a point",
                     .flags = CHANGE_EXISTING,
                     .undone = "",
                     .edit = move_point},
    [CHANGE_SET] = {.record = RECORD_FSET,
                    .flags = CHANGE_EXISTING,
                    .items = ITEMS_PAIRS,
                    .has_field = true,
                    .undone = "; no value was set",
                    .edit = set_values},
    [CHANGE_RUN] = {.record = RECORD_VALUES,
                    .flags = CHANGE_EXISTING,
                    .items = ITEMS_COLUMN,
                    .undone = "; no value was set",
                    .edit = set_runs},
    [CHANGE_FDROP] = {.record = RECORD_FDROP,
                      .flags = CHANGE_EXISTING | CHANGE_FREES,
                      .has_field = true,
                      .edit = drop_field},
    [CHANGE_TRIANGULATE] = {.record = RECORD_TRIANGULATE,
                            .what = "triangulating",
                            .flags = CHANGE_EXISTING,
                            .note = note_triangulation},
    [CHANGE_CONSTRAIN] = {.record = RECORD_CONSTRAIN,
                          .what = "declaring constraints",
                          .flags = CHANGE_EXISTING,
                          .items = ITEMS_CONSTRAINTS,
                          .undone = "; nothing was declared",
                          .edit = declare},
    [CHANGE_RELEASE] = {.record = RECORD_RELEASE,
                        .what = "releasing constraints",
                        .flags = CHANGE_EXISTING | CHANGE_FREES,
                        .items = ITEMS_CONSTRAINTS,
                        .edit = release},
    [CHANGE_CASCADE] = {.record = RECORD_CASCADE,
                        .what = "deleting points",
                        .flags = CHANGE_EXISTING | CHANGE_FREES,
                        .items = ITEMS_IDS,
                        .undone = "; nothing was deleted",
                        .edit = delete_ends},
    [CHANGE_MOVES] = {.record = RECORD_MOVES,
                      .what = "moving points",
                      .flags = CHANGE_EXISTING,
                      .items = ITEMS_MOVES,
                      .undone = ", or it is named twice; nothing was moved",
                      .edit = move_points},
    [CHANGE_PSLG] = {.what = "declaring constraints",
                     .flags = CHANGE_GROWS,
                     .items = ITEMS_PSLG,
                     .undone = "; nothing was declared",
                     .edit = draw},
};

enum dt_status change_edit(struct dt *dt, struct change *c, const struct dt_options *opt)
{
    enum dt_status status = c->kind->edit(dt, c, opt);
    if (status == DT_CROSSES && c->kind->items != ITEMS_PSLG)
        dt_crossed(dt, &c->crossed);
    if (status == DT_OK && (c->kind->flags & CHANGE_GROWS) != 0)
        c->first = c->added.first;
    return status;
}

/* ---- their life ---- */

void change_init(struct change *c, enum change_code code, const struct word *set)
{
    c->kind = &change_kinds[code];
    c->set = name_of(set->text, set->len);
}

void change_set_rows(struct change *c, double *rows)
{
    if (c->columns != NULL)
        c->rows = rows;
    else
        c->points = (struct dt_point *)(void *)rows;
}

double change_tolerance(const struct change *c)
{
    return (c->kind->flags & CHANGE_NEW) != 0 ? c->a : 0;
}

bool change_is_void(const struct change *c)
{
    const struct pslg *d = c->pslg;
    if (d != NULL)
        return !d->loads && c->n + d->lists.n_released + d->declared == 0;
    return c->kind->items == ITEMS_CONSTRAINTS && c->constrained == 0;
}

static const struct item_kind {
    size_t size; /* bytes of an item */
    bool paged;  /* from dt_pages_grow, else from malloc */
} item_kinds[] = {
    [ITEMS_NONE] = {0, true},
    [ITEMS_POINTS] = {sizeof(struct dt_point), true},
    [ITEMS_IDS] = {sizeof(uint32_t), false},
    [ITEMS_PAIRS] = {sizeof(struct record_value), false},
    [ITEMS_COLUMN] = {sizeof(double), true},
    [ITEMS_CONSTRAINTS] = {sizeof(struct record_constraint), true},
    [ITEMS_MOVES] = {sizeof(struct record_move), false},
    [ITEMS_PSLG] = {sizeof(struct dt_point), true},
};

void change_clear(struct change *c)
{
    if (c->kind == NULL || item_kinds[c->kind->items].paged)
        dt_pages_release(c->items);
    else
        free(c->items);
    dt_pages_release(c->rows);
    columns_free(c->columns);
    pslg_free(c->pslg);
    c->items = NULL;
    c->rows = NULL;
    c->columns = NULL;
    c->pslg = NULL;
}

const char *change_contradiction(const struct change *c, const struct dataset *set)
{
    unsigned flags = c->kind->flags;
    if (set == NULL && (flags & CHANGE_EXISTING) != 0)
        return "there is no such set";
    if (set != NULL && (flags & CHANGE_NEW) != 0)
        return "the set exists already";
    uint32_t next = set == NULL ? 0 : dt_next_id(set->current->dt);
    if ((flags & CHANGE_GROWS) != 0 && c->first != CHANGE_ANY && c->first != next)
        return "its first id is not the next one here";
    return NULL;
}

/* ---- records ---- */

/* The kind of change that a record alone is; NULL: it is none, or a part of a LOAD. */
static const struct change_kind *kind_of(const struct record *r)
{
    for (size_t i = CHANGE_NONE + 1; i < CHANGE_KINDS; i++)
        if (change_kinds[i].record == r->type && r->name_len > 0)
            return &change_kinds[i];
    return NULL;
}

bool change_is_part(const struct record *r)
{
    return r->type == RECORD_LOAD || r->type == RECORD_CHUNK || r->type == RECORD_LOADED ||
           (r->name_len == 0 &&
            (r->type == RECORD_VALUES || r->type == RECORD_CONSTRAIN || r->type == RECORD_RELEASE));
}

/* Decodes the items into the array; NULL: false, out of memory. */
static bool decode(const struct record *r, void *items)
{
    if (items != NULL)
        record_items(r, 0, r->n, items);
    return items != NULL;
}

static bool take_column(struct change *c, const struct record *r)
{
    struct columns *v = c->columns = columns_new(1);
    if (v == NULL)
        return false;
    v->first = r->first;
    v->n = r->n;
    v->field[0] = name_of(r->field, r->field_len);
    v->v = dt_pages_grow(c->pages, NULL, 0, ((size_t)r->n + 1) * sizeof *v->v);
    return decode(r, v->v);
}

static bool take_items(struct change *c, const struct record *r)
{
    const struct item_kind *of = &item_kinds[c->kind->items];
    const size_t bytes = ((size_t)r->n + 1) * of->size;
    if (c->kind->items == ITEMS_COLUMN)
        return take_column(c, r);
    if (bytes > 0)
        c->items = of->paged ? dt_pages_grow(c->pages, NULL, 0, bytes) : malloc(bytes);
    return bytes == 0 || decode(r, c->items);
}

static bool is_possible(const struct change_kind *kind, const struct record *r)
{
    struct word set = {r->name, r->name_len}, field = {r->field, r->field_len};
    if (!word_is_set_name(&set))
        return false;
    if ((kind->has_field || kind->items == ITEMS_COLUMN) && !word_is_field_name(&field))
        return false;
    if (r->type == RECORD_CREATE)
        return dt_coordinate_ok(r->a) && r->a >= 0;
    return r->type != RECORD_EXPIRE || (r->a >= 0 && r->a <= CHANGE_LATEST_MS);
}

enum dt_status change_decode(struct change *c, const struct record *r, struct dt_pages *pages)
{
    const struct change_kind *kind = kind_of(r);
    *c = (struct change){.kind = kind, .pages = pages};
    if (kind == NULL || !is_possible(kind, r))
        return DT_RANGE;
    c->set = name_of(r->name, r->name_len);
    c->first = r->first;
    c->n = r->n;
    c->a = r->a;
    c->b = r->b;
    if (kind->has_field)
        c->field = name_of(r->field, r->field_len);
    if (take_items(c, r))
        return DT_OK;
    change_clear(c);
    return DT_NOMEM;
}

struct record change_encode(const struct change *c)
{
    const struct columns *v = c->columns;
    struct record r = {.type = c->kind->record,
                       .first = c->first,
                       .n = c->kind->items == ITEMS_NONE ? 0 : c->n,
                       .a = c->a,
                       .b = c->b,
                       .name = c->set.text,
                       .name_len = c->set.len,
                       .field = c->field.text,
                       .field_len = c->field.len,
                       .items = c->items};
    if (c->kind->items == ITEMS_COLUMN) {
        r.first = v->first;
        r.n = v->n;
        r.field = v->field[0].text;
        r.field_len = v->field[0].len;
        r.items = v->v;
    }
    return r;
}

bool change_is_long(const struct change *c)
{
    if (c->kind->items == ITEMS_COLUMN)
        return c->columns->n > RECORD_MOST_VALUES;
    if (c->kind->items == ITEMS_CONSTRAINTS)
        return c->n > RECORD_CONSTRAINTS;
    if (c->kind->items == ITEMS_PSLG)
        return true;
    return c->kind->items == ITEMS_POINTS && (c->columns != NULL || c->n > RECORD_POINTS);
}
