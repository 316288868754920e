/* missing_skip.c - see missing_skip.h. */
#include "server/jobs/missing_skip.h"

#include "server/jobs/past.h"
#include "server/ops/cost.h"
#include "server/sets/skip_copy.h"

#include <stdlib.h>

struct missing_skip_job {
    struct job job;
    struct skip_copy *copy;       /* borrows; NULL: the build has not begun */
    const struct dt_field *field; /* borrows, as long as the view */
    struct past past;             /* owns, until it moves to the copy */
};

static void run_job(struct job *job)
{
    struct missing_skip_job *j = (struct missing_skip_job *)job;
    job->status = past_copy(job, job->view, &j->field, 1, true, &j->past);
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct missing_skip_job *j = (struct missing_skip_job *)job;
    if (j->copy == NULL)
        return;
    skip_copy_end(&s->sets, j->copy, a != NULL ? job->status : DT_OK, j->past.dt, &j->past.crossed);
    server_limit_pages(s);
}

/* The build, whose memory is reserved. NULL: the request waits, or the ERR line has been written. */
static struct missing_skip_job *new_job(struct server *s, struct answer *a, struct dataset *set,
                                        const struct dt_field *f, bool light)
{
    struct version *v = set->current;
    struct dt_options options = job_options(s);
    struct reservation memory = server_reservation(s, BUDGET_BUILDS);
    if (!light && !server_reserve(s, a, &memory, past_memory(v, 1, &options)))
        return NULL;
    struct missing_skip_job *j = job_new(sizeof *j, run_job, end_job);
    if (j != NULL) {
        j->job.what = "leaving out missing values";
        j->job.memory = memory;
        j->field = f;
        j->job.view = dt_view_begin(v->dt, false);
        if (j->job.view != NULL)
            j->copy = skip_copy_begin(&s->sets, set, f, &j->job.cancel);
    }
    if (j != NULL && j->copy != NULL)
        return j;
    if (j != NULL)
        job_free(s, &j->job);
    else
        reservation_set(&memory, 0);
    answer_out_of_memory(a);
    return NULL;
}

/* Begins the build. A light one has ended on return; for another one the request waits. */
static void build(struct server *s, struct answer *a, struct dataset *set, const struct dt_field *f)
{
    bool light = s->workers == NULL || cost_at_once(COST_BUILD, set->current->sum.points);
    struct missing_skip_job *j = new_job(s, a, set, f, light);
    if (j == NULL)
        return;
    struct skip_copy *c = j->copy;
    j->job.waiting = &c->queue;
    job_read(s, a, &j->job, set->current, light ? JOB_LIGHT : JOB_LONG);
    if (a->next != ANSWER_WORK)
        return;
    a->job->owner = 0; /* it goes on for others if this request ends */
    answer_wait(a, &c->queue, false);
}

/* Answers from the outcome of the build. */
static bool take(const struct skip_copy *c, struct answer *a, struct version **out)
{
    *out = c->version;
    if (c->status != DT_CROSSES)
        return answer_status(a, c->status);
    answer_crosses(a, &c->crossed, "", NULL);
    return false;
}

bool missing_skip_ready(struct server *s, struct answer *a, struct dataset *set,
                        const struct dt_field *f, struct version **out)
{
    *out = set->current;
    if (dt_field_count(f) == set->current->sum.points)
        return true;
    struct skip_copy *c = skip_copy_find(set, f);
    if (c != NULL && skip_copy_serves(c, f, a->since_ns))
        return take(c, a, out);
    if (!world_alone(a))
        return false;
    if (c != NULL && c->build.at_ns != 0) {
        s->count.shared++;
        return answer_wait(a, &c->queue, false);
    }
    build(s, a, set, f);
    c = a->next == ANSWER_DONE && !a->refused && !a->out->failed ? skip_copy_find(set, f) : NULL;
    return c != NULL && take(c, a, out);
}
