/* surface.c - see surface.h. */
#include "server/replies/surface.h"

#include "server/jobs/job.h"
#include "server/ops/cost.h"
#include "server/ops/limits.h"
#include "server/replies/answer_rows.h"

#include <stdlib.h>
#include <string.h>

enum {
    IDS_AT_ONCE = 1 << 20, /* ids; their pages are looked at */
    TEXT_AT_ONCE = 20000   /* numbers that a reactor writes as text */
};

void surface_clear(struct surface *q)
{
    dt_pages_release(q->places.p);
    dt_pages_release(q->places.kept);
    if (q->places.memory.bytes > 0)
        reservation_set(&q->places.memory, 0);
    free(q->level);
    q->places.p = NULL;
    q->places.kept = NULL;
    q->level = NULL;
}

/* ---- values ---- */

struct surface_moment surface_moment(struct dataset *set, const struct surface *q)
{
    struct version *v = set->current;
    return (struct surface_moment){.version = v,
                                   .field = dt_field_find(v->dt, q->field, q->field_len)};
}

void surface_answer_values(struct server *s, struct answer *a, const struct surface_moment *m,
                           struct surface *q)
{
    struct version *v = m->version;
    bool raster = q->kind == SURFACE_RASTER;
    size_t columns = raster ? q->raster.columns : 1,
           n = raster ? columns * q->raster.rows : q->places.n;
    struct rows rows = {.version = v,
                        .view = m->view,
                        .form = ROW_SURFACE,
                        .heavy = dt_next_id(v->dt) > IDS_AT_ONCE,
                        .surface = {.dt = v->dt,
                                    .field = m->field,
                                    .how = q->how,
                                    .max_edge = q->max_edge,
                                    .inside = q->inside,
                                    .beyond = q->beyond,
                                    .place = q->places.p,
                                    .kept = q->places.kept,
                                    .raster = q->raster,
                                    .columns = columns,
                                    .binary = q->binary,
                                    .end = n}};
    reply_ok(a->out, q->binary ? 0 : n / columns);
    if (q->binary)
        reply_key_u64(a->out, "rows", n / columns);
    if (raster)
        reply_key_u64(a->out, "columns", columns);
    if (q->binary)
        reply_key_u64(a->out, "bytes", (uint64_t)n * sizeof(double));
    reply_end(a->out);
    answer_places(s, a, &rows, &q->places);
    q->places = (struct places){0};
}

/* ---- contours, by a job ---- */

struct surface_job {
    struct job job;
    struct surface q;
    struct dt_view *view;         /* owns: the moment of the result */
    const struct dt_field *field; /* of the view */
    struct dt_ids line;           /* owns: the words of contours */
    size_t lines;
    bool too_many_levels;
};

static void answer_lines(struct server *s, struct answer *a, struct surface_job *j)
{
    struct rows rows = {.version = j->job.base,
                        .form = ROW_LINE,
                        .width = 1,
                        .heavy = j->line.n > 2 * (size_t)TEXT_AT_ONCE};
    struct dt_ids ids = j->line;
    j->line = (struct dt_ids){0};
    reply_ok(a->out, j->lines);
    reply_end(a->out);
    answer_rows(s, a, &rows, &ids);
    free(ids.v);
}

/* The levels at equal steps that the values of the field reach. */
static enum dt_status make_levels(struct surface_job *j)
{
    struct dt_field_summary sum;
    dt_field_summary(j->field, &sum);
    j->q.level = malloc(LIMIT_LEVELS * sizeof *j->q.level);
    if (j->q.level == NULL)
        return DT_NOMEM;
    size_t n = dt_levels_every(sum.least, sum.most, j->q.step, j->q.base, j->q.level, LIMIT_LEVELS);
    j->too_many_levels = n > LIMIT_LEVELS;
    j->q.levels = (uint32_t)n;
    return j->too_many_levels ? DT_RANGE : DT_OK;
}

static enum dt_status write_lines(struct surface_job *j, const struct dt_contour_line *line,
                                  size_t lines, size_t taken)
{
    size_t words = 0;
    for (size_t i = 0; i < lines; i++)
        words += ROW_LINE_WORDS + 4 * line[i].n;
    enum dt_status status = job_reserve(&j->job, taken + words * sizeof *j->line.v);
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
    enum dt_status status = job_reserve(&j->job, taken);
    if (status == DT_OK)
        status = dt_contour_end(c, &j->job.options, &line, &lines);
    return status == DT_OK ? write_lines(j, line, lines, taken) : status;
}

/* The worker is a visitor of the set on entry and on return. */
static enum dt_status find_lines(struct surface_job *j)
{
    struct version *v = j->job.base;
    struct dt_contour *c = NULL;
    bool done = false;
    enum dt_status status = j->q.level == NULL ? make_levels(j) : DT_OK;
    if (status == DT_OK)
        status =
            dt_contour_begin(v->dt, j->view, j->field, j->q.level, j->q.levels, j->q.max_edge, &c);
    if (status == DT_OK && j->q.inside.asked)
        status = dt_contour_inside(c, v->dt, j->q.inside.number);
    while (status == DT_OK && !done) {
        status = job_reserve(&j->job, dt_contour_memory(c));
        if (status == DT_OK)
            status = dt_contour_read(v->dt, c, &done);
        if (status == DT_OK)
            status = job_pause(&j->job);
    }
    job_end_visit(&j->job);
    if (status == DT_OK)
        status = join_lines(j, c);
    dt_contour_free(c);
    job_visit(&j->job);
    return status;
}

/* ---- the job ---- */

static void run_job(struct job *job)
{
    struct surface_job *j = (struct surface_job *)job;
    j->view = dt_view_begin(job->dt, true);
    j->field = dt_field_find(job->dt, j->q.field, j->q.field_len);
    if (j->view == NULL || j->field == NULL)
        job->status = j->view == NULL ? DT_NOMEM : DT_NOFIELD;
    else
        job->status = find_lines(j);
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct surface_job *j = (struct surface_job *)job;
    job_end_view(s, job, j->view);
    if (j->too_many_levels && a != NULL)
        answer_err(a, ERR_RANGE, "more than %d levels", LIMIT_LEVELS);
    else if (job_succeeded(job, a))
        answer_lines(s, a, j);
    surface_clear(&j->q);
    free(j->line.v);
}

static void answer_contour(struct server *s, struct answer *a, struct dataset *set,
                           struct surface *q)
{
    struct version *v = set->current;
    bool light = s->workers == NULL || cost_at_once(COST_SWEEP, 8 * (size_t)v->sum.points);
    bool blocks = q->inside.asked && !light,
         admitted = !blocks || dataset_admits(set, true, a->turn);
    struct surface_job *j = admitted ? job_new(sizeof *j, run_job, end_job) : NULL;
    if (j == NULL) {
        surface_clear(q);
        if (admitted)
            answer_out_of_memory(a);
        else
            answer_wait(a, &set->queue, true);
        return;
    }
    j->job.set = blocks ? set : NULL; /* edits wait, because regions are those of now */
    j->job.memory = server_reservation(s, BUDGET_REPLIES);
    j->job.what = "tracing";
    j->q = *q;
    job_read(s, a, &j->job, v, light ? JOB_LIGHT : JOB_LONG);
}

void surface_answer(struct server *s, struct answer *a, struct dataset *set, struct surface *q)
{
    if (q->kind == SURFACE_CONTOUR)
        answer_contour(s, a, set, q);
    else {
        struct surface_moment now = surface_moment(set, q);
        surface_answer_values(s, a, &now, q);
    }
}
