/* cmd_build.c - TRIANGULATE, CHECK and DIGEST: jobs that read every point of a set. */
#include "server/command/command.h"

#include "server/command/options.h"
#include "server/jobs/job.h"
#include "server/jobs/submit.h"
#include "server/ops/cost.h"
#include "server/sets/digest.h"
#include "server/system/loop.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

struct build {
    struct job job;
    struct dt_build *made; /* owns */
    bool beside;           /* it was made beside the set */
    double ms;
    const char *fault;
    struct dt_crossed crossed; /* of DT_CROSSES */
    struct change change;      /* of a set that had no triangulation */
};

static void append_counts(struct answer *a, const struct dt_summary *sum)
{
    reply_key_u64(a->out, "points", sum->points);
    reply_key_u64(a->out, "coincident", sum->coincident);
    reply_key_u64(a->out, "triangles", sum->triangles);
    reply_key_u64(a->out, "edges", sum->edges);
    reply_key_u64(a->out, "hull", sum->hull);
}

/* ---- TRIANGULATE ---- */

static void take_time(struct build *b, int64_t start)
{
    int64_t microseconds = (clock_ns() - start) / 1000;
    b->ms = (double)microseconds / 1000;
}

static void run_triangulate(struct job *j)
{
    int64_t start = clock_ns();
    j->status = dt_triangulate(j->dt, &j->options);
    if (j->status == DT_OK)
        j->status = dt_refresh(j->dt, &j->options);
    if (j->status == DT_CROSSES)
        dt_crossed(j->dt, &((struct build *)j)->crossed);
    take_time((struct build *)j, start);
}

/* Beside the set, whose points are sorted already. */
static void make_build(struct job *j)
{
    struct build *b = (struct build *)j;
    int64_t start = clock_ns();
    j->status = dt_build(j->dt, &j->options, &b->made);
    take_time(b, start);
}

static void run_install(struct job *j)
{
    struct build *b = (struct build *)j;
    if (b->made != NULL)
        dt_built(j->dt, b->made);
    b->made = NULL;
}

static void answer_triangulation(struct answer *a, const struct dataset *set, double ms)
{
    reply_ok(a->out, 0);
    append_counts(a, &set->current->sum);
    reply_key_double(a->out, "ms", ms);
    answer_version(a, set->version);
}

/* Keeps the result of the job for requests that have waited for it; there are none if it was done at once. */
static void keep_result(const struct job *j, struct single_flight *r)
{
    const struct build *b = (const struct build *)j;
    if (j->queued_ns > 0 || b->beside)
        *r = (struct single_flight){.ended_ns = clock_ns(),
                                    .version = j->set->version,
                                    .ms = b->ms,
                                    .method = j->options.method,
                                    .rebuilt = j->options.rebuild};
}

static void finish_triangulation(struct server *s, struct job *j, struct answer *a)
{
    if (!j->set->triangulated)
        submit_commit(s, j->set, &((struct build *)j)->change);
    keep_result(j, &j->set->triangulation);
    answer_triangulation(a, j->set, ((struct build *)j)->ms);
}

static void end_triangulate(struct server *s, struct job *j, struct answer *a)
{
    dt_build_free(((struct build *)j)->made);
    if (a != NULL && j->status == DT_CROSSES)
        answer_crosses(a, &((struct build *)j)->crossed, "", NULL);
    else if (job_succeeded(j, a))
        finish_triangulation(s, j, a);
}

/* Whether the request waited for that result. */
static bool waited_for(struct server *s, const struct answer *a, const struct dataset *set,
                       const struct single_flight *r)
{
    bool waited = single_flight_serves(r, a->since_ns, set->version);
    s->count.shared += waited;
    return waited;
}

void triangulate(struct server *s, struct answer *a, struct dataset *set, enum dt_method method,
                 bool rebuild)
{
    const struct dt_summary *sum = &set->current->sum;
    if (!rebuild && sum->triangulated && !version_is_stale(set->current)) {
        answer_triangulation(a, set, 0);
        return;
    }
    bool large = !cost_at_once(COST_BUILD, sum->points);
    struct reservation memory = server_reservation(s, BUDGET_BUILDS);
    if (large && !job_reserve_build(s, a, set, &memory))
        return;
    struct build *b = job_new(sizeof *b, run_triangulate, end_triangulate);
    if (b == NULL) {
        reservation_set(&memory, 0);
        answer_out_of_memory(a);
        return;
    }
    change_init(&b->change, CHANGE_TRIANGULATE, &(struct word){set->name, set->name_len});
    b->job.acknowledges = true;
    b->job.change = set->triangulated ? NULL : &b->change;
    b->job.what = "triangulating";
    b->job.options.method = method;
    b->job.options.rebuild = rebuild;
    /* Readers of the points of a large set do not wait: it is built beside the set, or a copy is triangulated. */
    b->job.memory = memory;
    b->beside = large && s->workers != NULL && dt_build_suits(set->current->dt, &b->job.options);
    b->job.copies = large && !b->beside;
    if (b->beside) {
        b->job.run = run_install;
        job_beside(s, a, &b->job, set, make_build, JOB_LONG);
    } else {
        job_change(s, a, &b->job, set, large ? JOB_LONG : JOB_LIGHT);
    }
}

void cmd_triangulate(struct server *s, struct dataset *set, const struct request *q,
                     struct answer *a)
{
    static const char *const names[] = {"AUTO", "SHELLING", "DIVIDE", NULL};
    static const struct option option = {"METHOD", OPTION_CHOICE, .names = names};
    const struct single_flight *r = &set->triangulation;
    enum dt_method method = DT_AUTO;
    if (!options_read(a, q, 2, set, &option, 1, ~0u, &method))
        return;
    bool same = q->n == 2 || (r->rebuilt && r->method == method);
    if (same && waited_for(s, a, set, r))
        answer_triangulation(a, set, r->ms);
    else
        triangulate(s, a, set, method, q->n > 2); /* METHOD: rebuilt even if it is current */
}

/* ---- CHECK ----
 *
 * It reads the whole set at one moment, so edits wait; queries do not. */

static void run_check(struct job *j)
{
    j->status = dt_check(j->dt, &j->options, &((struct build *)j)->fault);
}

static void answer_proved(struct answer *a, const struct dataset *set)
{
    reply_ok(a->out, 0);
    reply_key_text(a->out, "delaunay", "yes");
    append_counts(a, &set->current->sum);
    reply_end(a->out);
}

static void end_check(struct server *s, struct job *j, struct answer *a)
{
    const char *fault = ((struct build *)j)->fault;
    if (a != NULL && j->status == DT_CORRUPT && fault != NULL) {
        answer_err(a, ERR_CORRUPT, "%s", fault);
    } else if (job_succeeded(j, a)) {
        keep_result(j, &j->set->proof);
        answer_proved(a, j->set);
    }
}

void cmd_check(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    if (waited_for(s, a, set, &set->proof)) {
        answer_proved(a, set);
        return;
    }
    bool light = cost_at_once(COST_BUILD, set->current->sum.points);
    struct build *b = job_new_reading(s, a, sizeof *b, run_check, end_check, "checking", set);
    if (b != NULL)
        job_read(s, a, &b->job, set->current, light ? JOB_LIGHT : JOB_LONG);
}

/* ---- DIGEST ---- */

struct digest_job {
    struct job job;
    struct digest digest;
};

static void run_digest(struct job *job)
{
    struct digest_job *j = (struct digest_job *)job;
    struct digest *d = &j->digest;
    for (bool done = false; job->status == DT_OK && !done;) {
        job->status = job_pause(job, digest_read(d, job->dt, &done));
        atomic_store(&job->progress, digest_progress(d));
    }
}

static void end_digest(struct server *s, struct job *job, struct answer *a)
{
    struct digest_job *j = (struct digest_job *)job;
    char digits[17];
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
    struct digest_job *j = job_new(sizeof *j, run_digest, end_digest);
    if (j == NULL || !digest_begin(&j->digest, set)) {
        if (j != NULL)
            job_free(s, &j->job);
        answer_out_of_memory(a);
        return;
    }
    j->job.what = "reading";
    j->job.view = j->digest.view;
    job_read(s, a, &j->job, v, cost_at_once(COST_SWEEP, numbers) ? JOB_LIGHT : JOB_LONG);
}
