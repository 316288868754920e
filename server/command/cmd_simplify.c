/* cmd_simplify.c - SIMPLIFY: a new set of few points, whose surface is near all points of another one. A first job reads the set and
 * chooses the points (core/delaunay_thinning.h); its end submits the change that makes the new set of them. */
#include "server/command/command.h"

#include "core/delaunay_thinning.h"
#include "server/changes/constraint.h"
#include "server/changes/name.h"
#include "server/jobs/durable.h"
#include "server/jobs/expire.h"
#include "server/jobs/submit.h"
#include "server/ops/cost.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct simplify {
    const struct dt_field *field; /* of the set now */
    struct name other;            /* the new set */
    struct name ids;              /* its field with the ids of the set; len 0: none */
    double error;
    uint32_t most; /* points */
};

enum { PIECE = 4096 /* rows, or constraints, that are read at once */ };

struct simplify_job {
    struct job job;
    struct simplify asked;  /* its field: as long as the view */
    struct dt_pages *pages; /* borrows */
    /* The representatives: owns n of each, from dt_pages_grow. */
    uint32_t *id;
    struct dt_point *point;
    double *value;
    uint32_t n, cap;
    struct dt_constraint_list
        constraints;         /* owns; ends are ids, and later indices of representatives */
    struct dt_thinned kept;  /* owns */
    struct columns *columns; /* owns; of the new set */
    bool doubled;            /* there is a field of the name `ids` */
    size_t before;           /* bytes reserved for all that when points are thinned out */
};

/* ---- reading: the worker visits the set ---- */

static size_t memory_of(const struct simplify_job *j, uint32_t cap)
{
    enum { POINT = sizeof(struct dt_point) + sizeof(double) + sizeof(uint32_t) };
    return (size_t)cap * POINT + 2 * j->constraints.cap * sizeof(struct dt_constraint);
}

/* Room for n representatives. */
static enum dt_status make_room(struct simplify_job *j, uint32_t n)
{
    enum dt_status status = job_reserve(&j->job, memory_of(j, n));
    if (status != DT_OK)
        return status;
    uint32_t *id = dt_pages_grow(j->pages, NULL, 0, ((size_t)n + 1) * sizeof *id);
    struct dt_point *point = dt_pages_grow(j->pages, NULL, 0, ((size_t)n + 1) * sizeof *point);
    double *value = dt_pages_grow(j->pages, NULL, 0, ((size_t)n + 1) * sizeof *value);
    j->id = id;
    j->point = point;
    j->value = value;
    j->cap = n;
    return id != NULL && point != NULL && value != NULL ? DT_OK : DT_NOMEM;
}

/* Reads the next rows; *done: no row is left. */
static enum dt_status read_rows(struct simplify_job *j, uint32_t *from, bool *done)
{
    struct dt_row row[PIECE];
    size_t rows;
    const uint32_t first = j->n;
    enum dt_status status = dt_view_rows(j->job.dt, j->job.view, from, row, PIECE, &rows);
    for (size_t i = 0; status == DT_OK && i < rows; i++)
        if (row[i].representative == row[i].id) {
            j->id[j->n] = row[i].id;
            j->point[j->n++] = row[i].at;
        }
    if (status == DT_OK)
        dt_field_values(j->asked.field, j->job.view, j->id + first, j->n - first, j->value + first);
    *done = rows == 0;
    return status;
}

static enum dt_status read_set_points(struct simplify_job *j)
{
    struct dt_summary sum;
    uint32_t from = 0;
    dt_view_summary(j->job.view, &sum);
    enum dt_status status = make_room(j, sum.points);
    for (bool done = false; status == DT_OK && !done;) {
        status = job_pause(&j->job, read_rows(j, &from, &done));
    }
    return status;
}

static int compare_ids(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

/* The index of the representative of an id. */
static enum dt_status index_of(const struct simplify_job *j, uint32_t id, uint32_t *index)
{
    const uint32_t *found = bsearch(&id, j->id, j->n, sizeof id, compare_ids);
    struct dt_row row;
    size_t rows;
    uint32_t from = id;
    if (found == NULL) { /* an alias */
        enum dt_status status = dt_view_rows(j->job.dt, j->job.view, &from, &row, 1, &rows);
        if (status != DT_OK)
            return status;
        found = bsearch(&row.representative, j->id, j->n, sizeof id, compare_ids);
    }
    *index = (uint32_t)(found - j->id);
    return DT_OK;
}

/* Ends become indices, from constraint `from` on; those with the same end twice have no edges and are dropped. */
static enum dt_status index_ends(struct simplify_job *j, size_t from)
{
    struct dt_constraint_list *list = &j->constraints;
    enum dt_status status = DT_OK;
    size_t n = from;
    for (size_t i = from; i < list->n && status == DT_OK; i++) {
        struct dt_constraint c = list->v[i];
        status = index_of(j, list->v[i].a, &c.a);
        if (status == DT_OK)
            status = index_of(j, list->v[i].b, &c.b);
        list->v[n] = c;
        n += c.a != c.b;
    }
    list->n = n;
    return status;
}

static enum dt_status read_set_constraints(struct simplify_job *j)
{
    enum dt_status status = DT_OK;
    for (uint32_t from = 0; status == DT_OK && from != DT_NONE;) {
        size_t first = j->constraints.n;
        status = dt_constraints_read(j->job.dt, j->job.view, &from, PIECE, &j->constraints);
        if (status == DT_OK)
            status = index_ends(j, first);
        if (status == DT_OK)
            status = job_reserve(&j->job, memory_of(j, j->cap));
        status = job_pause(&j->job, status);
    }
    return status;
}

/* ---- the points that are kept ---- */

static enum dt_status reserve_more(void *ctx, size_t bytes)
{
    struct simplify_job *j = ctx;
    return job_reserve(&j->job, j->before + bytes);
}

static enum dt_status thin_out(struct simplify_job *j)
{
    const struct dt_thinning in = {.point = j->point,
                                   .value = j->value,
                                   .n = j->n,
                                   .constraint = j->constraints.v,
                                   .constraints = j->constraints.n,
                                   .error = j->asked.error,
                                   .most = j->asked.most,
                                   .reserve = reserve_more,
                                   .ctx = j,
                                   .pages = j->pages};
    j->before = memory_of(j, j->cap);
    return dt_thin(&in, &j->job.options, &j->kept);
}

/* The values of a field at the points that are kept, into out[]. */
static enum dt_status read_values(struct simplify_job *j, const struct dt_field *field, double *out)
{
    enum dt_status status = DT_OK;
    uint32_t id[PIECE], from = 0;
    size_t rows;
    for (uint32_t at = 0, n; status == DT_OK && at < j->kept.n; at += n) {
        n = j->kept.n - at < PIECE ? j->kept.n - at : PIECE;
        for (uint32_t i = 0; i < n; i++)
            id[i] = j->id[j->kept.kept[at + i]];
        status =
            dt_view_rows(j->job.dt, j->job.view, &from, NULL, 0, &rows); /* fields can be read */
        if (status == DT_OK)
            dt_field_values(field, j->job.view, id, n, out + at);
        status = job_pause(&j->job, status);
    }
    return status;
}

/* The number of fields of the new set. */
static size_t count_columns(struct simplify_job *j)
{
    size_t n = j->asked.ids.len > 0;
    for (const struct dt_field *f = NULL; (f = dt_field_next(j->job.dt, j->job.view, f)) != NULL;
         n++)
        j->doubled =
            j->doubled || name_equals(&j->asked.ids, dt_field_name(f), strlen(dt_field_name(f)));
    return n;
}

static enum dt_status make_columns(struct simplify_job *j, size_t columns)
{
    const uint32_t n = j->kept.n;
    size_t bytes = columns * ((size_t)n + 1) * sizeof(double);
    enum dt_status status = job_reserve(&j->job, memory_of(j, j->cap) + bytes);
    if (status != DT_OK)
        return status;
    j->columns = columns_new(columns);
    if (j->columns != NULL)
        j->columns->v = dt_pages_grow(j->pages, NULL, 0, bytes);
    if (j->columns == NULL || j->columns->v == NULL)
        return DT_NOMEM;
    j->columns->n = n;
    return DT_OK;
}

/* Carries over all fields, and the ids. */
static enum dt_status read_fields(struct simplify_job *j)
{
    const uint32_t n = j->kept.n;
    size_t columns = count_columns(j), k = 0;
    if (j->doubled)
        return DT_OK; /* an error is going to be answered */
    if (columns > DT_MAX_FIELDS)
        return DT_TOOBIG;
    enum dt_status status = make_columns(j, columns);
    for (const struct dt_field *f = NULL;
         status == DT_OK && (f = dt_field_next(j->job.dt, j->job.view, f)) != NULL; k++) {
        j->columns->field[k] = name_of(dt_field_name(f), strlen(dt_field_name(f)));
        status = read_values(j, f, j->columns->v + k * n);
    }
    if (status != DT_OK || j->asked.ids.len == 0)
        return status;
    j->columns->field[k] = j->asked.ids;
    for (uint32_t i = 0; i < n; i++)
        j->columns->v[k * n + i] = j->id[j->kept.kept[i]];
    return DT_OK;
}

static void run_job(struct job *job)
{
    struct simplify_job *j = (struct simplify_job *)job;
    job->status = read_set_points(j);
    if (job->status == DT_OK)
        job->status = read_set_constraints(j);
    job_end_visit(job);
    if (job->status == DT_OK)
        job->status = thin_out(j);
    job_visit(job);
    if (job->status == DT_OK)
        job->status = read_fields(j);
}

/* ---- the new set ---- */

static void take_points(const struct simplify_job *j, struct change *c)
{
    c->n = j->kept.n;
    for (uint32_t i = 0; i < c->n; i++)
        c->points[i] = j->point[j->kept.kept[i]];
}

/* The id that a representative gets in the new set; it is kept. */
static uint32_t new_id(const struct simplify_job *j, uint32_t index)
{
    const uint32_t *kept = j->kept.kept;
    const uint32_t *found = bsearch(&index, kept, j->kept.n, sizeof index, compare_ids);
    return (uint32_t)(found - kept);
}

static void take_constraints(const struct simplify_job *j, struct pslg_lists *d)
{
    d->n_added = (uint32_t)j->constraints.n;
    for (size_t i = 0; i < j->constraints.n; i++) {
        struct dt_constraint c = j->constraints.v[i];
        c.a = new_id(j, c.a);
        c.b = new_id(j, c.b);
        d->added[i] = constraint_record(&c);
    }
}

/* The change that makes the new set. False: out of memory. */
static bool make_change(struct simplify_job *j, struct change *c)
{
    struct pslg *d = c->pslg = pslg_new();
    size_t n = j->constraints.n;
    c->first = CHANGE_ANY;
    c->points = dt_pages_grow(c->pages, NULL, 0, ((size_t)j->kept.n + 1) * sizeof *c->points);
    if (d == NULL || c->points == NULL)
        return false;
    d->lists.added = dt_pages_grow(c->pages, NULL, 0, (n + 1) * sizeof *d->lists.added);
    if (d->lists.added == NULL)
        return false;
    d->loads = d->thins = true;
    d->error = j->kept.error;
    take_points(j, c);
    take_constraints(j, &d->lists);
    c->columns = j->columns;
    j->columns = NULL;
    return true;
}

/* The memory of the change, which does not wait for more: the work is done. */
static bool reserve_change(struct server *s, struct answer *a, struct submission *x)
{
    size_t bytes = submit_memory_of_new(s, &x->change);
    x->job.memory = server_reservation(s, BUDGET_EDITS);
    return reservation_resize(&x->job.memory, bytes) || server_refuse(s, a, bytes);
}

static void make_set(struct server *s, struct simplify_job *j, struct answer *a)
{
    struct word name = name_word(&j->asked.other);
    struct submission *x = submission_new(s, a, CHANGE_PSLG, &name);
    if (x == NULL)
        return;
    bool made = make_change(j, &x->change);
    if (!made)
        answer_out_of_memory(a);
    if (made && reserve_change(s, a, x))
        submit(s, a, NULL, x);
    else
        job_free(s, &x->job);
}

/* Whether there is no set of that name; else the ERR line has been written. */
static bool is_new(struct server *s, struct answer *a, const struct name *other)
{
    struct word name = name_word(other);
    struct dataset *there = registry_find(&s->sets, &name);
    if (there == NULL || expire_drop_if_due(s, there))
        return true;
    return answer_err(a, ERR_EXISTS, "the set %s already exists", there->name);
}

static void answer_result(struct server *s, struct simplify_job *j, struct answer *a)
{
    bool few = j->job.status == DT_TOOBIG && j->kept.least > j->asked.most;
    if (few)
        answer_err(a, ERR_RANGE, "%u points must stay: corners of the hull, ends of constraints",
                   j->kept.least);
    if (few || !job_succeeded(&j->job, a))
        return;
    if (j->doubled)
        answer_err(a, ERR_EXISTS, "the set has a field of that name for ids");
    else if (is_new(s, a, &j->asked.other))
        make_set(s, j, a);
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct simplify_job *j = (struct simplify_job *)job;
    reservation_set(&job->memory, 0);
    if (a != NULL)
        answer_result(s, j, a);
    dt_pages_release(j->id);
    dt_pages_release(j->point);
    dt_pages_release(j->value);
    dt_pages_release(j->kept.kept);
    free(j->constraints.v);
    columns_free(j->columns);
}

/* A worker reads the set, at one state, in pieces of a few milliseconds, and thins its points out without it. Answers `OK 0 points=
 * constraints= error=` and the version of the new set, which is logged as if its points had been loaded. */
static void submit_simplify(struct server *s, struct answer *a, struct dataset *set,
                            const struct simplify *simplify)
{
    struct version *v = set->current;
    struct simplify_job *j =
        job_new_reading(s, a, sizeof *j, run_job, end_job, "simplifying", NULL);
    if (j == NULL)
        return;
    j->asked = *simplify;
    j->pages = s->pages;
    if (!job_begin_view(s, a, &j->job, v, false))
        return;
    size_t work = (size_t)v->sum.points + dt_constraints_count(v->dt);
    job_read(s, a, &j->job, v, cost_at_once(COST_EDIT, 4 * work) ? JOB_LIGHT : JOB_LONG);
}

/* ---- the request ---- */

static bool read_error(struct answer *a, const struct word *w, double *error)
{
    if (!read_number(a, w, error))
        return false;
    *error += 0.0; /* -0 becomes 0 */
    return (*error >= 0 && !isinf(*error)) ||
           answer_err(a, ERR_RANGE, "an error is finite and not negative");
}

/* Reads the options, words 3 to the last one, in this order. */
static bool read_options(struct answer *a, const struct request *q, struct simplify *x)
{
    const struct word *w = &q->word[3], *end = q->word + q->n;
    if (!word_is(w, "ERROR"))
        return answer_usage(a);
    if (!read_error(a, &w[1], &x->error))
        return false;
    w += 2;
    if (w + 2 < end && word_is(w, "POINTS")) {
        if (!read_count(a, &w[1], "a number of points", &x->most))
            return false;
        w += 2;
    }
    if (w + 2 < end && word_is(w, "IDS")) {
        if (!read_field_name(a, &w[1]))
            return false;
        x->ids = name_of(w[1].text, w[1].len);
        w += 2;
    }
    if (w + 2 != end || !word_is(w, "INTO"))
        return answer_usage(a);
    if (!check_set_name(a, &w[1]))
        return false;
    x->other = name_of(w[1].text, w[1].len);
    return true;
}

/* command.c checks whether changes can be saved, unless the set is temporary. The new set is saved in any case. */
void cmd_simplify(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct simplify x = {.field = find_field(a, set, &q->word[2]), .most = UINT32_MAX};
    if (x.field != NULL && read_options(a, q, &x) && is_new(s, a, &x.other) &&
        durable_admits_change(s, a, false))
        submit_simplify(s, a, set, &x);
}
