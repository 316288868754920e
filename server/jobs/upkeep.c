/* upkeep.c - see upkeep.h. */
#include "server/jobs/upkeep.h"

#include "core/delaunay_constraints.h"
#include "server/jobs/job.h"
#include "server/ops/cost.h"

/* ---- the triangulation ---- */

static void run_refresh(struct job *j)
{
    j->status = dt_refresh(j->dt, &j->options);
}

/* The request that a worker has kept waiting is carried out now. */
static void end_upkeep(struct server *s, struct job *j, struct answer *a)
{
    if (job_succeeded(j, a) && j->queued_ns > 0)
        answer_again(a);
}

/* Carries out a job that changes how the set is stored: the request waits for it, or for the set. True: it has been done. */
static bool carry_out(struct server *s, struct answer *a, struct dataset *set, const char *what,
                      void (*run)(struct job *j), bool large, bool builds)
{
    if (!world_alone(a))
        return false;
    if (!dataset_admits(set, true, a->turn))
        return answer_wait(a, &set->queue, true);
    struct job *j = job_new(sizeof *j, run, end_upkeep);
    if (j == NULL)
        return answer_out_of_memory(a);
    j->what = what;
    j->copies = large && builds;
    j->memory = server_reservation(s, BUDGET_BUILDS);
    if (large && builds && !job_reserve_build(s, a, set, &j->memory)) {
        job_free(s, j);
        return false;
    }
    job_change(s, a, j, set, large ? JOB_LONG : JOB_LIGHT);
    if (a->next == ANSWER_WORK)
        answer_wait_job(a, a->job);
    return a->next == ANSWER_DONE;
}

bool upkeep_refresh(struct server *s, struct answer *a, struct dataset *set)
{
    if (version_is_stale(set->current)) {
        bool large = !cost_at_once(COST_BUILD, set->current->sum.points);
        return carry_out(s, a, set, "triangulating", run_refresh, large, true) &&
               !version_is_stale(set->current);
    }
    if (!atomic_load_explicit(&set->current->asked, memory_order_relaxed))
        atomic_store_explicit(&set->current->asked, true, memory_order_relaxed);
    return true;
}

/* ---- regions ---- */

static void run_survey(struct job *j)
{
    j->status = job_reserve(j, dt_survey_memory(j->dt));
    if (j->status == DT_OK)
        j->status = dt_survey(j->dt, &j->options);
}

bool upkeep_survey(struct server *s, struct answer *a, struct dataset *set)
{
    const struct dt *t = set->current->dt;
    if (!dt_has_borders(t) || dt_surveyed(t))
        return true;
    bool large = !cost_at_once(COST_SURVEY, set->current->sum.points);
    return carry_out(s, a, set, "finding regions", run_survey, large, false) &&
           dt_surveyed(set->current->dt);
}

/* ---- the grid ---- */

struct grid {
    struct job job;
    struct dt_renewal *fresh; /* owns */
};

/* Out of memory: it is tried again after more edits, which run_grid sees to. */
static void make_grid(struct job *j)
{
    j->status = dt_renew(j->dt, &j->options, &((struct grid *)j)->fresh);
    if (j->status == DT_NOMEM)
        j->status = DT_OK;
}

static void run_grid(struct job *j)
{
    struct grid *g = (struct grid *)j;
    dt_renewed(j->dt, g->fresh);
    g->fresh = NULL;
}

/* Cancelled: the next search that needs a grid builds it. */
static void end_grid(struct server *s, struct job *j, struct answer *a)
{
    dt_renewal_free(((struct grid *)j)->fresh);
}

/* False: there is no memory, so searches work without a grid, with longer walks. */
static bool begin_grid(struct server *s, struct dataset *set)
{
    struct grid *g = job_new(sizeof *g, run_grid, end_grid);
    if (g == NULL)
        return false;
    g->job.memory = server_reservation(s, BUDGET_BUILDS);
    if (reservation_resize(&g->job.memory, dt_prepare_memory(set->current->dt)))
        job_beside(s, NULL, &g->job, set, make_grid, JOB_SHORT);
    else
        job_free(s, &g->job);
    return set->writer != NULL;
}

static bool has_grid(const struct version *v)
{
    return v->sum.searchable || !v->sum.triangulated;
}

/* Makes the grid, or begins to. Whether searches can go on. */
static bool give_grid(struct server *s, struct dataset *set)
{
    struct version *v = set->current;
    if (set->writer != NULL)
        return false;
    bool later = s->workers != NULL && !s->stopping && !cost_at_once(COST_GRID, v->sum.points);
    if (later || !gate_try_close(&v->gate))
        return !begin_grid(s, set);
    (void)dt_prepare(v->dt, NULL);
    version_update(&s->sets, v);
    gate_open(&v->gate);
    return true;
}

bool upkeep_prepare(struct server *s, struct answer *a, struct dataset *set)
{
    if (has_grid(set->current))
        return true;
    if (!world_alone(a))
        return false;
    return give_grid(s, set) || answer_wait(a, &set->queue, true);
}

void upkeep_after_edit(struct server *s, struct dataset *set)
{
    if (s->workers == NULL || s->stopping || set->writer != NULL || !dt_renew_due(set->current->dt))
        return;
    (void)begin_grid(s, set);
}
