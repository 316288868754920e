/* submit.c - see submit.h. */
#include "server/jobs/submit.h"

#include "core/delaunay_fields.h"
#include "server/changes/constraint.h"
#include "server/jobs/durable.h"
#include "server/jobs/page_cache.h"
#include "server/jobs/upkeep.h"
#include "server/ops/cost.h"
#include "server/ops/limits.h"

#include <stdlib.h>

/* ---- the log ---- */

void submit_commit(struct server *s, struct dataset *set, struct change *c)
{
    if (c->kind->note != NULL)
        c->kind->note(&s->sets, set, c);
    if (c->lsn == 0)
        durable_append(durable_log_of(s, set), set, c);
    set->current->lsn = c->lsn;
    registry_set_version(&s->sets, set, registry_version(&s->sets, c->lsn));
}

/* A snapshot that pins the set now does not have its DROP, so the lsn is not the set's. */
static void drop(struct server *s, struct dataset *set, struct change *c)
{
    durable_append(durable_log_of(s, set), set, c);
    if (!set->temporary)
        s->dropped = c->lsn;
    registry_drop(&s->sets, set);
}

void submit_at_once(struct server *s, struct dataset *set, enum change_code code, double a)
{
    struct change c = {0};
    change_init(&c, code, &(struct word){set->name, set->name_len});
    c.a = a;
    if (code == CHANGE_DROP)
        drop(s, set, &c);
    else
        submit_commit(s, set, &c);
}

/* ---- memory ---- */

enum {
    BYTES_PER_POINT = 104, /* of memory for an added point */
    BYTES_PER_PAGE = DT_FIELD_PAGE * sizeof(double) + 128
};

/* Peak memory to add n points to a set, NULL for a new one; if the triangulation is left for later, that
 * includes it. */
static size_t memory_to_add(const struct server *s, const struct dataset *set, size_t n)
{
    struct dt_options options = job_options(s);
    if (cost_at_once(COST_EDIT, n) || set == NULL)
        return n * BYTES_PER_POINT;
    return dt_add_memory(set->current->dt, n, &options);
}

/* The most that the values of n ids that follow each other take. */
static size_t memory_of_run(size_t n)
{
    return n == 0 ? 0 : (n / DT_FIELD_PAGE + 2) * BYTES_PER_PAGE;
}

/* The same for values that come with points; and they are copied from their rows, with the points. */
static size_t memory_of_columns(size_t n, size_t columns)
{
    return columns == 0 ? 0 : columns * memory_of_run(n) + n * (2 + columns) * sizeof(double);
}

/* The most that n values of a set can take: each a page. */
static size_t memory_of_pairs(const struct dataset *set, size_t n)
{
    size_t pages = dt_next_id(set->current->dt) / DT_FIELD_PAGE + 1;
    return (n < pages ? n : pages) * BYTES_PER_PAGE;
}

static bool fits(struct server *s, struct answer *a, size_t bytes)
{
    return budget_fits(&s->budget, BUDGET_EDITS, bytes) || server_refuse(s, a, bytes);
}

static bool reserve_points(struct server *s, struct answer *a, const struct dataset *set,
                           struct submission *x)
{
    size_t n = x->change.n, columns = x->change.columns == NULL ? 0 : x->change.columns->count;
    uint32_t points = set != NULL ? set->current->sum.points : 0;
    uint32_t most = a->of_leader ? DT_MAX_POINTS : s->config->max_points;
    if (points > most || n > most - points)
        return answer_err(a, ERR_TOOBIG, "a set holds at most %u points (--max-points)", most);
    size_t bytes = memory_to_add(s, set, n) + memory_of_columns(n, columns);
    return cost_at_once(COST_EDIT, n) ? fits(s, a, bytes)
                                      : server_reserve(s, a, &x->job.memory, bytes);
}

static bool reserve_constraints(struct server *s, struct answer *a, const struct dataset *set,
                                struct submission *x)
{
    const struct dt *dt = set->current->dt;
    const struct change *c = &x->change;
    bool listed = c->a == RELEASE_LISTED;
    size_t bytes = c->kind == &change_kinds[CHANGE_CONSTRAIN]
                       ? constraint_declare_memory(dt, c->n)
                       : constraint_release_memory(dt, listed ? c->n : DT_NONE);
    return listed && cost_at_once(COST_EDIT, c->n) ? fits(s, a, bytes)
                                                   : server_reserve(s, a, &x->job.memory, bytes);
}

/* A PSLG: memory for what a split does beyond that. On any thread. */
static enum dt_status reserve_more(void *ctx, size_t bytes)
{
    struct submission *x = ctx;
    if (x->base == 0)
        x->base = x->job.memory.bytes + 1;
    return job_reserve(&x->job, x->base + bytes);
}

/* The rows of its constraints, as they are asked for and as the core takes them. */
static size_t memory_of_lists(const struct pslg_lists *v)
{
    size_t n = (size_t)v->n_released + v->n_added;
    return n * (sizeof(struct dt_constraint) + sizeof *v->added + sizeof(uint64_t));
}

/* What the points take, which may be none, and the constraints. */
static bool reserve_drawing(struct server *s, struct answer *a, const struct dataset *set,
                            struct submission *x)
{
    struct pslg *d = x->change.pslg;
    const struct pslg_lists *v = &d->lists;
    uint32_t points = set == NULL ? 0 : set->current->sum.points;
    if (!reserve_points(s, a, set, x))
        return false;
    size_t n = (size_t)v->n_released + v->n_added, bytes = x->job.memory.bytes;
    struct dt_options options = job_options(s);
    bool refreshes = set != NULL && version_is_stale(set->current);
    bytes += memory_of_lists(v) + (d->loads ? x->change.n * sizeof(struct dt_point) : 0) +
             (set == NULL ? 0 : dt_constrain_memory(set->current->dt, n)) +
             (refreshes ? dt_build_memory(set->current->dt, &options) : 0);
    d->most = s->config->max_points - points - x->change.n;
    d->reserve = reserve_more;
    d->ctx = x;
    return !refreshes && cost_at_once(COST_EDIT, n) ? fits(s, a, bytes)
                                                    : server_reserve(s, a, &x->job.memory, bytes);
}

size_t submit_memory_of_new(const struct server *s, const struct change *c)
{
    size_t columns = c->columns == NULL ? 0 : c->columns->count;
    size_t bytes = memory_to_add(s, NULL, c->n) + memory_of_columns(c->n, columns);
    return c->pslg == NULL ? bytes : bytes + memory_of_lists(&c->pslg->lists);
}

bool submit_reserve(struct server *s, struct answer *a, const struct dataset *set,
                    struct submission *x)
{
    x->job.memory = server_reservation(s, BUDGET_EDITS);
    switch (x->change.kind->items) {
    case ITEMS_POINTS:
        return reserve_points(s, a, set, x);
    case ITEMS_PAIRS:
        return fits(s, a, memory_of_pairs(set, x->change.n));
    case ITEMS_COLUMN:
        return server_reserve(s, a, &x->job.memory, memory_of_run(x->change.n));
    case ITEMS_CONSTRAINTS:
        return reserve_constraints(s, a, set, x);
    case ITEMS_PSLG:
        return reserve_drawing(s, a, set, x);
    case ITEMS_NONE:
    case ITEMS_IDS:
    case ITEMS_MOVES:
        break;
    }
    return true;
}

/* ---- new sets ---- */

/* A new, empty, unborn set; NULL: the ERR line has been written. */
static struct dataset *create(struct server *s, struct answer *a, struct submission *x)
{
    struct word name = name_word(&x->change.set);
    if (s->sets.sets >= LIMIT_SETS && !a->of_leader) {
        answer_err(a, ERR_TOOBIG, "a server holds at most %d sets", LIMIT_SETS);
        return NULL;
    }
    struct dataset *set = registry_create(&s->sets, &name, change_tolerance(&x->change));
    if (set == NULL) {
        answer_out_of_memory(a);
    } else if (x->temporary != NULL) {
        set->temporary = true;
        list_prepend(
            x->temporary,
            &set->fellow); /* dropped from the newest on: so the heap shrinks in small steps */
    }
    return set;
}

/* ---- edits, which are jobs ---- */

static struct change *change_of_job(struct job *j)
{
    return &((struct submission *)j)->change;
}

static void run(struct job *j)
{
    struct change *c = change_of_job(j);
    j->status = change_edit(j->dt, c, &j->options);
    if (j->copies && j->fresh != NULL && j->status == DT_OK) {
        j->status = dt_refresh(j->dt, &j->options);
        if (j->status == DT_OK)
            dt_prepare(j->dt, &j->options); /* without memory for the grid, searches take longer */
    }
}

/* Of a PSLG: what it has added, declared and split. */
static void answer_drawing(struct answer *a, const struct change *c)
{
    const struct pslg *d = c->pslg;
    if (d->thins) {
        reply_key_u64(a->out, "points", c->added.added);
        reply_key_u64(a->out, "constraints", d->declared);
        reply_key_double(a->out, "error", d->error);
        return;
    }
    reply_key_u64(a->out, "first", c->added.first);
    reply_key_u64(a->out, "added", c->added.added);
    if (d->loads) {
        reply_key_u64(a->out, "coincident", c->added.coincident);
        reply_key_u64(a->out, "constraints", d->declared);
    }
    if (d->asked || d->refines)
        reply_key_u64(a->out, "split", d->split);
    if (d->asked)
        reply_key_double(a->out, "deviation", d->deviation);
    if (d->refines) {
        reply_key_double(a->out, "angle", d->angle);
        reply_key_u64(a->out, "unrefined", d->unrefined);
        reply_key_u64(a->out, "hull", d->hull);
    }
}

/* Writes the status line of a change that has been carried out, up to its version. */
static void answer_facts(struct answer *a, const struct change *c)
{
    reply_ok(a->out, 0);
    if (c->pslg != NULL)
        answer_drawing(a, c);
    else if ((c->kind->flags & CHANGE_GROWS) != 0) {
        reply_key_u64(a->out, "first", c->added.first);
        reply_key_u64(a->out, "added", c->added.added);
        reply_key_u64(a->out, "coincident", c->added.coincident);
    } else if (c->kind->items == ITEMS_IDS) {
        reply_key_u64(a->out, "deleted", c->deleted);
    } else if (c->kind->items == ITEMS_CONSTRAINTS) {
        bool declared = c->kind == &change_kinds[CHANGE_CONSTRAIN];
        reply_key_u64(a->out, declared ? "added" : "released", c->constrained);
    }
}

/* Whether constraints do not allow the change; then the error has been written. */
static bool answer_constraint(struct answer *a, enum dt_status status, const struct change *c)
{
    const struct dt_constraint *one = &c->crossed.one;
    const char *kind = one->border ? "border" : "line";
    const struct pslg *d = c->pslg;
    if (d != NULL && d->refines && (status == DT_NOREGION || status == DT_OPEN))
        return !answer_region(a, status, d->quality.number);
    if (status == DT_CROSSES)
        answer_crosses(a, &c->crossed, d != NULL && d->counts ? "constraint" : "line",
                       d == NULL ? NULL : d->crossed_line);
    else if (status == DT_CONSTRAINED)
        answer_err(a, ERR_CONSTRAINED,
                   "point %u is an end of a constraint: RELEASE it, or DEL set id CASCADE",
                   c->missing);
    else if (status == DT_NOEDGE)
        answer_err(a, ERR_SYNTAX, "the constraint %u %u has one end only", c->missing, c->missing);
    else if (status == DT_TOOBIG && c->kind == &change_kinds[CHANGE_CONSTRAIN])
        answer_err(a, ERR_TOOBIG, "a set has at most %u constraints", DT_MAX_CONSTRAINTS);
    else if (status == DT_NOCONSTRAINT && one->a == DT_NONE)
        answer_err(a, ERR_NOCONSTRAINT, "there is no %s of number %u", kind, one->number);
    else if (status == DT_NOCONSTRAINT)
        answer_err(a, ERR_NOCONSTRAINT, "there is no %s %u %u of number %u", kind, one->a, one->b,
                   one->number);
    return a->refused;
}

/* A reactor that shares the world leaves the set's grid to the next edit (submit_shares). It leaves the watchers of the set to
 * the end of its turn, when it is alone once for all its edits. */
static void after_edit(struct server *s, struct answer *a, struct dataset *set)
{
    if (!answer_shares(a)) {
        upkeep_after_edit(s, set);
        return;
    }
    if (set->current->lsn != 0)
        loop_yield(&a->reactor->loop, &a->reactor->push);
    if (set->watched != NULL)
        loop_end_alone(&a->reactor->loop);
}

static void finish(struct server *s, struct job *j, struct answer *a)
{
    struct change *c = change_of_job(j);
    bool values = c->kind->items == ITEMS_PAIRS || c->kind->items == ITEMS_COLUMN;
    if (j->status == DT_NOPOINT) {
        answer_err(a, ERR_NOPOINT, "there is no point %u%s", c->missing, c->kind->undone);
    } else if (j->status == DT_TOOBIG && values) {
        answer_err(a, ERR_TOOBIG, "a set has at most %d fields", DT_MAX_FIELDS);
    } else if (answer_constraint(a, j->status, c)) {
        return;
    } else if (job_succeeded(j, a)) {
        if (!change_is_void(c))
            submit_commit(s, j->set, c);
        answer_facts(a, c);
        answer_version(a, j->set->version);
        after_edit(s, a, j->set);
    }
}

static void end(struct server *s, struct job *j, struct answer *a)
{
    struct submission *x = (struct submission *)j;
    if (a != NULL)
        finish(s, j, a);
    change_clear(&x->change);
    if (x->expected > 0)
        page_cache_expect(s, 0, x->expected);
}

enum { VALUES_AT_ONCE = 4096 };

static enum job_weight weight_of(const struct dataset *set, const struct change *c)
{
    if (c->pslg != NULL && c->pslg->refines)
        return JOB_LONG;
    const struct pslg_lists *v = c->pslg == NULL ? NULL : &c->pslg->lists;
    bool refreshes =
        (c->kind->record >= RECORD_CONSTRAIN || v != NULL) && version_is_stale(set->current);
    switch (c->kind->items) {
    case ITEMS_CONSTRAINTS:
    case ITEMS_MOVES:
        return !refreshes && c->n > 0 && cost_at_once(COST_EDIT, c->n) ? JOB_LIGHT : JOB_LONG;
    case ITEMS_PSLG:
        return !refreshes && cost_at_once(COST_EDIT, (size_t)c->n + v->n_released + v->n_added)
                   ? JOB_LIGHT
                   : JOB_LONG;
    case ITEMS_POINTS:
    case ITEMS_IDS:
        return !refreshes && cost_at_once(COST_EDIT, c->n) ? JOB_LIGHT : JOB_LONG;
    case ITEMS_COLUMN:
        return c->n <= VALUES_AT_ONCE ? JOB_LIGHT : JOB_SHORT;
    case ITEMS_PAIRS:
        return JOB_LIGHT;
    case ITEMS_NONE:
        break;
    }
    size_t kib = dt_next_id(set->current->dt) / (1024 / sizeof(double)); /* of a field, at most */
    bool frees = (c->kind->flags & CHANGE_FREES) != 0;
    return frees && !cost_at_once(COST_FREE, kib) ? JOB_SHORT : JOB_LIGHT;
}

/* Points that it adds, deletes or moves; a REFINE, of which that is unknown, counts as one that doubles the set. */
static size_t points_of(const struct dataset *set, const struct change *c)
{
    if (c->pslg != NULL && c->pslg->refines)
        return set->current->sum.points;
    if (c->kind->items == ITEMS_POINTS || c->kind->items == ITEMS_IDS ||
        c->kind->items == ITEMS_PSLG)
        return c->n;
    return c->kind->items == ITEMS_MOVES ? c->n : c->kind == &change_kinds[CHANGE_MOVE];
}

/* Whether the change is made on a copy, which is triangulated before it replaces the set: others read the triangulation, and
 * in place the change would take about as long. If so, the memory of that is reserved. */
static bool keeps_live(struct server *s, const struct dataset *set, struct submission *x)
{
    /* of the points: an edit in place takes about as long as a build of so many */
    enum { SHARE = 32 };
    const struct version *v = set->current;
    const uint32_t points = v->sum.points;
    if (!v->asked || !v->sum.current || points == 0 || s->workers == NULL ||
        cost_at_once(COST_EDIT, x->job.points) || x->job.points < points / SHARE)
        return false;
    struct dt_options options = job_options(s);
    size_t bytes = dt_build_memory(v->dt, &options);
    bytes += (size_t)((double)bytes / points * (double)x->job.points);
    return reservation_resize(&x->job.memory, x->job.memory.bytes + bytes);
}

/* ---- all changes ---- */

/* A new grid is begun by who is alone. While there is no memory for it, it stays due, and all edits of the set run alone. */
bool submit_shares(const struct dataset *set, enum change_code code, size_t n)
{
    const struct change_kind *kind = &change_kinds[code];
    bool few = kind->items == ITEMS_COLUMN ? n <= VALUES_AT_ONCE : cost_at_once(COST_EDIT, n);
    return set != NULL && few && kind->edit != NULL && kind->note == NULL &&
           !dt_renew_due(set->current->dt);
}

bool submit_may(struct answer *a, const struct dataset *set, enum change_code code, size_t n)
{
    return !answer_shares(a) || submit_shares(set, code, n) || world_alone(a);
}

struct submission *submission_new(struct server *s, struct answer *a, enum change_code code,
                                  const struct word *set)
{
    struct submission *x = job_new(sizeof *x, run, end);
    if (x == NULL) {
        answer_out_of_memory(a);
        return NULL;
    }
    change_init(&x->change, code, set);
    x->change.pages = s->pages;
    x->job.acknowledges = true;
    x->job.change = &x->change;
    return x;
}

static void answer_at_once(struct server *s, struct answer *a, struct dataset *set,
                           struct change *c)
{
    if (c->kind == &change_kinds[CHANGE_DROP]) {
        drop(s, set, c);
        a->lsn = durable_lsn(s, NULL);
        answer_ok(a);
        return;
    }
    set->born = true;
    submit_commit(s, set, c);
    a->lsn = durable_lsn(s, set);
    answer_changed(a, set->version);
}

void submit(struct server *s, struct answer *a, struct dataset *set, struct submission *x)
{
    const struct change *c = &x->change;
    if (set == NULL)
        set = create(s, a, x);
    if (set != NULL && c->kind->edit != NULL) {
        x->job.what = c->pslg != NULL && c->pslg->refines ? "refining" : c->kind->what;
        x->job.points = points_of(set, c);
        x->job.plans = c->pslg != NULL && c->pslg->splits;
        x->job.copies = keeps_live(s, set, x);
        job_change(s, a, &x->job, set, weight_of(set, c));
        return;
    }
    if (set != NULL)
        answer_at_once(s, a, set, &x->change);
    job_free(s, &x->job);
}
