/* edit.c - see edit.h. */
#include "server/jobs/edit.h"

#include "core/delaunay_fields.h"
#include "server/jobs/journal.h"
#include "server/jobs/keep.h"
#include "server/jobs/renew.h"
#include "server/ops/cost.h"
#include "server/ops/limits.h"

#include <stdlib.h>
#include <string.h>

enum {
    BYTES_PER_POINT = 104 /* of memory for an added point */
};

struct edit {
    struct job job;
    double *rows;           /* owns: the points to add, with their values */
    struct dt_point *p;     /* owns: the points to add; NULL: they are still in rows */
    struct columns *values; /* owns: their values; NULL: none */
    uint32_t *ids;          /* owns: the ids to delete */
    size_t n;
    size_t expected;       /* bytes that are prepared for it (keep.h), until it ends */
    struct server *server; /* borrows */
    uint32_t id;           /* the point to move */
    struct dt_point to;
    struct dt_added added;
    uint32_t deleted, missing;
};

static void clear_edit(struct job *j)
{
    struct edit *e = (struct edit *)j;
    dt_pages_release(e->rows);
    dt_pages_release(e->p);
    columns_free(e->values);
    free(e->ids);
    if (e->expected > 0)
        keep_expect(e->server, 0, e->expected);
}

static unsigned how(size_t n)
{
    return cost_at_once(COST_EDIT, n) ? 0 : JOB_HEAVY;
}

struct dataset *edit_create(struct server *s, struct answer *a, const struct word *name,
                            double tolerance)
{
    struct dataset *set = NULL;
    if (s->sets.sets >= LIMIT_SETS && !a->of_leader)
        reply_err(a->out, ERR_TOOBIG, "a server holds at most %d sets", LIMIT_SETS);
    else if ((set = registry_create(&s->sets, name, tolerance)) == NULL)
        answer_out_of_memory(a);
    return set;
}

/* ---- add ---- */

/* The rows become points and columns of values. */
static bool split_rows(struct edit *e)
{
    struct columns *v = e->values;
    struct dt_pages *pages = e->server->pages;
    size_t width = 2 + v->count;
    e->p = dt_pages_grow(pages, NULL, 0, (e->n + 1) * sizeof *e->p);
    v->v = dt_pages_grow(pages, NULL, 0, (e->n * v->count + 1) * sizeof *v->v);
    if (e->p == NULL || v->v == NULL)
        return false;
    for (size_t i = 0; i < e->n; i++) {
        const double *row = e->rows + i * width;
        e->p[i] = (struct dt_point){row[0], row[1]};
        for (size_t k = 0; k < v->count; k++)
            v->v[k * e->n + i] = row[2 + k];
    }
    v->n = (uint32_t)e->n;
    dt_pages_release(e->rows);
    e->rows = NULL;
    return true;
}

static void run_add_values(struct job *j)
{
    struct edit *e = (struct edit *)j;
    struct dt_values_of column[DT_MAX_FIELDS];
    const struct columns *v = e->values;
    if (e->rows != NULL && !split_rows(e)) {
        j->status = DT_NOMEM;
        return;
    }
    for (size_t k = 0; k < v->count; k++)
        column[k] = (struct dt_values_of){v->field[k].text, v->field[k].len,
                                          v->v == NULL ? NULL : v->v + k * e->n};
    j->status = dt_add_values(j->dt, e->p, e->n, column, v->count, &j->options, &e->added);
}

static void run_add(struct job *j)
{
    struct edit *e = (struct edit *)j;
    if (e->values != NULL)
        run_add_values(j);
    else
        j->status = dt_add_many(j->dt, e->p, e->n, &j->options, &e->added);
}

static void record_add(struct server *s, struct job *j)
{
    struct edit *e = (struct edit *)j;
    struct dt_point *p = e->p;
    struct columns *v = e->values;
    e->p = NULL;
    e->values = NULL;
    if (v != NULL)
        v->first = e->added.first;
    if (v != NULL)
        journal_add_values(s, j->set, e->added.first, p, e->n, v);
    else
        journal_add(s, j->set, e->added.first, p, e->n);
}

static void add_done(struct server *s, struct job *j, struct answer *a)
{
    struct edit *e = (struct edit *)j;
    if (j->status != DT_OK) {
        answer_status(a, j->status);
        return;
    }
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "first", e->added.first);
    reply_key_u64(a->out, "added", e->added.added);
    reply_key_u64(a->out, "coincident", e->added.coincident);
    answer_version(a, j->set->version);
    renew_if_due(s, j->set);
}

/* Peak memory to add n points to a set, NULL for a new one; if the triangulation is left for later, that
 * includes it. */
static size_t memory_to_add(const struct server *s, const struct dataset *set, size_t n)
{
    struct dt_options options = job_options(s);
    if (cost_at_once(COST_EDIT, n) || set == NULL)
        return n * BYTES_PER_POINT;
    return dt_add_memory(set->current->dt, n, &options);
}

enum { BYTES_PER_PAGE = DT_FIELD_PAGE * sizeof(double) + 128 };

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

bool edit_may_add(struct server *s, struct answer *a, const struct dataset *set, size_t n,
                  size_t columns, struct reservation *memory)
{
    uint32_t points = set != NULL ? set->current->sum.points : 0;
    uint32_t most = a->of_leader ? DT_MAX_POINTS : s->config->max_points;
    *memory = server_reservation(s, BUDGET_EDITS);
    if (points > most || n > most - points) {
        reply_err(a->out, ERR_TOOBIG, "a set holds at most %u points (--max-points)", most);
        return false;
    }
    size_t bytes = memory_to_add(s, set, n) + memory_of_columns(n, columns);
    if (!cost_at_once(COST_EDIT, n))
        return server_reserve(s, a, memory, bytes);
    if (budget_fits(&s->budget, BUDGET_EDITS, bytes))
        return true;
    server_refuse(s, a, bytes);
    return false;
}

static void drop_arrival(struct server *s, struct arrival *points)
{
    dt_pages_release(points->rows);
    columns_free(points->values);
    reservation_set(&points->memory, 0);
    keep_expect(s, 0, points->expected);
}

void edit_add(struct server *s, struct answer *a, const struct word *name, struct arrival *points)
{
    struct dataset *set = registry_find(&s->sets, name);
    struct edit *e = job_new(sizeof *e, run_add, add_done);
    if (e == NULL)
        answer_out_of_memory(a);
    else if (set == NULL)
        set = edit_create(s, a, name, 0);
    if (e == NULL || set == NULL) {
        free(e);
        drop_arrival(s, points);
        return;
    }
    e->job.clear = clear_edit;
    e->job.record = record_add;
    e->job.what = "adding points";
    e->job.memory = points->memory;
    e->job.changes = points->n;
    e->values = points->values;
    if (e->values != NULL && e->values->v == NULL)
        e->rows = points->rows;
    else
        e->p = (struct dt_point *)(void *)points->rows;
    e->n = points->n;
    e->expected = points->expected;
    e->server = s;
    job_write(s, a, &e->job, set, how(points->n));
}

/* ---- delete ---- */

static void run_delete(struct job *j)
{
    struct edit *e = (struct edit *)j;
    j->status = dt_delete_many(j->dt, e->ids, e->n, &j->options, &e->deleted, &e->missing);
}

static void record_delete(struct server *s, struct job *j)
{
    struct edit *e = (struct edit *)j;
    journal_delete(s, j->set, e->ids, e->n);
}

static void delete_done(struct server *s, struct job *j, struct answer *a)
{
    struct edit *e = (struct edit *)j;
    if (j->status == DT_NOPOINT) {
        reply_err(a->out, ERR_NOPOINT, "there is no point %u; nothing was deleted", e->missing);
    } else if (j->status != DT_OK) {
        answer_status(a, j->status);
    } else {
        reply_ok(a->out, 0);
        reply_key_u64(a->out, "deleted", e->deleted);
        answer_version(a, j->set->version);
        renew_if_due(s, j->set);
    }
}

void edit_delete(struct server *s, struct answer *a, struct dataset *set, uint32_t *ids, size_t n)
{
    struct edit *e = job_new(sizeof *e, run_delete, delete_done);
    if (e == NULL) {
        free(ids);
        answer_out_of_memory(a);
        return;
    }
    e->job.clear = clear_edit;
    e->job.record = record_delete;
    e->job.what = "deleting points";
    e->job.changes = n;
    e->ids = ids;
    e->n = n;
    job_write(s, a, &e->job, set, how(n));
}

/* ---- move ---- */

static void run_move(struct job *j)
{
    struct edit *e = (struct edit *)j;
    j->status = dt_move_to(j->dt, e->id, e->to, &j->options);
}

static void record_move(struct server *s, struct job *j)
{
    struct edit *e = (struct edit *)j;
    journal_move(s, j->set, e->id, e->to);
}

static void move_done(struct server *s, struct job *j, struct answer *a)
{
    struct edit *e = (struct edit *)j;
    if (j->status == DT_NOPOINT) {
        reply_err(a->out, ERR_NOPOINT, "there is no point %u", e->id);
    } else if (j->status != DT_OK) {
        answer_status(a, j->status);
    } else {
        answer_changed(a, j->set->version);
        renew_if_due(s, j->set);
    }
}

void edit_move(struct server *s, struct answer *a, struct dataset *set, uint32_t id,
               struct dt_point to)
{
    struct edit *e = job_new(sizeof *e, run_move, move_done);
    if (e == NULL) {
        answer_out_of_memory(a);
        return;
    }
    e->job.record = record_move;
    e->job.what = "moving a point";
    e->job.changes = 1;
    e->id = id;
    e->to = to;
    job_write(s, a, &e->job, set, 0);
}

/* ---- values of fields ---- */

struct values_edit {
    struct job job;
    char name[DT_FIELD_NAME];
    size_t name_len;
    struct record_value *pair; /* owns: ids and values, n of them; NULL: they are a run */
    uint32_t *ids;             /* owns: the same apart */
    double *values;            /* owns */
    struct columns *run;       /* owns: those of a run */
    size_t n;
    uint32_t missing;
};

static void clear_values(struct job *j)
{
    struct values_edit *e = (struct values_edit *)j;
    free(e->pair);
    free(e->ids);
    free(e->values);
    columns_free(e->run);
}

static struct word field_name_of(const struct values_edit *e)
{
    return (struct word){e->name, e->name_len};
}

static struct values_edit *new_values_edit(void (*run)(struct job *),
                                           void (*done)(struct server *, struct job *,
                                                        struct answer *),
                                           const struct word *field)
{
    struct values_edit *e = job_new(sizeof *e, run, done);
    if (e == NULL)
        return NULL;
    e->job.clear = clear_values;
    e->name_len = field->len;
    memcpy(e->name, field->text, field->len);
    return e;
}

static void run_set(struct job *j)
{
    struct values_edit *e = (struct values_edit *)j;
    if (e->run != NULL)
        j->status = dt_field_set_run(j->dt, e->name, e->name_len, e->run->first, e->run->v, e->n,
                                     &j->options, &e->missing);
    else
        j->status = dt_field_set(j->dt, e->name, e->name_len, e->ids, e->values, e->n, &j->options,
                                 &e->missing);
}

static void record_set(struct server *s, struct job *j)
{
    struct values_edit *e = (struct values_edit *)j;
    struct word name = field_name_of(e);
    struct columns *run = e->run;
    e->run = NULL;
    if (run != NULL)
        journal_set_run(s, j->set, run);
    else
        journal_set_values(s, j->set, &name, e->pair, e->n);
}

static void set_done(struct server *s, struct job *j, struct answer *a)
{
    const struct values_edit *e = (const struct values_edit *)j;
    (void)s;
    if (j->status == DT_OK)
        answer_changed(a, j->set->version);
    else if (j->status == DT_NOPOINT)
        reply_err(a->out, ERR_NOPOINT, "there is no point %u; no value was set", e->missing);
    else if (j->status == DT_TOOBIG)
        reply_err(a->out, ERR_TOOBIG, "a set has at most %d fields", DT_MAX_FIELDS);
    else
        answer_status(a, j->status);
}

/* The most that n values of a set can take: each a page. */
static size_t memory_to_set(const struct dataset *set, size_t n)
{
    size_t pages = dt_next_id(set->current->dt) / DT_FIELD_PAGE + 1;
    return (n < pages ? n : pages) * BYTES_PER_PAGE;
}

static bool split(struct values_edit *e)
{
    e->ids = malloc((e->n + 1) * sizeof *e->ids);
    e->values = malloc((e->n + 1) * sizeof *e->values);
    if (e->ids == NULL || e->values == NULL)
        return false;
    for (size_t i = 0; i < e->n; i++) {
        e->ids[i] = e->pair[i].id;
        e->values[i] = e->pair[i].value;
    }
    return true;
}

void edit_set_values(struct server *s, struct answer *a, struct dataset *set,
                     const struct word *field, struct record_value *v, size_t n)
{
    size_t bytes = memory_to_set(set, n);
    struct values_edit *e = NULL;
    if (!budget_fits(&s->budget, BUDGET_EDITS, bytes)) {
        free(v);
        server_refuse(s, a, bytes);
        return;
    }
    e = new_values_edit(run_set, set_done, field);
    if (e == NULL) {
        free(v);
        answer_out_of_memory(a);
        return;
    }
    e->pair = v;
    e->n = n;
    if (!split(e)) {
        job_free(&e->job);
        answer_out_of_memory(a);
        return;
    }
    e->job.record = record_set;
    job_write(s, a, &e->job, set, 0);
}

bool edit_may_set_run(struct server *s, struct answer *a, size_t n, struct reservation *memory)
{
    size_t bytes = memory_of_run(n);
    *memory = server_reservation(s, BUDGET_EDITS);
    return server_reserve(s, a, memory, bytes);
}

void edit_set_run(struct server *s, struct answer *a, struct dataset *set, const struct word *field,
                  uint32_t first, double *v, size_t n, struct reservation *memory)
{
    enum { AT_ONCE = 4096 }; /* values that the I/O thread sets itself */
    struct values_edit *e = new_values_edit(run_set, set_done, field);
    struct columns *run = e == NULL ? NULL : columns_new(1);
    if (run == NULL) {
        if (e != NULL)
            job_free(&e->job);
        dt_pages_release(v);
        reservation_set(memory, 0);
        answer_out_of_memory(a);
        return;
    }
    run->first = first;
    run->n = (uint32_t)n;
    run->v = v;
    run->field[0].len = field->len;
    memcpy(run->field[0].text, field->text, field->len);
    e->run = run;
    e->n = n;
    e->job.record = record_set;
    e->job.memory = *memory;
    job_write(s, a, &e->job, set, n <= AT_ONCE ? 0 : JOB_HEAVY | JOB_BRIEF);
}

static void run_drop(struct job *j)
{
    struct values_edit *e = (struct values_edit *)j;
    j->status = dt_field_drop(j->dt, e->name, e->name_len);
}

static void record_drop(struct server *s, struct job *j)
{
    struct word name = field_name_of((const struct values_edit *)j);
    journal_drop_field(s, j->set, &name);
}

static void drop_done(struct server *s, struct job *j, struct answer *a)
{
    (void)s;
    if (j->status == DT_OK)
        answer_changed(a, j->set->version);
    else
        answer_status(a, j->status);
}

void edit_drop_field(struct server *s, struct answer *a, struct dataset *set,
                     const struct word *field)
{
    struct values_edit *e = new_values_edit(run_drop, drop_done, field);
    if (e == NULL) {
        answer_out_of_memory(a);
        return;
    }
    e->job.record = record_drop;
    size_t kib = dt_next_id(set->current->dt) / (1024 / sizeof(double)); /* at most */
    job_write(s, a, &e->job, set, cost_at_once(COST_FREE, kib) ? 0 : JOB_HEAVY | JOB_BRIEF);
}
