/* surface.c - see surface.h. */
#include "server/surface/surface.h"

#include "server/jobs/job.h"
#include "server/jobs/stream.h"
#include "server/ops/cost.h"
#include "server/ops/limits.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    AT_ONCE = 64,           /* places or cells, if there are not more than */
    IDS_AT_ONCE = 1 << 20,  /* ids; their pages are looked at */
    PIECE_LINEAR = 1 << 16, /* places or cells under the lock */
    PIECE_NATURAL = 1 << 13,
    TEXT_AT_ONCE = 20000 /* numbers that the I/O thread writes as text */
};

struct surface_job {
    struct job job;
    struct surface q;
    struct dt_view *view;         /* owns: the moment of the result; NULL: that of the copy */
    struct dt *copy;              /* owns; NULL: none */
    const struct dt_field *field; /* of the view, or of the copy */
    double *value;                /* owns: n values of places or cells, `done` of which are there */
    size_t n, done;
    struct dt_ids line; /* owns: the words of contours */
    size_t lines;
    bool busy; /* no memory because of other requests */
    bool too_many_levels;
};

void surface_clear(struct surface *q)
{
    dt_pages_release(q->places.p);
    if (q->places.memory.bytes > 0)
        reservation_set(&q->places.memory, 0);
    free(q->level);
    q->places.p = NULL;
    q->level = NULL;
}

static size_t count_values(const struct surface *q)
{
    if (q->kind == SURFACE_PLACES)
        return q->places.n;
    return q->kind == SURFACE_RASTER ? (size_t)q->raster.columns * q->raster.rows : 0;
}

/* The next n values, from number `from` on. */
static enum dt_status find_values(const struct dt *dt, const struct dt_field *f,
                                  const struct dt_view *v, const struct surface *q, size_t from,
                                  size_t n, const struct dt_options *opt, double *out, size_t *done)
{
    struct dt_surface s = {.how = q->how, .max_edge = q->max_edge};
    enum dt_status status = dt_surface_begin(&s, f, v);
    *done = 0;
    if (status != DT_OK)
        return status;
    status = q->kind == SURFACE_PLACES
                 ? dt_values(dt, &s, q->places.p + from, n, opt, out, done)
                 : dt_raster_values(dt, &s, &q->raster, from, n, opt, out, done);
    dt_surface_end(&s);
    return status;
}

/* ---- the reply ---- */

/* Sends the list, which moves to the reply. */
static void send_list(struct server *s, struct answer *a, struct rows *rows, struct dt_ids *ids)
{
    reply_end(a->out);
    stream_answer(s, a, rows, ids);
    free(ids->v);
}

static void answer_values(struct server *s, struct answer *a, struct version *v,
                          const struct surface *q, double *value)
{
    bool raster = q->kind == SURFACE_RASTER;
    size_t n = count_values(q), columns = raster ? q->raster.columns : 1;
    size_t words = 2 * n;
    struct dt_ids ids = {(uint32_t *)(void *)value, words, words};
    struct rows rows = {.version = v,
                        .form = ROW_NUMBERS,
                        .width = 2 * columns,
                        .binary = q->binary,
                        .heavy = !q->binary && n > TEXT_AT_ONCE};
    reply_ok(a->out, q->binary ? 0 : n / columns);
    if (q->binary)
        reply_key_u64(a->out, "rows", n / columns);
    if (raster)
        reply_key_u64(a->out, "columns", columns);
    if (q->binary)
        reply_key_u64(a->out, "bytes", (uint64_t)n * sizeof *value);
    send_list(s, a, &rows, &ids);
}

static void answer_lines(struct server *s, struct answer *a, struct surface_job *j)
{
    struct rows rows = {.version = j->job.base,
                        .form = ROW_LINE,
                        .width = 1,
                        .heavy = j->line.n > 2 * (size_t)TEXT_AT_ONCE};
    struct dt_ids ids = j->line;
    j->line = (struct dt_ids){0};
    reply_ok(a->out, j->lines);
    send_list(s, a, &rows, &ids);
}

/* ---- by a worker ---- */

static bool is_on_worker(const struct surface_job *j)
{
    return j->job.queued_ns > 0;
}

/* Reserves so much for the job in all. */
static enum dt_status reserve(struct surface_job *j, size_t bytes)
{
    j->busy = !reservation_resize(&j->job.memory, bytes);
    return j->busy ? DT_NOMEM : DT_OK;
}

static enum dt_status find_field(struct surface_job *j, const struct dt *dt)
{
    j->field = dt_field_find(dt, j->q.field, j->q.field_len);
    return j->field == NULL ? DT_NOFIELD : DT_OK;
}

/* An edit has come between two pieces: all values are computed again on a copy of the set, which nobody edits. */
static enum dt_status begin_again(struct surface_job *j)
{
    struct dt_summary sum;
    dt_summary(j->job.base->dt, &sum);
    j->done = 0;
    enum dt_status status = reserve(j, j->job.memory.bytes + sum.memory);
    if (status == DT_OK)
        status = dt_clone(j->job.base->dt, &j->copy);
    if (status != DT_OK)
        return status;
    dt_view_end(j->view);
    j->view = NULL;
    return find_field(j, j->copy);
}

/* The copy may have been made while the triangulation was not current. */
static enum dt_status refresh_copy(struct surface_job *j)
{
    struct dt_options opt = {.cancel = &j->job.cancel};
    return dt_refresh(j->copy, &opt);
}

static enum dt_status find_piece(struct surface_job *j)
{
    const struct dt *dt = j->copy != NULL ? j->copy : j->job.base->dt;
    size_t piece = j->q.how == DT_LINEAR ? PIECE_LINEAR : PIECE_NATURAL, left = j->n - j->done,
           done;
    struct dt_options opt = j->job.options;
    opt.progress = NULL;
    enum dt_status status =
        find_values(dt, j->field, j->view, &j->q, j->done, left < piece ? left : piece, &opt,
                    j->value + j->done, &done);
    j->done += done;
    atomic_store(&j->job.progress, (unsigned)(100 * j->done / (j->n + 1)));
    return status;
}

/* The worker has the lock on entry and on return. Copies are read without it. */
static enum dt_status find_all(struct surface_job *j)
{
    struct version *v = j->job.base;
    enum dt_status status = DT_OK;
    while (status == DT_OK && j->done < j->n && j->copy == NULL) {
        status = dt_view_is_current(v->dt, j->view) ? find_piece(j) : begin_again(j);
        if (is_on_worker(j)) {
            version_unlock(v);
            version_lock_read(v);
        }
    }
    if (j->copy == NULL || status != DT_OK)
        return status;
    version_unlock(v);
    status = refresh_copy(j);
    while (status == DT_OK && j->done < j->n)
        status = find_piece(j);
    dt_free(j->copy);
    j->copy = NULL;
    version_lock_read(v);
    return status;
}

/* ---- contours ---- */

/* The levels every `step` from `base` on that the values of the field reach. */
static enum dt_status make_levels(struct surface_job *j)
{
    struct dt_field_summary sum;
    dt_field_summary(j->field, &sum);
    double first = ceil((sum.least - j->q.base) / j->q.step),
           last = floor((sum.most - j->q.base) / j->q.step);
    j->too_many_levels = last - first >= LIMIT_LEVELS || isinf(first) || isinf(last);
    if (j->too_many_levels)
        return DT_RANGE;
    size_t n = last >= first ? (size_t)(last - first) + 1 : 0;
    j->q.level = malloc(n * sizeof *j->q.level + 1);
    if (j->q.level == NULL)
        return DT_NOMEM;
    for (size_t i = 0; i < n; i++) {
        double level = j->q.base + (first + (double)i) * j->q.step;
        if (j->q.levels == 0 || level > j->q.level[j->q.levels - 1])
            j->q.level[j->q.levels++] = level;
    }
    return DT_OK;
}

static enum dt_status write_lines(struct surface_job *j, const struct dt_contour_line *line,
                                  size_t lines, size_t taken)
{
    size_t words = 0;
    for (size_t i = 0; i < lines; i++)
        words += ROW_LINE_WORDS + 4 * line[i].n;
    enum dt_status status = reserve(j, taken + words * sizeof *j->line.v);
    if (status != DT_OK)
        return status;
    uint32_t *to = malloc(words * sizeof *to + 1);
    if (to == NULL)
        return DT_NOMEM;
    j->line = (struct dt_ids){to, words, words};
    j->lines = lines;
    for (size_t i = 0; i < lines; i++) {
        row_line_put(to, line[i].level, line[i].closed, (uint32_t)line[i].n);
        memcpy(to + ROW_LINE_WORDS, line[i].p, line[i].n * sizeof *line[i].p);
        to += ROW_LINE_WORDS + 4 * line[i].n;
    }
    return DT_OK;
}

static enum dt_status join_lines(struct surface_job *j, struct dt_contour *c)
{
    const struct dt_contour_line *line;
    size_t lines, taken = dt_contour_memory(c);
    enum dt_status status = reserve(j, taken);
    if (status == DT_OK)
        status = dt_contour_end(c, &j->job.options, &line, &lines);
    return status == DT_OK ? write_lines(j, line, lines, taken) : status;
}

/* As find_all. */
static enum dt_status find_lines(struct surface_job *j)
{
    struct version *v = j->job.base;
    struct dt_contour *c = NULL;
    bool done = false;
    enum dt_status status = j->q.level == NULL ? make_levels(j) : DT_OK;
    if (status == DT_OK)
        status =
            dt_contour_begin(v->dt, j->view, j->field, j->q.level, j->q.levels, j->q.max_edge, &c);
    while (status == DT_OK && !done) {
        status = reserve(j, dt_contour_memory(c));
        if (status == DT_OK)
            status = dt_contour_read(v->dt, c, &done);
        if (status == DT_OK && atomic_load(&j->job.cancel))
            status = DT_CANCELLED;
        if (is_on_worker(j)) {
            version_unlock(v);
            version_lock_read(v);
        }
    }
    if (is_on_worker(j))
        version_unlock(v);
    if (status == DT_OK)
        status = join_lines(j, c);
    dt_contour_free(c);
    if (is_on_worker(j))
        version_lock_read(v);
    return status;
}

/* ---- the job ---- */

static enum dt_status prepare(struct surface_job *j)
{
    j->view = dt_view_begin(j->job.dt, true);
    if (j->view == NULL)
        return DT_NOMEM;
    enum dt_status status = find_field(j, j->job.dt);
    if (status == DT_OK)
        status = reserve(j, j->n * sizeof *j->value);
    if (status != DT_OK)
        return status;
    j->value = malloc(j->n * sizeof *j->value + 1);
    return j->value == NULL ? DT_NOMEM : DT_OK;
}

static void run_job(struct job *job)
{
    struct surface_job *j = (struct surface_job *)job;
    job->status = prepare(j);
    if (job->status == DT_OK)
        job->status = j->q.kind == SURFACE_CONTOUR ? find_lines(j) : find_all(j);
}

static void job_done(struct server *s, struct job *job, struct answer *a)
{
    struct surface_job *j = (struct surface_job *)job;
    version_end_view(&s->sets, job->base, j->view);
    j->view = NULL;
    if (job->status != DT_OK) {
        if (j->busy)
            answer_busy(a);
        else if (j->too_many_levels)
            reply_err(a->out, ERR_RANGE, "more than %d levels", LIMIT_LEVELS);
        else
            answer_status(a, job->status);
        return;
    }
    reservation_set(&job->memory, 0); /* from here on it is the stream's */
    if (j->q.kind == SURFACE_CONTOUR) {
        answer_lines(s, a, j);
        return;
    }
    double *value = j->value;
    j->value = NULL;
    answer_values(s, a, job->base, &j->q, value);
}

static void clear_job(struct job *job)
{
    struct surface_job *j = (struct surface_job *)job;
    surface_clear(&j->q);
    dt_free(j->copy);
    free(j->value);
    free(j->line.v);
}

static void answer_by_job(struct server *s, struct answer *a, struct dataset *set,
                          struct surface *q)
{
    struct version *v = set->current;
    bool light = q->kind == SURFACE_CONTOUR && cost_at_once(COST_SWEEP, 8 * (size_t)v->sum.points);
    struct surface_job *j = job_new(sizeof *j, run_job, job_done);
    if (j == NULL) {
        surface_clear(q);
        answer_out_of_memory(a);
        return;
    }
    j->job.clear = clear_job;
    j->job.memory = server_reservation(s, BUDGET_REPLIES);
    j->job.what = q->kind == SURFACE_CONTOUR ? "tracing" : "interpolating";
    j->q = *q;
    j->n = count_values(q);
    job_read(s, a, &j->job, v, light ? 0 : JOB_HEAVY);
}

/* ---- at once ---- */

/* False: it takes too many steps. */
static bool answer_at_once(struct server *s, struct answer *a, struct dataset *set,
                           const struct surface *q)
{
    struct dt_options opt = {.steps = s->workers != NULL ? COST_STEPS_AT_ONCE : 0};
    const struct dt *dt = set->current->dt;
    const struct dt_field *f = dt_field_find(dt, q->field, q->field_len);
    size_t n = count_values(q), done;
    double *value = malloc(n * sizeof *value + 1);
    if (value == NULL || f == NULL) {
        free(value);
        answer_out_of_memory(a);
        return true;
    }
    enum dt_status status = find_values(dt, f, NULL, q, 0, n, &opt, value, &done);
    if (status == DT_OK) {
        answer_values(s, a, set->current, q, value);
        return true;
    }
    free(value);
    if (status != DT_TOOLONG)
        answer_status(a, status);
    return status != DT_TOOLONG;
}

void surface_answer(struct server *s, struct answer *a, struct dataset *set, struct surface *q)
{
    bool few = q->kind != SURFACE_CONTOUR && count_values(q) <= AT_ONCE &&
               dt_next_id(set->current->dt) <= IDS_AT_ONCE;
    if (few && answer_at_once(s, a, set, q))
        surface_clear(q);
    else
        answer_by_job(s, a, set, q);
}
