/* cmd_digest.c - DIGEST. */
#include "server/command/command.h"

#include "server/jobs/job.h"
#include "server/ops/cost.h"
#include "server/sets/digest.h"

#include <inttypes.h>
#include <stdio.h>

struct digest_job {
    struct job job;
    struct digest digest;
};

static void run_job(struct job *job)
{
    struct digest_job *j = (struct digest_job *)job;
    struct digest *d = &j->digest;
    for (bool done = false; job->status == DT_OK && !done;) {
        job->status = digest_read(d, job->dt, &done);
        atomic_store(&job->progress, digest_progress(d));
        if (job->status == DT_OK)
            job->status = job_pause(job);
    }
}

static void end_job(struct server *s, struct job *job, struct answer *a)
{
    struct digest_job *j = (struct digest_job *)job;
    char digits[17];
    job_end_view(s, job, j->digest.view);
    if (!job_succeeded(job, a))
        return;
    snprintf(digits, sizeof digits, "%016" PRIx64, j->digest.value);
    reply_ok(a->out, 0);
    reply_key_text(a->out, "digest", digits);
    reply_key_u64(a->out, "points", j->digest.points);
    answer_version(a, j->digest.version);
}

void cmd_digest(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct version *v = set->current;
    size_t numbers = (size_t)dt_next_id(v->dt) * (1 + v->sum.fields);
    struct digest_job *j = job_new(sizeof *j, run_job, end_job);
    (void)q;
    if (j == NULL || !digest_begin(&j->digest, set)) {
        if (j != NULL)
            job_free(s, &j->job);
        answer_out_of_memory(a);
        return;
    }
    j->job.what = "reading";
    job_read(s, a, &j->job, v, cost_at_once(COST_SWEEP, numbers) ? JOB_LIGHT : JOB_LONG);
}
