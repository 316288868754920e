/* cmd_quality.c - QUALITY: a worker reads a large set in pieces, through a view, so that others edit meanwhile. */
#include "server/command/command.h"

#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "server/jobs/job.h"
#include "server/ops/cost.h"
#include "server/replies/regions.h"

struct quality_job {
    struct job job;
    struct inside inside; /* regions_ready */
    struct dt_shapes shapes;
};

static void run_job(struct job *job)
{
    struct quality_job *j = (struct quality_job *)job;
    struct dt_measure *m = NULL;
    bool done = false;
    enum dt_status s = dt_measure_begin(job->dt, job->view, &m);
    if (s == DT_OK && j->inside.asked)
        s = dt_measure_inside(m, job->dt, j->inside.number);
    if (s == DT_OK)
        s = job_reserve(job, dt_measure_memory(m));
    while (s == DT_OK && !done)
        s = job_pause(job, dt_measure_read(job->dt, m, &done));
    if (s == DT_OK)
        dt_measure_end(m, &j->shapes);
    dt_measure_free(m);
    job->status = s;
}

static void answer(struct answer *a, const struct dt_shapes *shapes)
{
    reply_ok(a->out, DT_ANGLE_BINS);
    reply_key_u64(a->out, "triangles", shapes->triangles);
    reply_key_double(a->out, "area", shapes->area);
    reply_key_double(a->out, "angle", shapes->least);
    reply_key_double(a->out, "largest", shapes->largest);
    reply_key_double(a->out, "shortest", shapes->shortest);
    reply_key_double(a->out, "longest", shapes->longest);
    reply_end(a->out);
    for (uint32_t k = 0; k < DT_ANGLE_BINS; k++) {
        const uint32_t low = k * DT_ANGLE_BIN, count = (uint32_t)shapes->count[k];
        reply_row_ids(a->out, (const uint32_t[]){low, low + DT_ANGLE_BIN, count}, 3);
    }
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct quality_job *j = (struct quality_job *)job;
    if (job_succeeded(job, a))
        answer(a, &j->shapes);
}

/* With INSIDE edits of the set wait until a large set has been read, because regions are those of now. */
static void measure(struct server *s, struct answer *a, struct dataset *set, struct inside inside)
{
    struct version *v = set->current;
    bool light = cost_at_once(COST_SWEEP, 8 * (size_t)v->sum.points);
    struct quality_job *j = job_new_reading(s, a, sizeof *j, run_job, end_job, "measuring angles",
                                            inside.asked ? set : NULL);
    if (j == NULL)
        return;
    j->inside = inside;
    j->job.views = true;
    job_read(s, a, &j->job, v, light ? JOB_LIGHT : JOB_LONG);
}

void cmd_quality(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct inside inside = {0};
    size_t at = 2;
    bool good = at == q->n || word_is(&q->word[at], "INSIDE");
    if (good && at++ < q->n && !read_inside(a, q, &at, &inside))
        return;
    if (!good || at < q->n)
        answer_usage(a);
    else if (!inside.asked || regions_ready(s, a, set, inside))
        measure(s, a, set, inside);
}
