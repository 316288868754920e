/* volume.c - see surface.h. */
#include "server/replies/surface.h"

#include "core/delaunay_surface.h"
#include "server/jobs/job.h"
#include "server/ops/cost.h"

#include <math.h>
#include <string.h>

struct volume_job {
    struct job job;
    char field[DT_FIELD_NAME + 1], minus[DT_FIELD_NAME + 1]; /* minus: "" for the level */
    struct volume volume; /* but for its fields, which an edit may replace */
    struct dt_volumes sums;
};

static const struct dt_field *field_of(const struct volume_job *j, const char *name)
{
    return dt_field_find(j->job.dt, name, strlen(name));
}

static void run_job(struct job *job)
{
    struct volume_job *j = (struct volume_job *)job;
    const struct dt *t = job->dt;
    const struct dt_field *field = field_of(j, j->field), *minus = field_of(j, j->minus);
    struct dt_volume *v = NULL;
    bool done = false;
    bool there = field != NULL && (minus != NULL || j->minus[0] == 0);
    enum dt_status s =
        there ? dt_volume_begin(t, job->view, field, minus, j->volume.level, &v) : DT_NOFIELD;
    if (s == DT_OK && !isinf(j->volume.box[0].x))
        dt_volume_clip(v, j->volume.box[0], j->volume.box[1]);
    if (s == DT_OK && j->volume.inside.asked)
        s = dt_volume_inside(v, t, j->volume.inside.number);
    if (s == DT_OK)
        s = job_reserve(job, dt_volume_memory(v));
    while (s == DT_OK && !done)
        s = job_pause(job, dt_volume_read(t, v, &done));
    if (s == DT_OK)
        dt_volume_end(v, &j->sums);
    dt_volume_free(v);
    job->status = s;
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct volume_job *j = (struct volume_job *)job;
    if (!job_succeeded(job, a))
        return;
    reply_ok(a->out, 0);
    reply_key_double(a->out, "above", j->sums.above);
    reply_key_double(a->out, "below", j->sums.below);
    reply_key_double(a->out, "area", j->sums.area);
    reply_end(a->out);
}

void volume_answer(struct server *s, struct answer *a, const struct surface_source *from,
                   const struct volume *volume)
{
    struct version *v = from->version;
    bool light = cost_at_once(COST_SWEEP, 8 * (size_t)v->sum.points);
    /* With INSIDE edits wait, because regions are those of now. */
    struct volume_job *j = job_new_reading(s, a, sizeof *j, run_job, end_job, "adding up",
                                           volume->inside.asked ? from->set : NULL);
    if (j == NULL)
        return;
    strcpy(j->field, dt_field_name(volume->field));
    if (volume->minus != NULL)
        strcpy(j->minus, dt_field_name(volume->minus));
    j->volume = *volume;
    j->job.views = true;
    job_read(s, a, &j->job, v, light ? JOB_LIGHT : JOB_LONG);
}
