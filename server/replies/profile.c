/* profile.c - see surface.h. */
#include "server/replies/surface.h"

#include "server/jobs/job.h"
#include "server/rows/answer_rows.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS_A_VISIT = 1024, ROW_LENGTH = sizeof(struct dt_profile_row) / sizeof(uint32_t) };

_Static_assert(sizeof(struct dt_profile_row) == 4 * sizeof(double), "a row is four numbers");

struct profile_job {
    struct job job;
    struct surface q;    /* owns its places */
    struct dt_ids words; /* owns: of the rows */
};

/* The worker is a visitor of the set on entry and on return. */
static enum dt_status follow(struct profile_job *j, struct dt_profile *p)
{
    struct dt_profile_row row[ROWS_A_VISIT];
    enum dt_status status = DT_OK;
    j->words.n = 0;
    for (size_t n = 1; status == DT_OK && n > 0;) {
        status = job_grow(&j->job, &j->words, ROWS_A_VISIT * ROW_LENGTH);
        if (status == DT_OK)
            status = dt_profile_read(p, row, ROWS_A_VISIT, &n);
        if (status == DT_OK) {
            memcpy(j->words.v + j->words.n, row, n * sizeof *row);
            j->words.n += n * ROW_LENGTH;
        }
        status = job_pause(&j->job, status);
    }
    return status;
}

static void run_job(struct job *job)
{
    struct profile_job *j = (struct profile_job *)job;
    const struct dt *t = job->dt;
    const struct dt_field *field = dt_field_find(t, j->q.field, j->q.field_len);
    struct dt_surface s = {.how = DT_LINEAR,
                           .max_edge = j->q.max_edge,
                           .inside = j->q.inside.asked,
                           .number = j->q.inside.number};
    struct dt_profile *p = NULL;
    job->status = field == NULL ? DT_NOFIELD : dt_surface_begin(&s, field, NULL);
    if (job->status != DT_OK)
        return;
    job->status = dt_profile_begin(t, &s, j->q.places.p, j->q.places.n, &job->options, &p);
    if (job->status == DT_OK)
        job->status = follow(j, p);
    dt_profile_free(p);
    dt_surface_end(&s);
}

static void answer(struct server *s, struct answer *a, struct profile_job *j)
{
    struct rows rows = {.version = j->job.base,
                        .form = ROW_WORDS,
                        .format = "dddd",
                        .width = ROW_LENGTH,
                        .heavy = j->job.queued_ns > 0,
                        .binary = j->q.binary};
    size_t n = j->words.n / ROW_LENGTH;
    reply_ok(a->out, j->q.binary ? 0 : n);
    if (j->q.binary) {
        reply_key_u64(a->out, "rows", n);
        reply_key_u64(a->out, "bytes", j->words.n * sizeof *j->words.v);
    }
    reply_end(a->out);
    answer_rows(s, a, &rows, &j->words);
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct profile_job *j = (struct profile_job *)job;
    if (job_succeeded(job, a))
        answer(s, a, j);
    surface_clear(&j->q);
    free(j->words.v);
}

void profile_answer(struct server *s, struct answer *a, const struct surface_source *from,
                    struct surface *q)
{
    struct profile_job *j =
        job_new_reading(s, a, sizeof *j, run_job, end_job, "following a profile", from->set);
    if (j == NULL) {
        surface_clear(q);
        return;
    }
    j->q = *q;
    job_read(s, a, &j->job, from->version, JOB_TRY);
}
