/* replay.c - see replay.h. The core is deterministic: the same edits in the same order give the same ids and
 * representatives; where a record contains them, they are checked. */
#include "server/disk/replay.h"

#include "core/delaunay_fields.h"

#include <stdlib.h>
#include <string.h>

static const char contradiction[] = "it contradicts what comes before it";
static const char no_memory[] = "out of memory";

struct replay_values {
    struct replay_values *next;
    char field[RECORD_FIELD_LIMIT];
    size_t field_len;
    uint32_t first, n;
    double v[];
};

void replay_init(struct replay *p)
{
    *p = (struct replay){0};
    p->values_end = &p->values;
    registry_init(&p->sets);
}

static void free_values(struct replay *p)
{
    for (struct replay_values *v = p->values, *next; v != NULL; v = next) {
        next = v->next;
        free(v);
    }
    p->values = NULL;
    p->values_end = &p->values;
}

void replay_clear(struct replay *p)
{
    free_values(p);
    registry_clear(&p->sets);
    dt_pages_release(p->points);
    free(p->id);
    free(p->representative);
    p->points = NULL;
    p->id = p->representative = NULL;
    p->n = p->cap = 0;
}

static const char *fail_memory(struct replay *p)
{
    p->out_of_memory = true;
    return no_memory;
}

static const char *fault_of(struct replay *p, enum dt_status status)
{
    if (status == DT_OK)
        return NULL;
    return status == DT_NOMEM ? fail_memory(p) : contradiction;
}

/* ---- collected points ---- */

static bool reserve_points(struct replay *p, size_t n)
{
    if (n <= p->cap - p->n)
        return true;
    size_t cap = p->n + n > 2 * p->cap ? p->n + n : 2 * p->cap;
    struct dt_point *points =
        dt_pages_grow(p->sets.pages, p->points, p->n * sizeof *points, cap * sizeof *points);
    if (points == NULL)
        return false;
    p->points = points;
    p->cap = cap;
    return true;
}

static bool collect(struct replay *p, const struct record *r)
{
    if (!reserve_points(p, r->n))
        return false;
    if (r->n == 0) /* there may be no array */
        return true;
    record_points(r, &p->points[p->n].x);
    p->n += r->n;
    return true;
}

/* The record's values; NULL: out of memory. */
static struct replay_values *read_values(const struct record *r)
{
    struct replay_values *v = malloc(sizeof *v + r->n * sizeof v->v[0]);
    if (v == NULL)
        return NULL;
    *v = (struct replay_values){.field_len = r->field_len, .first = r->first, .n = r->n};
    memcpy(v->field, r->field, r->field_len);
    record_values(r, v->v);
    return v;
}

static bool collect_values(struct replay *p, const struct record *r)
{
    struct replay_values *v = read_values(r);
    if (v == NULL)
        return false;
    *p->values_end = v;
    p->values_end = &v->next;
    return true;
}

static enum dt_status set_run(struct replay *p, struct dataset *set, const struct replay_values *v)
{
    struct dt_options opt = {.cancel = p->cancel};
    uint32_t missing;
    struct word field = {v->field, v->field_len};
    if (!word_is_field_name(&field))
        return DT_NOFIELD;
    return dt_field_set_run(set->current->dt, v->field, v->field_len, v->first, v->v, v->n, &opt,
                            &missing);
}

/* ---- the log ---- */

static struct dataset *find(struct replay *p, const struct record *r)
{
    struct word name = {r->name, r->name_len};
    return registry_find(&p->sets, &name);
}

static struct dataset *create(struct replay *p, const struct record *r, double tolerance)
{
    struct word name = {r->name, r->name_len};
    if (!word_is_set_name(&name) || !dt_coordinate_ok(tolerance) || tolerance < 0)
        return NULL;
    struct dataset *set = registry_create(&p->sets, &name, tolerance);
    p->out_of_memory = set == NULL;
    if (set != NULL)
        set->born = true;
    return set;
}

/* The record is the set's last change so far. */
static void note_change(struct replay *p, struct dataset *set, const struct record *r)
{
    set->current->lsn = r->lsn;
    set->version = p->sets.life != 0 ? registry_version(&p->sets, r->lsn) : 0;
}

/* Adds the collected points; `first` is the id of the first one. */
static const char *add_collected(struct replay *p, struct dataset *set, const struct record *r,
                                 uint32_t first)
{
    struct dataset *fresh = NULL;
    struct dt_added added;
    struct dt_options opt = {.cancel = p->cancel};
    if ((set == NULL ? 0 : dt_next_id(set->current->dt)) != first)
        return contradiction;
    if (set == NULL)
        set = fresh = create(p, r, 0);
    if (set == NULL)
        return p->out_of_memory ? no_memory : contradiction;
    enum dt_status status = dt_add_many(set->current->dt, p->points, p->n, &opt, &added);
    p->n = 0;
    if (status == DT_OK)
        note_change(p, set, r);
    else if (fresh != NULL)
        registry_drop(&p->sets, fresh);
    return fault_of(p, status);
}

static const char *apply_add(struct replay *p, struct dataset *set, const struct record *r)
{
    p->n = 0;
    return collect(p, r) ? add_collected(p, set, r, r->first) : fail_memory(p);
}

static const char *apply_loaded(struct replay *p, struct dataset *set, const struct record *r)
{
    p->in_load = false;
    if (r->n != p->n)
        return contradiction;
    const char *fault = add_collected(p, set, r, p->load_first);
    set = find(p, r);
    for (const struct replay_values *v = p->values; fault == NULL && v != NULL; v = v->next)
        fault = fault_of(p, set_run(p, set, v));
    free_values(p);
    dt_pages_release(p->points); /* it may be large, and there may be no other load */
    p->points = NULL;
    p->cap = 0;
    return fault;
}

static const char *apply_delete(struct replay *p, struct dataset *set, const struct record *r)
{
    uint32_t deleted, missing, *ids = malloc((r->n + 1) * sizeof *ids);
    if (ids == NULL)
        return fail_memory(p);
    record_ids(r, ids);
    enum dt_status status = dt_delete(set->current->dt, ids, r->n, &deleted, &missing);
    free(ids);
    return fault_of(p, status);
}

/* Sets when the set is dropped. It is not dropped here, whatever the time is: only a RECORD_DROP does that. */
static const char *apply_expire(struct replay *p, struct dataset *set, double at_ms)
{
    if (!(at_ms >= 0 && at_ms <= REPLAY_LATEST_MS))
        return contradiction;
    registry_expire(&p->sets, set, (int64_t)at_ms);
    return NULL;
}

static const char *apply_values(struct replay *p, struct dataset *set, const struct record *r)
{
    struct replay_values *v = read_values(r);
    if (v == NULL)
        return fail_memory(p);
    enum dt_status status = set_run(p, set, v);
    free(v);
    return fault_of(p, status);
}

static const char *apply_fset(struct replay *p, struct dataset *set, const struct record *r)
{
    struct word field = {r->field, r->field_len};
    uint32_t missing, *id = malloc((r->n + 1) * sizeof *id);
    double *v = malloc((r->n + 1) * sizeof *v);
    enum dt_status status = id == NULL || v == NULL ? DT_NOMEM : DT_NOFIELD;
    for (uint32_t i = 0; status != DT_NOMEM && i < r->n; i++) {
        struct record_value pair;
        record_value_at(r, i, &pair);
        id[i] = pair.id;
        v[i] = pair.value;
    }
    if (status != DT_NOMEM && word_is_field_name(&field))
        status =
            dt_field_set(set->current->dt, r->field, r->field_len, id, v, r->n, NULL, &missing);
    free(id);
    free(v);
    return fault_of(p, status);
}

/* Applies a record that needs an existing set. */
static const char *apply_existing(struct replay *p, struct dataset *set, const struct record *r)
{
    const char *fault = contradiction;
    if (set != NULL && r->type == RECORD_DROP) {
        registry_drop(&p->sets, set);
        return NULL;
    }
    if (set != NULL && r->type == RECORD_TRIANGULATE) {
        set->triangulated = true;
        fault = NULL;
    } else if (set != NULL && r->type == RECORD_DELETE) {
        fault = apply_delete(p, set, r);
    } else if (set != NULL && r->type == RECORD_EXPIRE) {
        fault = apply_expire(p, set, r->a);
    } else if (set != NULL && r->type == RECORD_MOVE) {
        fault = fault_of(p, dt_move(set->current->dt, r->first, (struct dt_point){r->a, r->b}));
    } else if (set != NULL && r->type == RECORD_VALUES) {
        fault = apply_values(p, set, r);
    } else if (set != NULL && r->type == RECORD_FSET) {
        fault = apply_fset(p, set, r);
    } else if (set != NULL && r->type == RECORD_FDROP) {
        fault = fault_of(p, dt_field_drop(set->current->dt, r->field, r->field_len));
    }
    if (fault == NULL)
        note_change(p, set, r);
    return fault;
}

static const char *apply_load(struct replay *p, const struct record *r, bool skip)
{
    if (r->type == RECORD_LOAD) {
        if (p->in_load)
            return contradiction;
        p->in_load = true;
        p->skip_load = skip;
        p->load_first = r->first;
        p->n = 0;
        return NULL;
    }
    if (!p->in_load)
        return contradiction;
    if (r->type == RECORD_CHUNK)
        return p->skip_load || collect(p, r) ? NULL : fail_memory(p);
    if (r->type == RECORD_VALUES)
        return p->skip_load || collect_values(p, r) ? NULL : fail_memory(p);
    if (p->skip_load) {
        p->in_load = false;
        return NULL;
    }
    return apply_loaded(p, find(p, r), r);
}

const char *replay_log(struct replay *p, const struct record *r)
{
    struct dataset *set = r->name_len > 0 ? find(p, r) : NULL;
    bool skip = r->lsn <= p->snapshot || (set != NULL && r->lsn <= set->current->lsn);
    bool lost = p->losses != NULL && set == NULL && !skip && !p->in_load && r->name_len > 0;
    if (lost && losses_take(p->losses, r)) {
        if (r->type != RECORD_LOAD)
            return NULL;
        skip = true;
    }
    bool of_load = r->type == RECORD_LOAD || r->type == RECORD_CHUNK || r->type == RECORD_LOADED ||
                   (r->type == RECORD_VALUES && r->name_len == 0);
    if (p->in_load && !of_load)
        return contradiction;
    if (of_load)
        return apply_load(p, r, skip);
    if (skip || r->type == RECORD_CLOSE)
        return NULL;
    if (r->type == RECORD_ADD)
        return apply_add(p, set, r);
    if (r->type != RECORD_CREATE)
        return apply_existing(p, set, r);
    set = set == NULL ? create(p, r, r->a) : NULL;
    if (set == NULL)
        return p->out_of_memory ? no_memory : contradiction;
    note_change(p, set, r);
    return NULL;
}

bool replay_in_load(const struct replay *p)
{
    return p->in_load;
}

void replay_abandon_load(struct replay *p)
{
    p->in_load = false;
    p->n = 0;
    free_values(p);
}

/* ---- the snapshot ---- */

enum { BYTES_PER_ROW = 80 }; /* of a point that is read, at the peak */

/* Whether the rows of the set, and what has been read, are within the limit; always without one. */
static bool has_room(const struct replay *p)
{
    const struct reservation *m = &p->sets.memory;
    return m->budget == NULL || budget_fits(m->budget, m->kind, (size_t)p->rows * BYTES_PER_ROW);
}

static const char *begin_set(struct replay *p, const struct record *r)
{
    struct dataset *set = find(p, r) == NULL ? create(p, r, r->a) : NULL;
    if (set == NULL)
        return p->out_of_memory ? no_memory : contradiction;
    set->current->lsn = r->synced;
    set->version = r->version;
    set->triangulated = (r->flags & RECORD_TRIANGULATED) != 0;
    p->sets_seen++;
    p->restoring = set;
    p->has_fields = (r->flags & RECORD_HAS_FIELDS) != 0;
    p->restored = false;
    p->rows = r->n;
    p->next_id = r->first;
    p->n = 0;
    if (!has_room(p))
        return fail_memory(p);
    return apply_expire(p, set, r->b);
}

/* Makes room for n more rows: ids, representatives and points have the same capacity. */
static bool reserve_rows(struct replay *p, size_t n)
{
    size_t cap = p->cap;
    if (!reserve_points(p, n))
        return false;
    if (p->id != NULL && p->representative != NULL && p->cap == cap)
        return true;
    uint32_t *id = realloc(p->id, p->cap * sizeof *id);
    if (id != NULL)
        p->id = id;
    uint32_t *representative = realloc(p->representative, p->cap * sizeof *representative);
    if (representative != NULL)
        p->representative = representative;
    return id != NULL && representative != NULL;
}

static const char *collect_rows(struct replay *p, const struct record *r)
{
    if (p->restoring == NULL || p->restored || r->n > p->rows - p->n)
        return contradiction;
    if (!reserve_rows(p, r->n))
        return fail_memory(p);
    for (uint32_t i = 0; i < r->n; i++, p->n++) {
        struct record_row row;
        record_row_at(r, i, &row);
        p->id[p->n] = row.id;
        p->representative[p->n] = row.representative;
        p->points[p->n] = (struct dt_point){row.x, row.y};
    }
    return NULL;
}

/* Counts the memory of the set. */
static const char *end_set(struct replay *p)
{
    struct dataset *set = p->restoring;
    p->restoring = NULL;
    p->rows = 0;
    version_update(&p->sets, set->current);
    return has_room(p) ? NULL : fail_memory(p);
}

static const char *restore_if_complete(struct replay *p)
{
    if (p->restoring == NULL || p->restored || p->n < p->rows)
        return NULL;
    struct dt *dt = p->restoring->current->dt;
    struct dt_options opt = {.cancel = p->cancel};
    p->restored = true;
    const char *fault =
        fault_of(p, dt_restore(dt, p->id, p->points, p->representative, p->n, p->next_id, &opt));
    return fault == NULL && !p->has_fields ? end_set(p) : fault;
}

const char *replay_snapshot(struct replay *p, const struct record *r)
{
    const char *fault = contradiction;
    if (p->ended)
        return contradiction;
    if (r->type == RECORD_SET && p->restoring == NULL)
        fault = begin_set(p, r);
    else if (r->type == RECORD_ROWS)
        fault = collect_rows(p, r);
    else if (r->type == RECORD_VALUES && p->restoring != NULL && p->restored)
        fault = apply_values(p, p->restoring, r);
    else if (r->type == RECORD_SET_END && p->restoring != NULL && p->restored)
        fault = end_set(p);
    else if (r->type == RECORD_END && p->restoring == NULL && r->n == p->sets_seen) {
        p->ended = true;
        free(p->id);
        free(p->representative);
        p->id = p->representative = NULL;
        return NULL;
    }
    return fault == NULL ? restore_if_complete(p) : fault;
}

void replay_abandon_set(struct replay *p)
{
    if (p->restoring != NULL)
        registry_drop(&p->sets, p->restoring);
    p->restoring = NULL;
    p->n = 0;
}
