/* contour.c - contours of a surface, and the bands between them, traced by a job. A worker visits the set for a piece of a few milliseconds
 * at a time and reads through a view; the result is in memory before it is sent. */
#include "server/replies/surface.h"

#include "server/jobs/job.h"
#include "server/ops/cost.h"
#include "server/ops/limits.h"
#include "server/rows/answer_rows.h"

#include <stdlib.h>
#include <string.h>

enum { TEXT_AT_ONCE = 20000 }; /* numbers that a reactor writes as text */

struct contour_job {
    struct job job;
    struct surface q;
    const struct dt_field *field; /* of the view */
    struct dt_ids row;            /* owns: the words of lines or rings */
    size_t rows;
    bool too_many_levels;
};

static void answer_rows_of(struct server *s, struct answer *a, struct contour_job *j)
{
    struct rows rows = {.version = j->job.base,
                        .form = ROW_WORDS,
                        .format = j->q.bands ? ROW_BAND : ROW_LINE,
                        .width = 1,
                        .heavy = j->row.n > 2 * (size_t)TEXT_AT_ONCE};
    struct dt_ids ids = j->row;
    j->row = (struct dt_ids){0};
    reply_ok(a->out, j->rows);
    reply_end(a->out);
    answer_rows(s, a, &rows, &ids);
    free(ids.v);
}

/* The levels at equal steps that the values of the field reach; for bands, those around the values. */
static enum dt_status make_levels(struct contour_job *j)
{
    struct dt_field_summary sum;
    dt_field_summary(j->field, &sum);
    j->q.level = malloc(LIMIT_LEVELS * sizeof *j->q.level);
    if (j->q.level == NULL)
        return DT_NOMEM;
    size_t n = (j->q.bands ? dt_levels_around : dt_levels_every)(
        sum.least, sum.most, j->q.step, j->q.base, j->q.level, LIMIT_LEVELS);
    j->too_many_levels = n > LIMIT_LEVELS;
    j->q.levels = (uint32_t)n;
    return j->too_many_levels ? DT_RANGE : DT_OK;
}

/* ---- rows ---- */

/* Writes the n rows of lines or, if there are any, of rings. */
static enum dt_status write_rows(struct contour_job *j, const struct dt_contour_line *line,
                                 const struct dt_band_ring *ring, size_t n, size_t taken)
{
    const size_t head = ring != NULL ? ROW_BAND_WORDS : ROW_LINE_WORDS;
    size_t words = n * head;
    for (size_t i = 0; i < n; i++)
        words += 4 * (ring != NULL ? ring[i].n : line[i].n);
    enum dt_status status = job_reserve(&j->job, taken + words * sizeof *j->row.v);
    if (status != DT_OK)
        return status;
    uint32_t *to = malloc(words * sizeof *to + 1);
    j->row = (struct dt_ids){to, words, words};
    j->rows = n;
    for (size_t i = 0; to != NULL && i < n; i++) {
        const struct dt_point *p = ring != NULL ? ring[i].p : line[i].p;
        const size_t places = ring != NULL ? ring[i].n : line[i].n;
        if (ring != NULL)
            row_band_put(to, &ring[i]);
        else
            row_line_put(to, line[i].level, line[i].closed, (uint32_t)places);
        memcpy(to + head, p, places * sizeof *p);
        to += head + 4 * places;
    }
    return to == NULL ? DT_NOMEM : DT_OK;
}

/* ---- tracing ---- */

/* Lines or bands. */
struct traced {
    struct dt_contour *lines;
    struct dt_bands *bands;
};

static enum dt_status begin(struct contour_job *j, struct traced *x)
{
    const struct dt *t = j->job.base->dt;
    const struct surface *q = &j->q;
    enum dt_status status = q->bands ? dt_bands_begin(t, j->job.view, j->field, q->level, q->levels,
                                                      q->max_edge, &x->bands)
                                     : dt_contour_begin(t, j->job.view, j->field, q->level,
                                                        q->levels, q->max_edge, &x->lines);
    if (status != DT_OK || !q->inside.asked)
        return status;
    return q->bands ? dt_bands_inside(x->bands, t, q->inside.number)
                    : dt_contour_inside(x->lines, t, q->inside.number);
}

static size_t memory_of(const struct traced *x)
{
    return x->bands != NULL ? dt_bands_memory(x->bands) : dt_contour_memory(x->lines);
}

static enum dt_status read_piece(const struct dt *t, const struct traced *x, bool *done)
{
    return x->bands != NULL ? dt_bands_read(t, x->bands, done) : dt_contour_read(t, x->lines, done);
}

static enum dt_status join(struct contour_job *j, const struct traced *x)
{
    const struct dt_contour_line *line = NULL;
    const struct dt_band_ring *ring = NULL;
    size_t n, taken = memory_of(x);
    enum dt_status status = job_reserve(&j->job, taken);
    if (status != DT_OK)
        return status;
    status = x->bands != NULL ? dt_bands_end(x->bands, &j->job.options, &ring, &n)
                              : dt_contour_end(x->lines, &j->job.options, &line, &n);
    return status == DT_OK ? write_rows(j, line, ring, n, taken) : status;
}

/* The worker is a visitor of the set on entry and on return. */
static enum dt_status trace(struct contour_job *j)
{
    struct traced x = {NULL, NULL};
    bool done = false;
    enum dt_status status = j->q.level == NULL ? make_levels(j) : DT_OK;
    if (status == DT_OK)
        status = begin(j, &x);
    while (status == DT_OK && !done) {
        status = job_reserve(&j->job, memory_of(&x));
        if (status == DT_OK)
            status = read_piece(j->job.base->dt, &x, &done);
        status = job_pause(&j->job, status);
    }
    job_end_visit(&j->job);
    if (status == DT_OK)
        status = join(j, &x);
    dt_contour_free(x.lines);
    dt_bands_free(x.bands);
    job_visit(&j->job);
    return status;
}

/* ---- the job ---- */

static void run_job(struct job *job)
{
    struct contour_job *j = (struct contour_job *)job;
    j->field = dt_field_find(job->dt, j->q.field, j->q.field_len);
    job->status = j->field == NULL ? DT_NOFIELD : trace(j);
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct contour_job *j = (struct contour_job *)job;
    if (j->too_many_levels && a != NULL)
        answer_err(a, ERR_RANGE, "more than %d levels", LIMIT_LEVELS);
    else if (job_succeeded(job, a))
        answer_rows_of(s, a, j);
    surface_clear(&j->q);
    free(j->row.v);
}

void contour_answer(struct server *s, struct answer *a, const struct surface_source *from,
                    struct surface *q)
{
    struct version *v = from->version;
    bool light = cost_at_once(COST_SWEEP, 8 * (size_t)v->sum.points);
    /* With INSIDE edits wait, because regions are those of now. */
    struct contour_job *j = job_new_reading(s, a, sizeof *j, run_job, end_job, "tracing",
                                            q->inside.asked ? from->set : NULL);
    if (j == NULL) {
        surface_clear(q);
        return;
    }
    j->q = *q;
    j->job.views = true;
    job_read(s, a, &j->job, v, light ? JOB_LIGHT : JOB_LONG);
}
