/* replay.c - see replay.h. The core is deterministic: the same edits in the same order give the same ids and
 * representatives; where a record contains them, they are checked. */
#include "server/disk/replay.h"

#include <stdlib.h>

enum { ROWS_AT_ONCE = 128 }; /* of a snapshot that are decoded together */

static const char contradiction[] = "it contradicts what comes before it";
static const char no_memory[] = "out of memory";

void replay_init(struct replay *p)
{
    *p = (struct replay){0};
    registry_init(&p->sets);
}

static void free_rows(struct replay *p)
{
    dt_pages_release(p->points);
    free(p->id);
    free(p->representative);
    p->points = NULL;
    p->id = p->representative = NULL;
    p->n = p->cap = 0;
}

void replay_clear(struct replay *p)
{
    assembly_clear(&p->load);
    free_rows(p);
    registry_clear(&p->sets);
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

static struct dataset *find(struct replay *p, const struct record *r)
{
    struct word name = {r->name, r->name_len};
    return registry_find(&p->sets, &name);
}

/* Creates a new set; returns the fault, or NULL. */
static const char *create(struct replay *p, const struct change *c, struct dataset **set)
{
    struct word name = name_word(&c->set);
    *set = registry_create(&p->sets, &name, change_tolerance(c));
    if (*set == NULL)
        return fail_memory(p);
    (*set)->born = true;
    return NULL;
}

/* ---- the log ---- */

static const char *apply(struct replay *p, struct dataset *set, struct change *c, uint64_t lsn)
{
    struct dt_options opt = {.cancel = p->cancel};
    struct dataset *fresh = NULL;
    if (change_contradiction(c, set) != NULL)
        return contradiction;
    if (c->kind == &change_kinds[CHANGE_DROP]) {
        registry_drop(&p->sets, set);
        return NULL;
    }
    const char *fault = set == NULL ? create(p, c, &fresh) : NULL;
    if (fault != NULL)
        return fault;
    set = set == NULL ? fresh : set;
    if (c->kind->edit != NULL)
        fault = fault_of(p, change_edit(set->current->dt, c, &opt));
    if (fault != NULL && fresh != NULL)
        registry_drop(&p->sets, fresh);
    if (fault != NULL)
        return fault;
    if (c->kind->note != NULL)
        c->kind->note(&p->sets, set, c);
    set->current->lsn = lsn;
    set->version = p->sets.life != 0 ? registry_version(&p->sets, lsn) : 0;
    return NULL;
}

/* A record of a LOAD, which takes effect with its last one. skip: it is not wanted. */
static const char *take_part(struct replay *p, const struct record *r, bool skip)
{
    struct change c;
    p->load.pages = p->sets.pages;
    switch (assembly_take(&p->load, r, &c)) {
    case ASSEMBLY_MORE:
        p->load.skips |= skip && r->type == RECORD_LOAD;
        return NULL;
    case ASSEMBLY_ENDED:
        return NULL;
    case ASSEMBLY_NOMEM:
        return fail_memory(p);
    case ASSEMBLY_INVALID:
        return contradiction;
    case ASSEMBLY_DONE:
        break;
    }
    const char *fault = apply(p, find(p, r), &c, r->lsn);
    change_clear(&c);
    return fault;
}

const char *replay_log(struct replay *p, const struct record *r)
{
    struct dataset *set = r->name_len > 0 ? find(p, r) : NULL;
    bool skip = r->lsn <= p->snapshot || (set != NULL && r->lsn <= set->current->lsn);
    bool lost = p->losses != NULL && set == NULL && !skip && !p->load.begun && r->name_len > 0;
    if (lost && losses_take(p->losses, r)) {
        if (r->type != RECORD_LOAD)
            return NULL;
        skip = true;
    }
    if (change_is_part(r))
        return take_part(p, r, skip);
    if (p->load.begun)
        return contradiction;
    if (skip || r->type == RECORD_CLOSE)
        return NULL;
    struct change c;
    enum dt_status status = change_decode(&c, r, p->sets.pages);
    const char *fault = status == DT_OK ? apply(p, set, &c, r->lsn) : fault_of(p, status);
    change_clear(&c);
    return fault;
}

bool replay_in_load(const struct replay *p)
{
    return p->load.begun;
}

void replay_abandon_load(struct replay *p)
{
    assembly_clear(&p->load);
}

/* ---- the snapshot ---- */

enum { BYTES_PER_ROW = 80 }; /* of a point that is read, at the peak */

/* Whether the rows of the set, and what has been read, are within the limit; always without one. */
static bool has_room(const struct replay *p)
{
    const struct budget *b = p->sets.budget;
    return b == NULL || budget_fits(b, BUDGET_SETS, (size_t)p->rows * BYTES_PER_ROW);
}

static const char *begin_set(struct replay *p, const struct record *r)
{
    struct word name = {r->name, r->name_len};
    bool possible = word_is_set_name(&name) && dt_coordinate_ok(r->a) && r->a >= 0 && r->b >= 0 &&
                    r->b <= CHANGE_LATEST_MS;
    if (!possible || find(p, r) != NULL)
        return contradiction;
    struct dataset *set = registry_create(&p->sets, &name, r->a);
    if (set == NULL)
        return fail_memory(p);
    set->born = true;
    registry_expire(&p->sets, set, (int64_t)r->b);
    set->current->lsn = r->synced;
    set->version = r->version;
    set->triangulated = (r->flags & RECORD_TRIANGULATED) != 0;
    p->sets_seen++;
    p->restoring = set;
    p->has_more = (r->flags & (RECORD_HAS_FIELDS | RECORD_HAS_CONSTRAINTS)) != 0;
    p->restored = false;
    p->rows = r->n;
    p->next_id = r->first;
    p->n = 0;
    return has_room(p) ? NULL : fail_memory(p);
}

/* Makes room for n more rows: ids, representatives and points have the same capacity. */
static bool reserve_rows(struct replay *p, size_t n)
{
    if (n <= p->cap - p->n)
        return true;
    size_t cap = p->n + n > 2 * p->cap ? p->n + n : 2 * p->cap;
    struct dt_point *points =
        dt_pages_grow(p->sets.pages, p->points, p->n * sizeof *points, cap * sizeof *points);
    if (points != NULL)
        p->points = points;
    uint32_t *id = realloc(p->id, cap * sizeof *id);
    if (id != NULL)
        p->id = id;
    uint32_t *representative = realloc(p->representative, cap * sizeof *representative);
    if (representative != NULL)
        p->representative = representative;
    if (points == NULL || id == NULL || representative == NULL)
        return false;
    p->cap = cap;
    return true;
}

/* Values or constraints of the set that is being read. */
static const char *restore_more(struct replay *p, const struct record *r)
{
    struct dt_options opt = {.cancel = p->cancel};
    struct change c;
    struct record run = *r; /* the set's name is in RECORD_SET alone */
    run.name = p->restoring->name;
    run.name_len = p->restoring->name_len;
    enum dt_status status = change_decode(&c, &run, p->sets.pages);
    if (status == DT_OK)
        status = change_edit(p->restoring->current->dt, &c, &opt);
    change_clear(&c);
    return fault_of(p, status);
}

static const char *collect_rows(struct replay *p, const struct record *r)
{
    if (p->restoring == NULL || p->restored || r->n > p->rows - p->n)
        return contradiction;
    if (!reserve_rows(p, r->n))
        return fail_memory(p);
    for (uint32_t i = 0, n; i < r->n; i += n) {
        struct record_row row[ROWS_AT_ONCE];
        n = r->n - i < ROWS_AT_ONCE ? r->n - i : ROWS_AT_ONCE;
        record_items(r, i, n, row);
        for (uint32_t k = 0; k < n; k++, p->n++) {
            p->id[p->n] = row[k].id;
            p->representative[p->n] = row[k].representative;
            p->points[p->n] = (struct dt_point){row[k].x, row[k].y};
        }
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
    return fault == NULL && !p->has_more ? end_set(p) : fault;
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
    else if ((r->type == RECORD_VALUES || r->type == RECORD_CONSTRAIN) && p->restoring != NULL &&
             p->restored)
        fault = restore_more(p, r);
    else if (r->type == RECORD_SET_END && p->restoring != NULL && p->restored)
        fault = end_set(p);
    else if (r->type == RECORD_END && p->restoring == NULL && r->n == p->sets_seen) {
        p->ended = true;
        free_rows(p);
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
